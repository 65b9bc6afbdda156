"""The compiled loop of the verifier: compare windows that are equal in a part."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from padstudio.compiled import jit

_ONE = np.uint64(1)


@jit
def compare_runs(
    words: NDArray[np.uint64],
    keys: NDArray[np.uint64],
    order: NDArray[np.int64],
    bits: int,
    part: int,
    nearest: NDArray[np.uint8],
    others: NDArray[np.int64],
) -> None:
    """Compare all windows with equal keys and enter what is nearer.

    Parameters
    ----------
    words : (words, turns * windows) uint64
        Packed windows, all of one turn after the other, ``bits`` a cell.
    keys, order : (turns * windows,)
        Cells of the part, and the permutation that sorts them.
    part : int
        Parts compared before this one: whatever is within that distance was found.
    nearest, others : (windows,)
        Least distance so far and with which column of ``words``; updated.
    """
    count, windows = len(keys), len(nearest)
    cell = np.uint64(0)
    for k in range(0, 64 // bits * bits, bits):
        cell |= _ONE << np.uint64(k)
    first = 0
    while first < count:
        last = first + 1
        while last < count and keys[order[last]] == keys[order[first]]:
            last += 1
        for at in range(first, last):
            window = order[at]
            if window >= windows or nearest[window] <= part:
                continue
            for k in range(first, last):
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
                if differing < nearest[window]:
                    nearest[window] = differing
                    others[window] = other
                    if differing <= part:
                        break
        first = last
