"""Compiled half of `padstudio.vision.pose.pose_posterior`: borders and what they weigh."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import fast_jit
from padstudio.geometry.projection import Projector, seen_at
from padstudio.vision.pose.drift_kernel import Rows
from padstudio.vision.pose.edge_points_kernel import Borders
from padstudio.vision.pose.least_squares_kernel import Sightings, scatter, trust_of
from padstudio.vision.pose.noise_kernel import TILES, newton_share, noise_share, tiles_of
from padstudio.vision.pose.row_motion_kernel import (
    RowSums,
    intervals_over,
    noise_sums,
    row_sums,
)

# Borders are seen within such a share of the frame of the row where they are expected.
_SAME_ROW = 0.05
# Widths of steps in a sharp picture differ by so much, frame pixels squared; and a blur's variance
# as of squared slopes is so many times the motion's, whose ends are its brightest.
_SHARP_WITHIN, _BLUR_GAIN = 0.2, 3.0
# Blurs about both axes are alike, unless their steps say otherwise with this share of their weight.
_ALIKE = 0.05


class Measured(NamedTuple):
    """Linearized residuals of borders.

    Attributes
    ----------
    rows : (N, 7) float64
        As of `padstudio.vision.pose.least_squares_kernel.Solution`.
    sides : (N, 2) float64
        Their change with the two biases toward the dark.
    row_time, weight : (N,) float64
    tile : (N,) int
    first, width : float
        Row time of the first interval's beginning, and an interval's length.
    intervals : int
    """

    rows: Array
    sides: Array
    row_time: Array
    weight: Array
    tile: NDArray[np.intp]
    first: float
    width: float
    intervals: int


@fast_jit
def predicted_rows(seen: Sightings, camera: Projector) -> Array:
    """Row times (N,) at which a pose puts borders: at those where they were seen, their residuals
    would pass for motion."""
    points, out = seen.points_mm, np.empty(len(seen.points_mm))
    height = camera.lens.height
    for i in range(len(points)):
        row = seen_at(points[i, 0], points[i, 1], points[i, 2], camera)[1]
        out[i] = (row - (height - 1) / 2) / height
        # A wide lens's polynomial has no row for some rays, or one far away.
        if not abs(out[i] - seen.row_time[i]) < _SAME_ROW:
            out[i] = seen.row_time[i]
    return out


@fast_jit
def measured(
    rows: Array, seen: Sightings, borders: Borders, xy: Array, camera: Projector
) -> Measured:
    """Borders seen at pixels (N, 2), linearized about a camera's pose."""
    row_time, sides = predicted_rows(seen, camera), np.zeros((len(rows), 2))
    for i in range(len(rows)):
        sides[i, 0 if borders.across_mm[i, 0] != 0 else 1] = np.sign(borders.step[i])
    first, width, count = intervals_over(row_time.min(), row_time.max())
    return Measured(rows, sides, row_time, seen.weight, tiles_of(xy), first, width, count)


@fast_jit
def weighed(measured: Measured, left: Array, predicted: Array, most_alike: float) -> Rows:
    """Normal equations by rows.

    Parameters
    ----------
    measured : Measured
    left, predicted : (N,) float64
        Residuals are what is left over what was predicted.
    most_alike : float
        As of `padstudio.vision.pose.noise_kernel.noise_share`.
    """
    weight, rows = measured.weight, measured.rows.copy()
    sigma = scatter(left, weight)
    trust = trust_of(left, weight, sigma)
    share = newton_share(trust * sigma**2 / np.maximum(weight, 1e-12), weight)
    rows[:, 0] = left
    normal, squares, scores = noise_sums(rows, trust, measured.tile, TILES**2)
    noise = noise_share(normal, squares, scores, len(rows), most_alike)
    rows[:, 0] += share * predicted
    first, width, count = measured.first, measured.width, measured.intervals
    sums = row_sums(rows, measured.sides, measured.row_time, trust, first, width, count)
    scaled = RowSums(sums.normal * (share**2 / noise), sums.pull * (share / noise))
    return Rows(scaled, first, width)


@fast_jit
def explained_by(measured: Measured, static: Array, drift: Array, sway: Array) -> Array:
    """Residuals (N,) that a step of pose and biases (8,), a drift (6,) and a shaking explain.

    The shaking (I + 1, 3) is that at the intervals' ends.
    """
    out = np.zeros(len(measured.rows))
    for i in range(len(out)):
        s = measured.row_time[i]
        at = (s - measured.first) / measured.width
        k = min(max(int(at), 0), measured.intervals - 1)
        for a in range(6):
            step = static[a] + s * drift[a]
            if a >= 3:
                begin, end = sway[k, a - 3], sway[k + 1, a - 3]
                step += begin + (at - k) * (end - begin)
            out[i] += measured.rows[i, 1 + a] * step
        out[i] += measured.sides[i, 0] * static[6] + measured.sides[i, 1] * static[7]
    return out


@fast_jit
def blur_variance(rows: Array, weight: Array, blur_px2: Array) -> Array:
    """Variances (3,) of the attitude while a row was exposed, radians², by steps' widths."""
    xx = xy = yy = right_x = right_y = 0.0
    for i in range(len(rows)):
        x, y, w = rows[i, 4] ** 2, rows[i, 5] ** 2, weight[i]
        wide = w * (blur_px2[i] - _SHARP_WITHIN)
        xx, xy, yy = xx + w * x * x, xy + w * x * y, yy + w * y * y
        right_x, right_y = right_x + x * wide, right_y + y * wide
    tie = _ALIKE * (xx + yy)
    xx, xy, yy = xx + tie, xy - tie, yy + tie
    scale = 1 / ((xx * yy - xy * xy) * _BLUR_GAIN)
    about_x = max((yy * right_x - xy * right_y) * scale, 0.0)
    about_y = max((xx * right_y - xy * right_x) * scale, 0.0)
    return np.array([about_x, about_y, (about_x + about_y) / 2])
