"""Keys of windows for the index: weighted sums of levels modulo 2^64."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations, product

import numpy as np
from numpy.typing import NDArray

U64 = NDArray[np.uint64]


def weights(b: int, levels: int) -> tuple[U64, U64]:
    """Weights of a window's rows and columns; their products weigh its cells."""
    if levels ** (b * b) <= 2**64:
        powers = [levels**k for k in range(b - 1, -1, -1)]
        return np.array([p**b for p in powers], np.uint64), np.array(powers, np.uint64)
    # Odd numbers keep every bit of a level; any fixed random ones do.
    words = np.random.SeedSequence(0).generate_state(2 * b, np.uint64) | np.uint64(1)
    return words[:b], words[b:]


def mark(keys: U64) -> NDArray[np.uint32]:
    """32 well-mixed bits of keys."""
    mixed = (keys ^ (keys >> np.uint64(31))) * np.uint64(0x9E3779B97F4A7C15)
    mixed = (mixed ^ (mixed >> np.uint64(29))) * np.uint64(0xBF58476D1CE4E5B9)
    return (mixed >> np.uint64(32)).astype(np.uint32)


def longest_run(ordered: NDArray[np.uint32]) -> int:
    """Length of the longest run of equal numbers."""
    ends = np.flatnonzero(np.diff(ordered, append=ordered[-1] + np.uint32(1)))
    return int(np.diff(ends, prepend=-1).max())


def every_change(size: int, levels: int, changes: int) -> Iterator[tuple[list[int], U64]]:
    """All ways to change so many cells: which, and by how much modulo Y."""
    for cells in combinations(range(size), changes):
        for shifts in product(range(1, levels), repeat=changes):
            yield list(cells), np.array(shifts, np.uint64)
