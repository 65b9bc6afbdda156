"""Prove the properties of a field, own or imported; shares no code with the generators.

Windows are packed, a few bits a cell, into words. Equal windows are found by sorting; near ones by
the pigeonhole principle: two windows that differ in at most k cells are equal in at least one of
k + 1 disjoint parts, so that only windows equal in a part are compared (multi-index hashing:
Norouzi, Punjani, Fleet, "Fast search in Hamming space with multi-index hashing", CVPR 2012,
doi:10.1109/CVPR.2012.6248043).
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from padstudio.errors import SpecError
from padstudio.pad.coding.verify_kernel import Nearest, Packed, compare_runs

U64 = NDArray[np.uint64]
# Comparisons of two windows that an unasked-for search for near windows may take.
_COMPARISONS = 3e8
# Pairs that a report lists: as many as a reader looks through.
_WEAKEST = 20


@dataclass(frozen=True)
class NearPair:
    """A window and the one nearest to it.

    Attributes
    ----------
    row, col : int
        Top left cell of the window.
    other_row, other_col : int
        Top left cell of the other, or the same where a window is near itself turned.
    turn : int
        Quarter turns counter-clockwise of the other that bring the two nearest.
    distance : int
        Cells in which they then differ.
    """

    row: int
    col: int
    other_row: int
    other_col: int
    turn: int
    distance: int


@dataclass(frozen=True)
class Verification:
    """What holds for a field.

    Attributes
    ----------
    rows, cols, window, levels : int
    windows : int
        Windows of the field.
    windows_possible : int
        Y^(b²).
    unique : bool
        No two windows are equal.
    unique_under_rotation : bool
        No two windows are equal in any turn, and none equals itself turned.
    visible_lines : bool
        Every window has a level change across each of its inner grid lines.
    distance_limit : int
        Distances up to this were looked for.
    min_distance, min_distance_under_rotation : int
        Least number of cells in which two windows differ, as they stand and in any turn;
        ``distance_limit + 1`` means: at least that.
    histogram, histogram_under_rotation : tuple of int
        Windows whose nearest other is at distance 0, 1, … ``distance_limit``, and beyond.
    level_counts : tuple of int
        Cells of each level.
    weakest : tuple of NearPair
        The windows with the nearest others in any turn, nearest first.
    """

    rows: int
    cols: int
    window: int
    levels: int
    windows: int
    windows_possible: int
    unique: bool
    unique_under_rotation: bool
    visible_lines: bool
    distance_limit: int
    min_distance: int
    min_distance_under_rotation: int
    histogram: tuple[int, ...]
    histogram_under_rotation: tuple[int, ...]
    level_counts: tuple[int, ...]
    weakest: tuple[NearPair, ...]

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers, lists and dicts, for JSON."""
        plain = asdict(self)
        return {key: list(v) if isinstance(v, tuple) else v for key, v in plain.items()}


def verify_field(
    field: NDArray[np.uint8],
    window: int,
    levels: int,
    *,
    distance_limit: int | None = None,
) -> Verification:
    """Verify all windows of a field.

    Parameters
    ----------
    field : (rows, cols) uint8
        Levels 0 … Y−1.
    window, levels : int
        b and Y.
    distance_limit : int, optional
        How far apart near windows are looked for; unless given, as far as a second or so allows.

    Raises
    ------
    SpecError
        If the field holds no window, or a level that is not below ``levels``.
    """
    field = np.asarray(field)
    if field.ndim != 2 or min(field.shape) < window or window < 2 or levels < 2:
        raise SpecError(f"a field of {field.shape} cells holds no {window} x {window} window")
    if int(field.max()) >= levels:
        raise SpecError(f"the field holds level {field.max()}, not below levels = {levels}")
    windows = (field.shape[0] - window + 1) * (field.shape[1] - window + 1)
    if distance_limit is None:
        distance_limit = _affordable_limit(windows, window * window, levels)
    limit = min(distance_limit, window * window)
    upright = _nearest(field, window, levels, turns=1, limit=limit).distance
    turned, others = _nearest(field, window, levels, turns=4, limit=limit)
    return Verification(
        rows=field.shape[0],
        cols=field.shape[1],
        window=window,
        levels=levels,
        windows=windows,
        windows_possible=levels ** (window * window),
        unique=int(upright.min()) > 0,
        unique_under_rotation=int(turned.min()) > 0,
        visible_lines=lines_visible(field, window),
        distance_limit=limit,
        min_distance=int(upright.min()),
        min_distance_under_rotation=int(turned.min()),
        histogram=_histogram(upright, limit),
        histogram_under_rotation=_histogram(turned, limit),
        level_counts=tuple(np.bincount(field.ravel(), minlength=levels).tolist()),
        weakest=_weakest(turned, others, field.shape[1] - window + 1, limit),
    )


def least_distance(
    field: NDArray[np.uint8], window: int, levels: int, *, rotation: bool, limit: int
) -> int:
    """Least number of cells in which two windows of a field differ, at most ``limit + 1``.

    With ``rotation`` in any turn, a window and itself turned included. Quicker than `verify_field`.
    """
    nearest = _nearest(field, window, levels, turns=4 if rotation else 1, limit=limit)
    return int(nearest.distance.min())


def _affordable_limit(windows: int, size: int, levels: int) -> int:
    """The greatest distance, at most 4, that the search reaches within `_COMPARISONS`."""
    limit = 0
    for k in range(1, min(4, size - 1) + 1):
        part = float(levels) ** (size // (k + 1))
        if (k + 1) * windows * (4 * windows / part) <= _COMPARISONS:
            limit = k
    return limit


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


def _nearest(field: NDArray[np.uint8], b: int, levels: int, *, turns: int, limit: int) -> Nearest:
    """The nearest other of each window, at most ``limit + 1`` apart."""
    bits = max(1, int(levels - 1).bit_length())
    whole = np.ones((b, b), bool)
    words = np.stack([_pack(field, b, bits, turn, whole) for turn in range(turns)], axis=1)
    words = words.reshape(len(words), -1)
    count = words.shape[1] // turns
    nearest = Nearest(np.full(count, limit + 1, np.uint8), np.full(count, -1, np.int64))
    if limit == 0 and not _any_equal(_mixed(words)):
        return nearest
    part_of = np.arange(b * b).reshape(b, b) % (limit + 1)
    for part in range(limit + 1):
        cells = part_of == part
        keys = np.concatenate([_mixed(_pack(field, b, bits, turn, cells)) for turn in range(turns)])
        order = np.argsort(keys)
        compare_runs(Packed(words, bits), keys, order, part, nearest)
    return nearest


def _any_equal(keys: U64) -> bool:
    """Whether two keys are equal; sorts them where they are, as the largest fields fill memory."""
    keys.sort()
    return bool((keys[1:] == keys[:-1]).any())


def lines_visible(field: NDArray[np.uint8], b: int) -> bool:
    """Whether no b cells in line equal the b cells beside them."""
    for cells in (field, field.T):
        equal = cells[1:] == cells[:-1]
        run = np.lib.stride_tricks.sliding_window_view(equal, b, axis=1)
        if run.all(axis=2).any():
            return False
    return True


def _histogram(nearest: NDArray[np.uint8], limit: int) -> tuple[int, ...]:
    return tuple(np.bincount(nearest, minlength=limit + 2).tolist())


def _weakest(
    nearest: NDArray[np.uint8], others: NDArray[np.int64], across: int, limit: int
) -> tuple[NearPair, ...]:
    pairs = []
    for number in np.argsort(nearest, kind="stable")[:_WEAKEST].tolist():
        if nearest[number] > limit:
            break
        turn, other = divmod(int(others[number]), len(nearest))
        pairs.append(
            NearPair(
                row=number // across,
                col=number % across,
                other_row=other // across,
                other_col=other % across,
                turn=turn,
                distance=int(nearest[number]),
            )
        )
    return tuple(pairs)
