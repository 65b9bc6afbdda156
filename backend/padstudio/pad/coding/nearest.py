"""The nearest other of each window, of one field or of two.

Windows are packed, a few bits a cell, into words. Equal windows are found by sorting; near ones by
the pigeonhole principle: two windows that differ in at most k cells are equal in at least one of
k + 1 disjoint parts, so that only windows equal in a part are compared (multi-index hashing:
Norouzi, Punjani, Fleet, "Fast search in Hamming space with multi-index hashing", CVPR 2012,
doi:10.1109/CVPR.2012.6248043).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from padstudio.pad.coding.verify_kernel import Nearest, Packed, compare_runs

U64 = NDArray[np.uint64]
U8 = NDArray[np.uint8]


def nearest_windows(field: U8, b: int, levels: int, *, turns: int, limit: int) -> Nearest:
    """The nearest other of each window of a field, in 1 or 4 turns, at most ``limit + 1`` apart."""
    return _nearest([(field, turn) for turn in range(turns)], b, levels, limit, apart=False)


def nearest_apart(field: U8, other: U8, b: int, levels: int, *, limit: int) -> Nearest:
    """For each window of a field the nearest of another, in any turn, at most ``limit + 1`` apart.

    ``Nearest.other`` counts the windows of ``field``, then those of ``other`` in each turn.
    """
    views = [(field, 0), *((other, turn) for turn in range(4))]
    return _nearest(views, b, levels, limit, apart=True)


def _nearest(
    views: list[tuple[U8, int]], b: int, levels: int, limit: int, *, apart: bool
) -> Nearest:
    """The nearest to each window of the first view, among all views or all but the first.

    A view is a field in a turn.
    """
    bits = max(1, int(levels - 1).bit_length())
    whole = np.ones((b, b), bool)
    words = np.concatenate([_pack(field, b, bits, turn, whole) for field, turn in views], axis=1)
    first = views[0][0]
    count = (first.shape[0] - b + 1) * (first.shape[1] - b + 1)
    nearest = Nearest(np.full(count, limit + 1, np.uint8), np.full(count, -1, np.int64))
    if limit == 0 and not _any_equal(_mixed(words)):
        return nearest
    part_of = np.arange(b * b).reshape(b, b) % (limit + 1)
    packed = Packed(words, bits, count if apart else 0)
    for part in range(limit + 1):
        cells = part_of == part
        keys = np.concatenate([_mixed(_pack(field, b, bits, turn, cells)) for field, turn in views])
        compare_runs(packed, keys, np.argsort(keys), part, nearest)
    return nearest


def _pack(field: NDArray[np.uint8], b: int, bits: int, turn: int, cells: NDArray[np.bool_]) -> U64:
    """Some cells of all windows, turned, as words (words, windows) of ``bits`` bits a cell."""
    down, across = field.shape[0] - b + 1, field.shape[1] - b + 1
    per_word = 64 // bits
    place = np.rot90(np.arange(b * b).reshape(b, b), -turn)
    if b * b <= per_word and cells.all():
        return _pack_whole(field, b, bits, place)
    words = np.zeros((-(-b * b // per_word), down, across), np.uint64)
    for i, j in np.argwhere(np.rot90(cells, -turn)):
        word, slot = divmod(int(place[i, j]), per_word)
        level = field[i : i + down, j : j + across].astype(np.uint64)
        words[word] |= level << np.uint64(slot * bits)
    return words.reshape(len(words), -1)


def _pack_whole(field: NDArray[np.uint8], b: int, bits: int, place: NDArray[np.int64]) -> U64:
    """`_pack` of all cells into one word: along the rows first, then down, 2 b sums for b²."""
    down, across = field.shape[0] - b + 1, field.shape[1] - b + 1
    in_row, in_col = (line - line.min() for line in (place[0], place[:, 0]))
    lines = np.zeros((field.shape[0], across), np.uint64)
    for j in range(b):
        level = field[:, j : j + across].astype(np.uint64)
        lines |= level << np.uint64(in_row[j] * bits)
    words = np.zeros((down, across), np.uint64)
    for i in range(b):
        words |= lines[i : i + down] << np.uint64(in_col[i] * bits)
    return words.reshape(1, -1)


def _mixed(words: U64) -> U64:
    """One word for several: themselves where there is one, else a hash; (windows,)."""
    out: U64 = words[0].copy()
    for word in words[1:]:
        out ^= out >> np.uint64(29)
        out *= np.uint64(0xBF58476D1CE4E5B9)
        out ^= out >> np.uint64(32)
        out += word
    return out


def _any_equal(keys: U64) -> bool:
    """Whether two keys are equal; sorts them where they are, as the largest fields fill memory."""
    keys.sort()
    return bool((keys[1:] == keys[:-1]).any())
