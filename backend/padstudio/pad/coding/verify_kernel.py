"""The compiled loop of the verifier: compare windows that are equal in a part."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.compiled import pure_jit

_ONE = np.uint64(1)


class Packed(NamedTuple):
    """All windows of a field, and of others or of its other turns after it.

    Attributes
    ----------
    words : (words, all windows) uint64
    bits : int
        Of a cell; none lies across two words.
    first : int
        The first window that others are compared with.
    """

    words: NDArray[np.uint64]
    bits: int
    first: int


class Nearest(NamedTuple):
    """The window found nearest to each.

    Attributes
    ----------
    distance : (windows,) uint8
    other : (windows,) int64
        Its column in `Packed.words`; -1 for none.
    """

    distance: NDArray[np.uint8]
    other: NDArray[np.int64]


@pure_jit
def compare_runs(
    packed: Packed,
    keys: NDArray[np.uint64],
    order: NDArray[np.int64],
    part: int,
    nearest: Nearest,
) -> None:
    """Compare all windows with equal keys and enter what is nearer.

    Parameters
    ----------
    packed
    keys, order : (all windows,)
        Cells of the part, and a permutation that sorts them; of equal keys it is changed.
    part : int
        Parts compared before this one: whatever is within that distance was found.
    nearest
        Updated.
    """
    words, bits, distance = packed.words, packed.bits, nearest.distance
    count, windows = len(keys), len(distance)
    cell = np.uint64(0)
    for k in range(0, 64 // bits * bits, bits):
        cell |= _ONE << np.uint64(k)
    first = 0
    while first < count:
        last = first + 1
        while last < count and keys[order[last]] == keys[order[first]]:
            last += 1
        # Those to compare with come first, so that none looks through many that are not.
        ends = first
        for at in range(first, last):
            if order[at] >= packed.first:
                order[at], order[ends] = order[ends], order[at]
                ends += 1
        for at in range(first, last):
            window = order[at]
            if window >= windows or distance[window] <= part:
                continue
            for k in range(first, ends):
                other = order[k]
                if other == window:
                    continue
                differing = 0
                for word in range(words.shape[0]):
                    x = words[word, window] ^ words[word, other]
                    folded = x
                    for shift in range(1, bits):
                        folded |= x >> np.uint64(shift)
                    folded &= cell
                    while folded:
                        folded &= folded - _ONE
                        differing += 1
                if differing < distance[window]:
                    distance[window] = differing
                    nearest.other[window] = other
                    if differing <= part:
                        break
        first = last
