"""Compiled inner loops of `padstudio.vision.borders`, which documents what they compute."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from padstudio.pad.jit import fast_jit
from padstudio.vision.kernels import picture, seen_at
from padstudio.vision.types import Array

# Samples of a profile, and the lines side by side that it is averaged over.
_STEPS, _BESIDE_LINES = 13, 3
# How often a profile is averaged with its neighbours, 1 : 2 : 1.
_SMOOTHINGS = 3
# Profiles are averaged over lines to this share of half a cell on either side.
_BESIDE = 0.5
# Profiles never reach further than this share of a cell.
_MOST_REACH = 0.42
# A step of so many grey values is fully trusted.
_CLEAR_STEP = 6.0
_LEAST_WEIGHT = 0.05
# So many borders of a kind tell how far its steps lean toward the dark.
_LEAST_TO_LEAN = 12


@fast_jit
def find_step(
    values: NDArray[Any],
    x: float,
    y: float,
    reach_x: float,
    reach_y: float,
    side_x: float,
    side_y: float,
    sign: float,
) -> tuple[float, float, float]:
    """Where along a profile a step lies, in units of its reach; its rise, and all slope spent.

    The profile and the lines beside it must lie within the plane.
    """
    profile = np.empty(_STEPS)
    for k in range(_STEPS):
        t = -1 + 2 * k / (_STEPS - 1)
        total = 0.0
        for b in range(_BESIDE_LINES):
            f = (b - 1) / (_BESIDE_LINES - 1)
            px, py = x + f * side_x + t * reach_x, y + f * side_y + t * reach_y
            c, r = np.uintp(px), np.uintp(py)
            fx, fy = px - c, py - r
            top = values[r, c] * (1 - fx) + values[r, c + 1] * fx
            low = values[r + 1, c] * (1 - fx) + values[r + 1, c + 1] * fx
            total += top * (1 - fy) + low * fy
        profile[k] = total / _BESIDE_LINES
    for _ in range(_SMOOTHINGS):
        before = profile[0]
        for k in range(1, _STEPS - 1):
            here = profile[k]
            profile[k] = (before + 2 * here + profile[k + 1]) / 4
            before = here
    rise = spent = weighted = power = 0.0
    for k in range(1, _STEPS):
        slope = (profile[k] - profile[k - 1]) * sign
        spent += abs(slope)
        if slope > 0:
            rise += slope
            power += slope * slope
            weighted += slope * slope * (-1 + (2 * k - 1) / (_STEPS - 1))
    return (weighted / power if power > 0 else 0.0), rise, spent


@fast_jit
def find_borders(
    points: Array,
    along: Array,
    across: Array,
    step: Array,
    pose: Array,
    matrix: Array,
    lens: Array,
    height: int,
    still: bool,
    values: NDArray[Any],
    plane: Array,
    reach_px: float,
) -> tuple[NDArray[np.intp], Array, Array]:
    """Steps near predicted borders: which were found, where (M, 2), and their weights (M,).

    ``plane`` holds the side of the plane's pixels, and where frame pixel (0, 0) lies in it.
    """
    h, w = values.shape
    which, off = np.empty(len(points), np.intp), np.empty(len(points))
    xy, weight, normals = np.empty((len(points), 2)), np.empty(len(points)), np.empty_like(points)
    found, pixel = 0, plane[0]
    for i in range(len(points)):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        px, py, s = seen_at(x, y, z, pose, matrix, lens, height, still)
        lx, ly = px / pixel + plane[1], py / pixel + plane[2]
        if not (lx > 0 and ly > 0 and lx < w and ly < h):
            continue
        # The same moment for all three: what one step changes of it is next to nothing.
        s = 0.0 if still else s
        ox, oy = picture(x, y, z, s, pose, matrix, lens)
        tx, ty = picture(x + 0.2 * along[i, 0], y + 0.2 * along[i, 1], z, s, pose, matrix, lens)
        cx, cy = picture(x + 0.05 * across[i, 0], y + 0.05 * across[i, 1], z, s, pose, matrix, lens)
        tx, ty, cx, cy = 5 * (tx - ox), 5 * (ty - oy), 20 * (cx - ox), 20 * (cy - oy)
        length = max(math.hypot(tx, ty), 1e-9)
        nx, ny = -ty / length, tx / length
        depth = nx * cx + ny * cy
        if depth < 0:
            nx, ny, depth = -nx, -ny, -depth
        reach = min(reach_px * pixel, _MOST_REACH * depth)
        rim = math.hypot(reach, _BESIDE * length) / pixel + 1
        if not (lx > rim and ly > rim and lx < w - 1 - rim and ly < h - 1 - rim):
            continue
        shift, rise, spent = find_step(
            values,
            lx,
            ly,
            nx * reach / pixel,
            ny * reach / pixel,
            _BESIDE * tx / pixel,
            _BESIDE * ty / pixel,
            1.0 if step[i] > 0 else -1.0,
        )
        clean = min(1.0, max(0.0, 2 * rise / max(spent, 1e-9) - 1))
        trust = clean * clean * min(1.0, rise / _CLEAR_STEP)
        if trust > _LEAST_WEIGHT:
            which[found], weight[found], off[found] = i, trust, shift * reach
            xy[found, 0], xy[found, 1] = px, py
            normals[found, 0], normals[found, 1] = nx, ny
            found += 1
    which, off = which[:found], off[:found]
    off = off - lean(off, across[which, 0] != 0, step[which] > 0)
    for k in range(found):
        xy[k, 0] += off[k] * normals[k, 0]
        xy[k, 1] += off[k] * normals[k, 1]
    return which, xy[:found], weight[:found]


@fast_jit
def lean(off: Array, upright: NDArray[np.bool_], rising: NDArray[np.bool_]) -> Array:
    """By how much each step seems to lie toward the dark, pixels, (N,)."""
    out = np.zeros(len(off))
    for kind in (True, False):
        up = off[(upright == kind) & rising]
        down = off[(upright == kind) & ~rising]
        if min(len(up), len(down)) >= _LEAST_TO_LEAN:
            by = (np.median(up) - np.median(down)) / 2
            for k in range(len(off)):
                if upright[k] == kind:
                    out[k] = by if rising[k] else -by
    return out


@fast_jit
def borders_in_view(
    field: NDArray[Any],
    rows: tuple[int, int],
    cols: tuple[int, int],
    size: Array,
    pose: Array,
    matrix: Array,
    lens: Array,
    height: int,
    still: bool,
    width: int,
    most: int,
) -> tuple[Array, NDArray[np.intp], NDArray[np.bool_]]:
    """Borders of a part of a field that lie in the frame, at most so many, evenly spread.

    ``size`` holds a cell's sides and the pad's, mm. Returns where they lie on the pad (M, 2), the
    change of level over each, and whether it is upright.
    """
    total = 0
    for r in range(rows[0], rows[1]):
        for c in range(cols[0], cols[1]):
            total += c + 1 < cols[1] and field[r, c] != field[r, c + 1]
            total += r + 1 < rows[1] and field[r, c] != field[r + 1, c]
    stride = max(1, -(-total // (3 * most)))
    points, change = np.empty((total // stride + 1, 2)), np.empty(total // stride + 1, np.intp)
    upright = np.empty(len(change), np.bool_)
    seen = found = 0
    for kind in (True, False):
        for r in range(rows[0], rows[1] - (not kind)):
            for c in range(cols[0], cols[1] - kind):
                after = field[r, c + 1] if kind else field[r + 1, c]
                if after == field[r, c]:
                    continue
                seen += 1
                if (seen - 1) % stride:
                    continue
                x = (c + (1.0 if kind else 0.5)) * size[0] - size[2] / 2
                y = size[3] / 2 - (r + (0.5 if kind else 1.0)) * size[1]
                px, py, _ = seen_at(x, y, 0.0, pose, matrix, lens, height, still)
                if px > 1 and py > 1 and px < width - 2 and py < height - 2:
                    points[found, 0], points[found, 1], upright[found] = x, y, kind
                    change[found] = np.intp(after) - np.intp(field[r, c])
                    found += 1
    thin = max(1, -(-found // most))
    return points[:found:thin], change[:found:thin], upright[:found:thin]
