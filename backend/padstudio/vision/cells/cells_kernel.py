"""Compiled inner loops of `padstudio.vision.cells.sampling`, which documents what they compute."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import fast_jit
from padstudio.vision.frame.pixels_kernel import value_at
from padstudio.vision.frame.pyramid import Window

# So many lines of cells tell how wide they are; a median needs no more.
_TELLING = 16
# Under tilt cells narrower than this, pixels, are left to the horizon, where enough others are
# wider: two pixels a cell is the sampling limit, and 60 cells of two levels are beyond chance.
_LEAST_WIDTH, _ENOUGH = 2.0, 60
# Of a block's values, squares of grey values: half a grey value.
_LEAST_VARIANCE = 0.25
# Where a cell is read whose centre is out of view: toward a side, then toward a corner, by this
# part of a cell. Not so far that its neighbour shows at the scale that cells are read at. Close to
# the ground such cells are a third of all.
_OFF_CENTRE = 0.2
_ASIDE = ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1))


@fast_jit
def locate(
    nodes: Array, every: int, shape: tuple[int, int], frame: tuple[int, int]
) -> tuple[Array, NDArray[np.bool_], float]:
    """Where the cells of a lattice are read in a frame.

    Parameters
    ----------
    nodes : (⌈(R−1)/every⌉ + 1, …, 2) float64
        Centres of each ``every``-th cell along rows and columns, frame pixels.
    every : int
    shape : (R, C)
    frame : (width, height)

    Returns
    -------
    xy : (R, C, 2) float64
    seen : (R, C) bool
    width_px : float
        Median side of a cell.
    """
    xy = spread(nodes, every, shape)
    seen = bring_into_view(xy, frame[0], frame[1])
    leave_out_small(xy, seen, _LEAST_WIDTH, _ENOUGH)
    return xy, seen, width_px(xy, seen)


@fast_jit
def sample(window: Window, xy: Array, seen: NDArray[np.bool_]) -> NDArray[np.float32]:
    """Values (R, C) of a window between its pixels at frame pixels (R, C, 2), 0 where not seen."""
    out, scale = np.zeros(seen.shape, np.float32), 1 / window.pixel
    for r in range(seen.shape[0]):
        for c in range(seen.shape[1]):
            if seen[r, c]:
                column, row = (xy[r, c, 0] + 0.5) * scale - 0.5, (xy[r, c, 1] + 0.5) * scale - 0.5
                out[r, c] = value_at(window, column, row)
    return out


@fast_jit
def relative(
    values: NDArray[np.float32], seen: NDArray[np.bool_], block: int
) -> NDArray[np.float32]:
    """Values against mean and deviation of those seen in the block round each, 0 where not seen."""
    out = np.zeros(values.shape, np.float32)
    mean, deviation = moments(values, seen, block)
    for r in range(values.shape[0]):
        for c in range(values.shape[1]):
            if seen[r, c]:
                out[r, c] = (values[r, c] - mean[r, c]) / deviation[r, c]
    return out


@fast_jit
def moments(
    values: NDArray[np.float32], seen: NDArray[np.bool_], block: int
) -> tuple[Array, Array]:
    """Mean and deviation (R, C) of the values seen in the block round each cell.

    The sums of a block are those of the block before it, a row or column added and one taken off.
    """
    (rows, cols), half = values.shape, block // 2
    mean, deviation = np.zeros(values.shape), np.ones(values.shape)
    sums = np.zeros((3, cols))
    for r in range(-half, rows):
        for sign, row in ((1.0, r + half), (-1.0, r - half - 1)):
            if 0 <= row < rows:
                for c in range(cols):
                    share = sign if seen[row, c] else 0.0
                    value = float(values[row, c])
                    sums[0, c] += share
                    sums[1, c] += share * value
                    sums[2, c] += share * value * value
        if r < 0:
            continue
        count = total = square = 0.0
        for c in range(-half, cols):
            if c + half < cols:
                count, total = count + sums[0, c + half], total + sums[1, c + half]
                square += sums[2, c + half]
            if c > half:
                count, total = count - sums[0, c - half - 1], total - sums[1, c - half - 1]
                square -= sums[2, c - half - 1]
            if c >= 0:
                cells = max(count, 1.0)
                mean[r, c] = total / cells
                variance = square / cells - mean[r, c] * mean[r, c]
                deviation[r, c] = math.sqrt(max(variance, _LEAST_VARIANCE))
    return mean, deviation


@fast_jit
def spread(nodes: Array, every: int, shape: tuple[int, int]) -> Array:
    """Places (R, C, 2) between nodes (⌈(R−1)/every⌉ + 1, …, 2) that stand for each such row."""
    out = np.empty((shape[0], shape[1], 2))
    for r in range(shape[0]):
        fr, i = (r % every) / every, r // every
        below = min(i + 1, len(nodes) - 1)
        for k in range(nodes.shape[1]):
            right = min(k + 1, nodes.shape[1] - 1)
            for c in range(k * every, min((k + 1) * every, shape[1])):
                fc = (c - k * every) / every
                for axis in range(2):
                    top = nodes[i, k, axis] * (1 - fc) + nodes[i, right, axis] * fc
                    low = nodes[below, k, axis] * (1 - fc) + nodes[below, right, axis] * fc
                    out[r, c, axis] = top * (1 - fr) + low * fr
    return out


@fast_jit
def bring_into_view(xy: Array, width: int, height: int) -> NDArray[np.bool_]:
    """Which cells (R, C, 2) are seen; those that the frame cuts are moved to where they show."""
    rows, cols = xy.shape[:2]
    seen = np.zeros((rows, cols), np.bool_)
    moved = np.empty((rows, cols, 2))
    for r in range(rows):
        for c in range(cols):
            x, y = xy[r, c, 0], xy[r, c, 1]
            seen[r, c] = 0 <= x <= width - 1 and 0 <= y <= height - 1
            moved[r, c, 0], moved[r, c, 1] = x, y
            if seen[r, c] or min(rows, cols) < 2:
                continue
            right, below = c - 1 if c + 1 == cols else c, r - 1 if r + 1 == rows else r
            ax, ay = xy[r, right + 1, 0] - xy[r, right, 0], xy[r, right + 1, 1] - xy[r, right, 1]
            bx, by = xy[below + 1, c, 0] - xy[below, c, 0], xy[below + 1, c, 1] - xy[below, c, 1]
            # Few cells lie within one of the frame, and none that are NaN do.
            reach_x, reach_y = abs(ax) + abs(bx), abs(ay) + abs(by)
            near_x = -reach_x <= x <= width - 1 + reach_x
            if not (near_x and -reach_y <= y <= height - 1 + reach_y):
                continue
            for aside in _ASIDE:
                across, down = _OFF_CENTRE * aside[0], _OFF_CENTRE * aside[1]
                px, py = x + across * ax + down * bx, y + across * ay + down * by
                if 0 <= px <= width - 1 and 0 <= py <= height - 1:
                    seen[r, c] = True
                    moved[r, c, 0], moved[r, c, 1] = px, py
                    break
    xy[:] = moved
    return seen


@fast_jit
def width_px(xy: Array, seen: NDArray[np.bool_]) -> float:
    """Median distance of neighbouring centres (R, C, 2), pixels; of the shorter side under tilt."""
    rows, cols = seen.shape
    least = np.inf
    for down, across in ((0, 1), (1, 0)):
        steps = np.empty(seen.size)
        found = 0
        stride = max(1, (rows if across else cols) // _TELLING)
        for r in range(0, rows - down, stride if across else 1):
            for c in range(0, cols - across, stride if down else 1):
                if seen[r, c] and seen[r + down, c + across]:
                    x = xy[r + down, c + across, 0] - xy[r, c, 0]
                    steps[found] = math.hypot(x, xy[r + down, c + across, 1] - xy[r, c, 1])
                    found += 1
        if found:
            least = min(least, float(np.median(steps[:found])))
    return least if least < np.inf else 1.0


@fast_jit
def leave_out_small(xy: Array, seen: NDArray[np.bool_], least_px: float, enough: int) -> None:
    """Count cells narrower than so many pixels as not seen, where enough others are wider."""
    rows, cols = seen.shape
    wide = np.zeros(seen.shape, np.bool_)
    count = 0
    for r in range(rows - 1):
        for c in range(cols - 1):
            if seen[r, c]:
                x, y = xy[r, c, 0], xy[r, c, 1]
                across = (xy[r, c + 1, 0] - x) ** 2 + (xy[r, c + 1, 1] - y) ** 2
                down = (xy[r + 1, c, 0] - x) ** 2 + (xy[r + 1, c, 1] - y) ** 2
                # Beyond the horizon there is no neighbour to measure by.
                wide[r, c] = not (across < least_px**2 or down < least_px**2)
                count += wide[r, c]
    if count < enough:
        return
    for r in range(rows):
        for c in range(cols):
            seen[r, c] = seen[r, c] and wide[min(r, max(rows - 2, 0)), min(c, max(cols - 2, 0))]


@fast_jit
def compare(
    levels: NDArray[np.int8], expected: NDArray[np.int8], count: int
) -> tuple[int, NDArray[np.intp]]:
    """How many of the cells (R, C) read and expected agree, and how often each level is expected.

    Cells of a negative level in either do not count.
    """
    agree, frequency = 0, np.zeros(count, np.intp)
    for r in range(levels.shape[0]):
        for c in range(levels.shape[1]):
            if levels[r, c] >= 0 and expected[r, c] >= 0:
                frequency[expected[r, c]] += 1
                agree += levels[r, c] == expected[r, c]
    return agree, frequency
