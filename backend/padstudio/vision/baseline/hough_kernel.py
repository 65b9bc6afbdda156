"""Compiled inner loops of `hough`, which documents what they compute."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import inlined_jit, pure_jit

# Bins of a line's normal over half a turn: three quarters of a degree each.
BINS = 240
# A pixel votes for lines whose normals are this near to its gradient, bins: ten degrees.
_REACH = 13
# Above any rank among equals.
_RANKS = 64

# A way on a line: the last pixel, and the steps to it.
Way = tuple[int, int, int]


class Table(NamedTuple):
    """Votes for lines by the bin of their normal and their distance from the origin.

    Attributes
    ----------
    counts : (C,) int16
        Of one bin after the other.
    axes : (3, BINS + 2 · _REACH) float64
        Of each bin, from `_REACH` before the first to as many after the last, its normal, and what
        makes distances along it places among its counts.
    starts : (BINS + 2 · _REACH,) int32
        Where a bin's counts begin.
    cells : (2 · _REACH + 1,) int32
        Room for the counts that a pixel votes for.
    """

    counts: NDArray[np.int16]
    axes: Array
    starts: NDArray[np.int32]
    cells: NDArray[np.int32]


class Pixels(NamedTuple):
    """Edge pixels.

    Attributes
    ----------
    xy : (P, 2) int32
    normals : (P,) int32
    free : (h, w) int32
        Numbers of the pixels that no segment has taken and no way has tried in vain, else −1.
    has_voted : (P,) bool
    """

    xy: NDArray[np.int32]
    normals: NDArray[np.int32]
    free: NDArray[np.int32]
    has_voted: NDArray[np.bool_]


def find_segments(
    shape: tuple[int, int],
    xy: NDArray[np.int32],
    normals: NDArray[np.int32],
    votes: int,
    length: float,
    gap: int,
) -> Array:
    """Segments (N, 2, 2) of edge pixels; `xy` (P, 2) and `normals` (P,) in the order of voting."""
    free = np.full(shape, -1, np.int32)
    free[xy[:, 1], xy[:, 0]] = np.arange(len(xy))
    pixels = Pixels(xy, normals, free, np.zeros(len(xy), np.bool_))
    segments = np.empty((len(xy), 2, 2))
    count = _find(segments, pixels, _table(shape), votes, length, gap)
    return segments[:count].copy()


def _table(shape: tuple[int, int]) -> Table:
    """Room for the lines of a picture (h, w), without votes."""
    bins = np.arange(-_REACH, BINS + _REACH) % BINS
    turns = np.arange(BINS) * math.pi / BINS
    nx, ny = np.cos(turns), np.sin(turns)
    low = np.floor(np.minimum(nx * shape[1], 0) + np.minimum(ny * shape[0], 0))
    high = np.ceil(np.maximum(nx * shape[1], 0) + np.maximum(ny * shape[0], 0))
    ends = np.cumsum(high - low + 1).astype(np.int32)
    starts = np.append(np.int32(0), ends[:-1])
    axes = np.ascontiguousarray(np.stack((nx, ny, 0.5 - low))[:, bins])
    cells = np.empty(2 * _REACH + 1, np.int32)
    return Table(np.zeros(ends[-1], np.int16), axes, starts[bins], cells)


@pure_jit
def _find(
    segments: Array, pixels: Pixels, table: Table, votes: int, length: float, gap: int
) -> int:
    """Fill in segments; how many they are."""
    count = 0
    for k in range(len(pixels.xy)):
        x, y = pixels.xy[k, 0], pixels.xy[k, 1]
        if pixels.free[np.uintp(y), np.uintp(x)] < 0:
            continue
        most, b = _vote(table, x, y, pixels.normals[k])
        pixels.has_voted[k] = True
        if most < votes:
            continue
        dx, dy = -table.axes[1, b], table.axes[0, b]
        # Steps of one pixel along the way's longer axis.
        major = max(abs(dx), abs(dy))
        dx, dy = dx / major, dy / major
        first = _walk(pixels.free, (x, y), (dx, dy), gap)
        last = _walk(pixels.free, (x, y), (-dx, -dy), gap)
        is_long = max(abs(last[0] - first[0]), abs(last[1] - first[1])) >= length
        _take(pixels, table, (x, y), (dx, dy), first[2], is_long)
        _take(pixels, table, (x, y), (-dx, -dy), last[2], is_long)
        if is_long:
            segments[count, 0, 0], segments[count, 0, 1] = first[0], first[1]
            segments[count, 1, 0], segments[count, 1, 1] = last[0], last[1]
            count += 1
    return count


@inlined_jit
def _locate(table: Table, x: int, y: int, normal: int) -> None:
    """The counts of all lines that a pixel may lie on."""
    for turn in range(2 * _REACH + 1):
        b = normal + turn
        place = x * table.axes[0, b] + y * table.axes[1, b] + table.axes[2, b]
        table.cells[turn] = table.starts[b] + np.int32(place)


@inlined_jit
def _vote(table: Table, x: int, y: int, normal: int) -> tuple[int, int]:
    """The most votes of a line that a pixel may lie on, and that line's bin among the axes."""
    _locate(table, x, y, normal)
    best, most, place = 0, 0, 0
    for turn in range(2 * _REACH + 1):
        cell = np.uintp(table.cells[turn])
        votes = table.counts[cell] + 1
        table.counts[cell] = votes
        # Of equals the one that is nearest to the gradient is taken.
        off = turn - _REACH
        rank = _RANKS * votes - (2 * off if off > 0 else -2 * off - 1)
        if rank > best:
            best, most, place = rank, votes, turn
    return most, normal + place


@inlined_jit
def _walk(
    free: NDArray[np.int32], start: tuple[int, int], step: tuple[float, float], gap: int
) -> Way:
    """The last edge pixel on a way without a gap that is too long."""
    height, width = free.shape
    last_x, last_y, last = start[0], start[1], 0
    k = 1
    while k - last <= gap + 1:
        column, row = _at(start, step, k)
        if not (0 <= column < width and 0 <= row < height):
            break
        if free[np.uintp(row), np.uintp(column)] >= 0:
            last_x, last_y, last = column, row, k
        k += 1
    return last_x, last_y, last


@inlined_jit
def _take(
    pixels: Pixels,
    table: Table,
    start: tuple[int, int],
    step: tuple[float, float],
    steps: int,
    is_long: bool,
) -> None:
    """Count the pixels on a way as free no more; those of a segment take back their votes."""
    for k in range(steps + 1):
        column, row = _at(start, step, k)
        n = pixels.free[np.uintp(row), np.uintp(column)]
        pixels.free[np.uintp(row), np.uintp(column)] = -1
        if is_long and n >= 0 and pixels.has_voted[n]:
            _locate(table, pixels.xy[n, 0], pixels.xy[n, 1], pixels.normals[n])
            for turn in range(2 * _REACH + 1):
                table.counts[np.uintp(table.cells[turn])] -= 1


@inlined_jit
def _at(start: tuple[int, int], step: tuple[float, float], k: int) -> tuple[int, int]:
    """The pixel after so many steps."""
    return math.floor(start[0] + k * step[0] + 0.5), math.floor(start[1] + k * step[1] + 0.5)
