"""Prove the properties of a field, own or imported; shares no code with the generators.

Equal windows and near ones are found by `padstudio.pad.coding.nearest`.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from padstudio.errors import SpecError
from padstudio.pad.coding.nearest import nearest_apart, nearest_windows

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
        distance_limit = affordable_limit(windows, window * window, levels)
    limit = min(distance_limit, window * window)
    upright = nearest_windows(field, window, levels, turns=1, limit=limit).distance
    turned, others = nearest_windows(field, window, levels, turns=4, limit=limit)
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
    nearest = nearest_windows(field, window, levels, turns=4 if rotation else 1, limit=limit)
    return int(nearest.distance.min())


def least_distance_apart(
    field: NDArray[np.uint8], other: NDArray[np.uint8], window: int, levels: int, *, limit: int
) -> int:
    """Least number of cells in which a window of one field differs from one of another.

    In any turn, at most ``limit + 1``.
    """
    return int(nearest_apart(field, other, window, levels, limit=limit).distance.min())


def affordable_limit(windows: int, size: int, levels: int) -> int:
    """The greatest distance, at most 4, that the search reaches within `_COMPARISONS`."""
    limit = 0
    for k in range(1, min(4, size - 1) + 1):
        part = float(levels) ** (size // (k + 1))
        if (k + 1) * windows * (4 * windows / part) <= _COMPARISONS:
            limit = k
    return limit


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
