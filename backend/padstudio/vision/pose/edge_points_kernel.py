"""Compiled inner loops of `edge_points`, which documents what they compute."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import fast_inlined_jit, fast_jit
from padstudio.geometry.projection import Projector, picture, seen_at
from padstudio.vision.frame.pyramid import Window

# Samples of a profile, a pixel apart at the reach that the refiner asks for, and the lines side by
# side that it is averaged over.
_STEPS, _BESIDE_LINES = 13, 3
_SAMPLES = _STEPS * _BESIDE_LINES
# How often a profile is averaged with its neighbours, 1 : 2 : 1; together as by a Gaussian of 1.2
# samples, below which sharp steps are drawn to the pixels.
_SMOOTHINGS = 3
# Variances of a step's width: what smoothing adds, in reaches squared; areas of pixels, and what
# lies between them, in pixels of the window squared; and lens, mosaic and colours at half the scale
# of a sharp picture, in frame pixels squared. A profile's ends leave no more room than a share of
# its reach squared, and below a reach of so many pixels show less of a blur.
_SMOOTHED = (_SMOOTHINGS / 2 + 1 / 12) * (2 / (_STEPS - 1)) ** 2
_SAMPLED, _SHARP, _ROOM, _WHOLE_PX = 0.34, 1.8, 0.25, 4.0
# Profiles are averaged over lines to this share of half a cell on either side.
_BESIDE = 0.5
# Profiles never reach further than this share of a cell: beyond the half they meet the next border.
_MOST_REACH = 0.42
# A step of so many grey values is fully trusted; steps trusted less than this are left out.
_CLEAR_STEP = 6.0
_LEAST_WEIGHT = 0.05
# So many edges of cells tell how many of a field's borders lie in the frame: to a few per cent.
_POLLED = 512
# So many borders of a kind tell how far its steps seem to lie toward the dark.
_LEAST_BIASED = 12


class Borders(NamedTuple):
    """Middles of cell borders of one layer.

    Attributes
    ----------
    points_mm : (N, 3) float64
        Pad frame.
    across_mm : (N, 3) float64
        From the middle one cell further across the border, pad frame.
    along_mm : (N, 3) float64
        Half a cell along the border, pad frame.
    step : (N,) float64
        Level behind the border less level before it, over Y−1.
    """

    points_mm: Array
    across_mm: Array
    along_mm: Array
    step: Array

    def take(self, which: NDArray[np.intp]) -> Borders:
        """Some of the borders."""
        return Borders(
            self.points_mm[which], self.across_mm[which], self.along_mm[which], self.step[which]
        )

    def thinned(self, most: int) -> Borders:
        """At most ``most`` of the borders, evenly spread."""
        stride = -(-len(self.step) // most)
        return self if stride <= 1 else self.take(np.arange(0, len(self.step), stride))


class Patch(NamedTuple):
    """A part of a layer.

    Attributes
    ----------
    field : (R, C) uint8
        Levels of the whole layer.
    levels : int
    rows, cols : (first, last + 1)
        Of the part.
    cell_mm, pad_mm : (width, height) of float
        As measured.
    """

    field: NDArray[Any]
    levels: int
    rows: tuple[int, int]
    cols: tuple[int, int]
    cell_mm: tuple[float, float]
    pad_mm: tuple[float, float]


class Profile(NamedTuple):
    """Where a profile is taken, pixels of a picture.

    Attributes
    ----------
    at : (x, y)
        Its middle.
    reach : (x, y)
        Half its length.
    side : (x, y)
        How far the outer ones of the lines side by side lie from the middle one.
    """

    at: tuple[float, float]
    reach: tuple[float, float]
    side: tuple[float, float]


@fast_inlined_jit
def add_profile(
    samples: Array, profile: Profile, values: NDArray[np.uint8], step: int, first: int, gain: float
) -> None:
    """Add the values along a profile, averaged over lines side by side, times a gain.

    Loops of one result each go through vector registers; ``samples`` is as of `find_step`.
    """
    at, reach, side = profile.at, profile.reach, profile.side
    out, x, y = samples[0], samples[1], samples[2]
    here, right, below, beyond = samples[3], samples[4], samples[5], samples[6]
    for b in range(_BESIDE_LINES):
        f = (b - 1) / (_BESIDE_LINES - 1)
        for k in range(_STEPS):
            x[b * _STEPS + k] = at[0] + f * side[0] + (-1 + 2 * k / (_STEPS - 1)) * reach[0]
        for k in range(_STEPS):
            y[b * _STEPS + k] = at[1] + f * side[1] + (-1 + 2 * k / (_STEPS - 1)) * reach[1]
    for j in range(_SAMPLES):
        column, row = int(x[j]), int(y[j])
        x[j], y[j] = x[j] - column, y[j] - row
        # Unsigned places are not looked up from the end, which would be asked for at each of them.
        c, r = np.uintp(column * step + first), np.uintp(row)
        next_c, next_r = np.uintp(column * step + first + step), np.uintp(row + 1)
        here[j], right[j] = values[r, c], values[r, next_c]
        below[j], beyond[j] = values[next_r, c], values[next_r, next_c]
    for j in range(_SAMPLES):
        here[j] += x[j] * (right[j] - here[j])
    for j in range(_SAMPLES):
        below[j] += x[j] * (beyond[j] - below[j])
    for j in range(_SAMPLES):
        here[j] += y[j] * (below[j] - here[j])
    for b in range(_BESIDE_LINES):
        for k in range(_STEPS):
            out[k] += gain / _BESIDE_LINES * here[b * _STEPS + k]


@fast_inlined_jit
def find_step(
    window: Window, profile: Profile, sign: float, samples: Array
) -> tuple[float, float, float, float]:
    """Where along a profile a step lies and the variance of its width, in units of its reach; its
    rise, and all slope spent.

    The width is that of a Gaussian with the same spread of squared slopes, which noise hardly
    touches; a profile's smoothing is in it.

    The profile and the lines beside it must lie within the picture; ``samples`` is room for them,
    (7, `_SAMPLES`), the profile's values in its first row.
    """
    values = samples[0]
    for k in range(_STEPS):
        values[k] = 0.0
    add_profile(samples, profile, window.values, window.step, window.first, window.gain)
    if window.weight:
        f, (x, y) = window.scale, profile.at
        reach = (f * profile.reach[0], f * profile.reach[1])
        side = (f * profile.side[0], f * profile.side[1])
        coarse = Profile((f * x + window.shift, f * y + window.shift), reach, side)
        add_profile(samples, coarse, window.colours, 1, 0, window.weight)
    for _ in range(_SMOOTHINGS):
        before = values[0]
        for k in range(1, _STEPS - 1):
            here = values[k]
            values[k] = (before + 2 * here + values[k + 1]) / 4
            before = here
    rise = spent = weighted = power = spread = 0.0
    for k in range(1, _STEPS):
        slope = (values[k] - values[k - 1]) * sign
        spent += abs(slope)
        if slope > 0:
            rise += slope
            at = -1 + (2 * k - 1) / (_STEPS - 1)
            power += slope * slope
            weighted += slope * slope * at
            spread += slope * slope * at * at
    if power <= 0:
        return 0.0, 0.0, rise, spent
    middle = weighted / power
    return middle, 2 * (spread / power - middle * middle), rise, spent


@fast_jit
def sides_of(
    at: tuple[float, float, float],
    along: tuple[float, float],
    across: tuple[float, float],
    s: float,
    camera: Projector,
) -> tuple[float, float, float, float, float]:
    """A border's picture at row time s: along it by half a cell, its normal, and a cell's depth."""
    x, y, z = at
    ox, oy = picture(x, y, z, s, camera)
    tx, ty = picture(x + 0.2 * along[0], y + 0.2 * along[1], z, s, camera)
    cx, cy = picture(x + 0.05 * across[0], y + 0.05 * across[1], z, s, camera)
    tx, ty, cx, cy = 5 * (tx - ox), 5 * (ty - oy), 20 * (cx - ox), 20 * (cy - oy)
    length = max(math.hypot(tx, ty), 1e-9)
    nx, ny = -ty / length, tx / length
    depth = nx * cx + ny * cy
    return (tx, ty, nx, ny, depth) if depth >= 0 else (tx, ty, -nx, -ny, -depth)


@fast_jit
def find_borders(
    borders: Borders, camera: Projector, window: Window, reach_px: float
) -> tuple[NDArray[np.intp], Array, Array, Array]:
    """Steps near predicted borders: which were found, where (M, 2), their weights and by how much
    the variances of their widths exceed a sharp picture's, frame pixels squared (M,)."""
    points, across, along, step = borders
    h, w = len(window.values), window.width
    which, off = np.empty(len(points), np.intp), np.empty(len(points))
    blur = np.empty(len(points))
    xy, weight, normals = np.empty((len(points), 2)), np.empty(len(points)), np.empty_like(points)
    found, pixel, samples = 0, window.pixel, np.empty((7, _SAMPLES))
    for i in range(len(points)):
        at = (points[i, 0], points[i, 1], points[i, 2])
        px, py, s = seen_at(*at, camera)
        lx, ly = (px + 0.5) / pixel - 0.5, (py + 0.5) / pixel - 0.5
        if not (lx > 0 and ly > 0 and lx < w and ly < h):
            continue
        # The same time for all of it: what one step changes of that is next to nothing.
        s = 0.0 if camera.still else s
        beside, behind = (along[i, 0], along[i, 1]), (across[i, 0], across[i, 1])
        tx, ty, nx, ny, depth = sides_of(at, beside, behind, s, camera)
        reach = min(reach_px * pixel, _MOST_REACH * depth)
        rim = math.hypot(reach, _BESIDE * math.hypot(tx, ty)) / pixel + 1
        if not (lx > rim and ly > rim and lx < w - 1 - rim and ly < h - 1 - rim):
            continue
        shift, width, rise, spent = find_step(
            window,
            Profile(
                (lx, ly),
                (nx * reach / pixel, ny * reach / pixel),
                (_BESIDE * tx / pixel, _BESIDE * ty / pixel),
            ),
            1.0 if step[i] > 0 else -1.0,
            samples,
        )
        clean = min(1.0, max(0.0, 2 * rise / max(spent, 1e-9) - 1))
        trust = clean * clean * min(1.0, rise / _CLEAR_STEP)
        if trust > _LEAST_WEIGHT:
            which[found], weight[found], off[found] = i, trust, shift * reach
            blur[found] = excess_width(width * reach * reach, reach, pixel)
            xy[found, 0], xy[found, 1] = px, py
            normals[found, 0], normals[found, 1] = nx, ny
            found += 1
    which, off = which[:found], off[:found]
    off = off - edge_bias(off, across[which, 0] != 0, step[which] > 0)
    for k in range(found):
        xy[k, 0] += off[k] * normals[k, 0]
        xy[k, 1] += off[k] * normals[k, 1]
    return which, xy[:found], weight[:found], blur[:found]


@fast_jit
def widths_px(borders: Borders, camera: Projector, stride: int) -> Array:
    """Widths of the cells at each so manieth border, frame pixels; 0 beyond the horizon."""
    points, across = borders.points_mm, borders.across_mm
    out = np.empty(-(-len(points) // stride))
    for k in range(len(out)):
        i = k * stride
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        px, py, _ = seen_at(x, y, z, camera)
        qx, qy, _ = seen_at(x + 0.05 * across[i, 0], y + 0.05 * across[i, 1], z, camera)
        width = 20 * math.hypot(qx - px, qy - py)
        out[k] = 0.0 if math.isnan(width) else width
    return out


@fast_jit
def telling_width(borders: Borders, camera: Projector, most: int) -> tuple[float, float]:
    """Median and least of `widths_px` at so many borders."""
    width = widths_px(borders, camera, -(-len(borders.step) // most))
    return float(np.median(width)), width.min()


@fast_jit
def excess_width(width: float, reach: float, pixel: float) -> float:
    """By how much a step's variance of width, frame pixels squared, exceeds a sharp picture's."""
    square = reach * reach
    sharp = _SMOOTHED * square + _SAMPLED * pixel * pixel + min(_SHARP, _ROOM * square)
    return (width - sharp) / min(1.0, square / (_WHOLE_PX * _WHOLE_PX))


@fast_jit
def edge_bias(off: Array, upright: NDArray[np.bool_], rising: NDArray[np.bool_]) -> Array:
    """By how much each step seems to lie toward the dark, pixels, (N,)."""
    out = np.zeros(len(off))
    for kind in (True, False):
        up = off[(upright == kind) & rising]
        down = off[(upright == kind) & ~rising]
        if min(len(up), len(down)) >= _LEAST_BIASED:
            by = (np.median(up) - np.median(down)) / 2
            for k in range(len(off)):
                if upright[k] == kind:
                    out[k] = by if rising[k] else -by
    return out


@fast_jit
def borders_in_view(patch: Patch, camera: Projector, most: int) -> Borders:
    """Borders of a part of a layer that lie in the frame, at most so many, evenly spread."""
    rows, cols, size = patch.rows, patch.cols, patch.cell_mm
    edges = 2 * max(rows[1] - rows[0], 0) * max(cols[1] - cols[0], 0)
    stride = max(1, edges // _POLLED)
    polled = len(every_border(patch, camera, stride))
    stride = max(1, int(0.9 * stride * polled / most))
    # Columns must not be met in step with their number.
    while math.gcd(stride, cols[1] - cols[0]) > 1:
        stride -= 1
    found = every_border(patch, camera, stride)
    count = min(len(found), most)
    points, across, along = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros((count, 3))
    step = np.empty(count)
    for i in range(count):
        points[i, 0], points[i, 1], change, upright = found[i * len(found) // count]
        step[i] = change / (patch.levels - 1)
        if upright:
            across[i, 0], along[i, 1] = size[0], -size[1] / 2
        else:
            across[i, 1], along[i, 0] = -size[1], size[0] / 2
    return Borders(points, across, along, step)


@fast_jit
def every_border(patch: Patch, camera: Projector, stride: int) -> Array:
    """Of each ``stride``-th edge of a part's cells the borders that lie in the frame.

    Rows (M, 4): where the border lies on the pad, mm, the change of level over it, and whether it
    is upright.
    """
    field, rows, cols = patch.field, patch.rows, patch.cols
    width, height = camera.lens.width, camera.lens.height
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
            x = (c + (1.0 if kind else 0.5)) * patch.cell_mm[0] - patch.pad_mm[0] / 2
            y = patch.pad_mm[1] / 2 - (r + (0.5 if kind else 1.0)) * patch.cell_mm[1]
            px, py, _ = seen_at(x, y, 0.0, camera)
            if px > 1 and py > 1 and px < width - 2 and py < height - 2:
                out[found, 0], out[found, 1], out[found, 2], out[found, 3] = x, y, change, kind
                found += 1
    return out[:found]
