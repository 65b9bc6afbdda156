"""Compiled inner loops of `hough`, which documents what they compute."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import jit

# Bins of a line's normal over half a turn: three quarters of a degree each.
BINS = 240
# A pixel votes for lines whose normals are this near to its gradient, bins: ten degrees.
_REACH = 13

Votes = NDArray[np.int16]
Numbers = NDArray[np.int32]
Way = tuple[int, int, int]


@jit
def find_segments(
    shape: tuple[int, int], xy: Numbers, normals: Numbers, votes: int, length: float, gap: int
) -> Array:
    """Segments (N, 2, 2) of edge pixels; `xy` (N, 2) and `normals` (N,) in the order of voting."""
    height, width = shape
    turns = np.arange(BINS) * math.pi / BINS
    axes = np.stack((np.cos(turns), np.sin(turns)), axis=1)
    counts = np.zeros((BINS, 2 * (width + height) + 1), np.int16)
    # Numbers of the pixels that no segment has taken and no way has tried in vain.
    free = np.full((height, width), -1, np.int32)
    for k in range(len(xy)):
        free[xy[k, 1], xy[k, 0]] = k
    has_voted = np.zeros(len(xy), np.bool_)
    segments, count = np.empty((len(xy), 2, 2)), 0
    for k in range(len(xy)):
        x, y = xy[k]
        if free[y, x] < 0:
            continue
        most, best = _vote(counts, xy[k], normals[k], axes)
        has_voted[k] = True
        if most < votes:
            continue
        across, down = -axes[best, 1], axes[best, 0]
        first, last = _walk(free, x, y, across, down, gap), _walk(free, x, y, -across, -down, gap)
        is_long = max(abs(last[0] - first[0]), abs(last[1] - first[1])) >= length
        for way, sign in ((first, 1.0), (last, -1.0)):
            for step in range(way[2] + 1):
                column, row = _at(x, y, sign * across, sign * down, step)
                n = free[row, column]
                free[row, column] = -1
                if is_long and n >= 0 and has_voted[n]:
                    _withdraw(counts, xy[n], normals[n], axes)
        if is_long:
            segments[count, 0, 0], segments[count, 0, 1] = first[0], first[1]
            segments[count, 1, 0], segments[count, 1, 1] = last[0], last[1]
            count += 1
    return segments[:count].copy()


@jit
def _vote(counts: Votes, at: Numbers, normal: int, axes: Array) -> tuple[int, int]:
    """The most votes of a line that a pixel may lie on, and that line's bin."""
    most, best = 0, 0
    for turn in range(2 * _REACH + 1):
        # Of equals the first is taken: the one that is nearest to the gradient.
        b = (normal + (turn + 1) // 2 * (1 - turn % 2 * 2)) % BINS
        rho = _distance(counts, at, axes, b)
        counts[b, rho] += 1
        if counts[b, rho] > most:
            most, best = counts[b, rho], b
    return most, best


@jit
def _withdraw(counts: Votes, at: Numbers, normal: int, axes: Array) -> None:
    """Take back a pixel's votes."""
    for step in range(-_REACH, _REACH + 1):
        b = (normal + step) % BINS
        counts[b, _distance(counts, at, axes, b)] -= 1


@jit
def _distance(counts: Votes, at: Numbers, axes: Array, b: int) -> int:
    """The cell of a line's distance from the origin; half of them are of negative ones."""
    half: int = counts.shape[1] // 2
    rho: int = math.floor(at[0] * axes[b, 0] + at[1] * axes[b, 1] + 0.5)
    return half + rho


@jit
def _walk(free: Numbers, x: int, y: int, dx: float, dy: float, gap: int) -> Way:
    """The last edge pixel (x, y) on a way without a gap that is too long, and the steps to it."""
    height, width = free.shape
    last_x, last_y, last = x, y, 0
    step = 1
    while step - last <= gap + 1:
        column, row = _at(x, y, dx, dy, step)
        if not (0 <= column < width and 0 <= row < height):
            break
        if free[row, column] >= 0:
            last_x, last_y, last = column, row, step
        step += 1
    return last_x, last_y, last


@jit
def _at(x: int, y: int, dx: float, dy: float, step: int) -> tuple[int, int]:
    """The pixel after so many steps, each of one pixel along the way's longer axis."""
    major = max(abs(dx), abs(dy))
    return math.floor(x + step * dx / major + 0.5), math.floor(y + step * dy / major + 0.5)
