"""Compiled inner loops of `edge_points`, which documents what they compute."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import fast_jit
from padstudio.geometry.projection import picture, seen_at
from padstudio.vision.frame.pixels_kernel import between
from padstudio.vision.frame.pyramid import Window

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
# So many edges of cells tell how many of a field's borders lie in the frame.
_POLLED = 512
# So many borders of a kind tell how far its steps lean toward the dark.
_LEAST_TO_LEAN = 12


@fast_jit
def add_profile(
    profile: Array,
    values: NDArray[np.uint8],
    step: int,
    first: int,
    gain: float,
    at: tuple[float, float],
    reach: tuple[float, float],
    side: tuple[float, float],
) -> None:
    """Add the values along a profile, averaged over lines side by side, times a gain."""
    gain /= _BESIDE_LINES
    for k in range(_STEPS):
        t = -1 + 2 * k / (_STEPS - 1)
        for b in range(_BESIDE_LINES):
            f = (b - 1) / (_BESIDE_LINES - 1)
            x = at[0] + f * side[0] + t * reach[0]
            y = at[1] + f * side[1] + t * reach[1]
            profile[k] += gain * between(values, step, first, x, y)


@fast_jit
def find_step(
    window: Window,
    at: tuple[float, float],
    reach: tuple[float, float],
    side: tuple[float, float],
    sign: float,
    profile: Array,
) -> tuple[float, float, float]:
    """Where along a profile a step lies, in units of its reach; its rise, and all slope spent.

    The profile (_STEPS,) and the lines beside it must lie within the picture.
    """
    profile[:] = 0.0
    add_profile(profile, window.values, window.step, window.first, window.gain, at, reach, side)
    if window.weight:
        f = window.scale
        at = (f * at[0] + window.shift, f * at[1] + window.shift)
        reach, side = (f * reach[0], f * reach[1]), (f * side[0], f * side[1])
        add_profile(profile, window.colours, 1, 0, window.weight, at, reach, side)
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
def sides_of(
    at: tuple[float, float, float],
    along: tuple[float, float],
    across: tuple[float, float],
    s: float,
    pose: Array,
    matrix: Array,
    lens: Array,
) -> tuple[float, float, float, float, float]:
    """A border's picture at a moment: along it by half a cell, its normal, and a cell's depth."""
    x, y, z = at
    ox, oy = picture(x, y, z, s, pose, matrix, lens)
    tx, ty = picture(x + 0.2 * along[0], y + 0.2 * along[1], z, s, pose, matrix, lens)
    cx, cy = picture(x + 0.05 * across[0], y + 0.05 * across[1], z, s, pose, matrix, lens)
    tx, ty, cx, cy = 5 * (tx - ox), 5 * (ty - oy), 20 * (cx - ox), 20 * (cy - oy)
    length = max(math.hypot(tx, ty), 1e-9)
    nx, ny = -ty / length, tx / length
    depth = nx * cx + ny * cy
    return (tx, ty, nx, ny, depth) if depth >= 0 else (tx, ty, -nx, -ny, -depth)


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
    window: Window,
    reach_px: float,
) -> tuple[NDArray[np.intp], Array, Array]:
    """Steps near predicted borders: which were found, where (M, 2), and their weights (M,)."""
    h, w = len(window.values), window.width
    which, off = np.empty(len(points), np.intp), np.empty(len(points))
    xy, weight, normals = np.empty((len(points), 2)), np.empty(len(points)), np.empty_like(points)
    found, pixel, profile = 0, window.pixel, np.empty(_STEPS)
    for i in range(len(points)):
        at = (points[i, 0], points[i, 1], points[i, 2])
        px, py, s = seen_at(*at, pose, matrix, lens, height, still)
        lx, ly = (px + 0.5) / pixel - 0.5, (py + 0.5) / pixel - 0.5
        if not (lx > 0 and ly > 0 and lx < w and ly < h):
            continue
        # The same moment for all of it: what one step changes of that is next to nothing.
        s = 0.0 if still else s
        beside, behind = (along[i, 0], along[i, 1]), (across[i, 0], across[i, 1])
        tx, ty, nx, ny, depth = sides_of(at, beside, behind, s, pose, matrix, lens)
        reach = min(reach_px * pixel, _MOST_REACH * depth)
        rim = math.hypot(reach, _BESIDE * math.hypot(tx, ty)) / pixel + 1
        if not (lx > rim and ly > rim and lx < w - 1 - rim and ly < h - 1 - rim):
            continue
        shift, rise, spent = find_step(
            window,
            (lx, ly),
            (nx * reach / pixel, ny * reach / pixel),
            (_BESIDE * tx / pixel, _BESIDE * ty / pixel),
            1.0 if step[i] > 0 else -1.0,
            profile,
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
    levels: int,
    pose: Array,
    matrix: Array,
    lens: Array,
    height: int,
    still: bool,
    width: int,
    most: int,
) -> tuple[Array, Array, Array, Array]:
    """Borders of a part of a field that lie in the frame, at most so many, evenly spread.

    ``size`` holds a cell's sides and the pad's, mm. Returns what
    `padstudio.vision.pose.edge_points.Borders` holds.
    """
    camera = (pose, matrix, lens, height, still)
    edges = 2 * max(rows[1] - rows[0], 0) * max(cols[1] - cols[0], 0)
    stride = max(1, edges // _POLLED)
    polled = len(every_border(field, rows, cols, size, camera, width, stride))
    stride = max(1, int(0.9 * stride * polled / most))
    # Columns must not be met in step with their number.
    while math.gcd(stride, cols[1] - cols[0]) > 1:
        stride -= 1
    found = every_border(field, rows, cols, size, camera, width, stride)
    count = min(len(found), most)
    points, across, along = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros((count, 3))
    step = np.empty(count)
    for i in range(count):
        points[i, 0], points[i, 1], change, upright = found[i * len(found) // count]
        step[i] = change / (levels - 1)
        if upright:
            across[i, 0], along[i, 1] = size[0], -size[1] / 2
        else:
            across[i, 1], along[i, 0] = -size[1], size[0] / 2
    return points, across, along, step


@fast_jit
def every_border(
    field: NDArray[Any],
    rows: tuple[int, int],
    cols: tuple[int, int],
    size: Array,
    camera: tuple[Array, Array, Array, int, bool],
    width: int,
    stride: int,
) -> Array:
    """Of each ``stride``-th edge of a field's cells the borders that lie in the frame.

    Rows (M, 4): where the border lies on the pad, mm, the change of level over it, and whether it
    is upright.
    """
    pose, matrix, lens, height, still = camera
    across = cols[1] - cols[0]
    most = 2 * ((rows[1] - rows[0]) * across // stride + 1) if across > 0 else 0
    out = np.empty((most, 4))
    found = 0
    for kind in (True, False):
        r, c = rows[0], cols[0] - stride
        while most > 0:
            c += stride
            if c >= cols[1]:
                r, c = r + (c - cols[0]) // across, cols[0] + (c - cols[0]) % across
            if r + (not kind) >= rows[1]:
                break
            if c + kind >= cols[1]:
                continue
            change = np.intp(field[r + (not kind), c + kind]) - np.intp(field[r, c])
            if change == 0:
                continue
            x = (c + (1.0 if kind else 0.5)) * size[0] - size[2] / 2
            y = size[3] / 2 - (r + (0.5 if kind else 1.0)) * size[1]
            px, py, _ = seen_at(x, y, 0.0, pose, matrix, lens, height, still)
            if px > 1 and py > 1 and px < width - 2 and py < height - 2:
                out[found, 0], out[found, 1], out[found, 2], out[found, 3] = x, y, change, kind
                found += 1
    return out[:found]
