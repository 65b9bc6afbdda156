"""How sure a pose is that borders were measured for, and the pose itself, motion considered.

Residuals tell their own noise: weights that fall as residuals grow are put right by the sandwich of
squared scores, residuals that are alike near each other by their sums over tiles. Motion while the
shutter rolled is told by the rows (`row_motion`), motion while they were exposed by how much wider
steps are than those of a sharp picture: by the middle of its exposure a vibrating camera may be
anywhere within its blur.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from padstudio.arrays import Array
from padstudio.geometry.camera import Camera
from padstudio.geometry.rolling_shutter import MovingPose, row_times
from padstudio.vision.pose.covariance import TILES, newton_share, noise_share, tiles_of
from padstudio.vision.pose.edge_points import EdgePoints
from padstudio.vision.pose.least_squares_kernel import Sightings, Solution, scatter, trust_of
from padstudio.vision.pose.row_motion import MotionBounds, RowFit, explain_rows, intervals_over
from padstudio.vision.pose.row_motion_kernel import RowSums, noise_sums, row_sums

# Widths of steps in a sharp picture differ by so much, frame pixels squared; and a blur's variance
# as of squared slopes is so many times the motion's, whose ends are its brightest.
_SHARP_WITHIN, _BLUR_GAIN = 0.2, 3.0
# A sharp picture is blurrier than the pattern by no more than this, frame pixels squared; and the
# motion's variance is so many times what a small change of the blur would explain.
_PATTERN_WITHIN, _PATTERN_GAIN = 0.42, 2.0
# Residuals near each other are more alike than single ones by no more than such a factor, while
# motion may be what makes them so.
_MOST_ALIKE = 1.3
# A profile measures a step that is off by less than this share of a cell, a pattern by less than
# its blur.
_EDGE_RANGE, _PATTERN_RANGE_PX = 0.21, 1.0
# Blurs about both axes are alike, unless their steps say otherwise with this share of their weight.
_ALIKE = 0.05
# What lens model and sensor leave over stretches a picture by so much, and by so much a pixel of
# blur.
_STRETCH, _BLURRED_STRETCH = 2.5e-5, 1e-4


class Explained(NamedTuple):
    """A pose and how sure it is.

    Attributes
    ----------
    pose : MovingPose
        At the middle row.
    covariance : (6, 6) float64
    shaking : float
        Natural logarithm of the odds that the camera shook while the shutter rolled; 0 where
        nothing says so.
    """

    pose: MovingPose
    covariance: Array
    shaking: float = 0.0


def explain_edges(
    pose: MovingPose,
    edge_points: EdgePoints,
    fitted: tuple[Solution, Sightings],
    camera: Camera,
    bounds: MotionBounds,
) -> Explained:
    """The pose at the middle row, and how sure it is.

    Parameters
    ----------
    pose : MovingPose
        Fitted to the borders.
    edge_points : EdgePoints
    fitted : (Solution, Sightings)
    camera : Camera
    bounds : MotionBounds
    """
    found, seen = fitted
    # At the row where a border was seen, its residual would pass for motion.
    row_time = row_times(camera, pose.project(camera, seen.points_mm)[:, 1])
    seen = seen._replace(row_time=row_time)
    measured = _Measured(found.rows, seen, edge_points)
    motion = np.concatenate([pose.shift_mm, pose.rotvec])
    fit = measured.explain(found.rows[:, 0], None, motion, bounds)
    shaking = fit.log_odds if fit.shaken else 0.0
    if fit.shaken:
        predicted = measured.predict(fit, motion)
        fit = measured.explain(found.rows[:, 0] - predicted, predicted, motion, bounds)
    step = fit.step[:6]
    if fit.shaken or not pose.still:
        step = np.concatenate([step, fit.motion - motion])
    blur = np.zeros(3) if bounds.at_rest else _blur_variance(found.rows, edge_points)
    cell_px = np.linalg.norm(edge_points.borders.across_mm[0]) * camera.focal_px / bounds.height_mm
    covariance = fit.covariance * _beyond(fit, camera.focal_px, _EDGE_RANGE * float(cell_px))
    covariance = _widened(covariance, blur, bounds.height_mm, camera.focal_px)
    return Explained(pose.moved(step), covariance, shaking)


class RowsSeen(NamedTuple):
    """A pattern's normal equations by rows.

    Attributes
    ----------
    sums : RowSums
        Scaled so that their inverse is a covariance; of biases nothing.
    first, width : float
        As of `explain_rows`.
    blur_px2 : float
        By how much the picture is blurrier than the pattern, frame pixels squared.
    """

    sums: RowSums
    first: float
    width: float
    blur_px2: float


def explain_pattern(
    pose: MovingPose, rows: RowsSeen, focal_px: float, bounds: MotionBounds
) -> Explained:
    """As `explain_edges`, of a pose that a pattern was matched with."""
    motion = np.concatenate([pose.shift_mm, pose.rotvec])
    fit = explain_rows(rows.sums, rows.first, rows.width, motion, bounds)
    step = fit.step[:6]
    if fit.shaken or not pose.still:
        step = np.concatenate([step, fit.motion - motion])
    turn = _PATTERN_GAIN * max(0.0, rows.blur_px2 - _PATTERN_WITHIN) / focal_px**2
    covariance = fit.covariance * _beyond(fit, focal_px, _PATTERN_RANGE_PX)
    covariance = _widened(covariance, np.full(3, turn), bounds.height_mm, focal_px)
    return Explained(pose.moved(step), covariance, fit.log_odds if fit.shaken else 0.0)


def _beyond(fit: RowFit, focal_px: float, range_px: float) -> float:
    """By how much variances grow where a shaking exceeds what is measured straight.

    Steps further off than a profile reaches are found elsewhere or not at all, and a pattern's
    slopes end where its steps do.
    """
    if not fit.shaken:
        return 1.0
    sway = fit.sway[:, :2] - fit.sway[:, :2].mean(axis=0)
    return 1.0 + float((sway**2).sum(axis=1).mean()) * (focal_px / range_px) ** 2


class _Measured:
    """Linearized residuals of borders by rows."""

    def __init__(self, rows: Array, seen: Sightings, edge_points: EdgePoints) -> None:
        self._rows, self._seen = rows, seen
        self._tile = tiles_of(edge_points.xy)
        step, upright = np.sign(edge_points.borders.step), edge_points.borders.across_mm[:, 0] != 0
        self._sides = np.stack([step * upright, step * ~upright], axis=1)
        time = seen.row_time
        self._first, self._width, self._count = intervals_over(float(time.min()), float(time.max()))

    def explain(
        self, left: Array, predicted: Array | None, motion: Array, bounds: MotionBounds
    ) -> RowFit:
        """`explain_rows`, where residuals are what is left (N,) over what was predicted (N,)."""
        weight = self._seen.weight
        sigma = scatter(left.copy(), weight)
        trust = trust_of(left.copy(), weight, sigma)
        robust = trust * sigma**2 / np.maximum(weight, 1e-12)
        share = newton_share(robust, weight)
        rows = self._rows.copy()
        rows[:, 0] = left
        most = _MOST_ALIKE if predicted is None else np.inf
        noise = noise_share(*noise_sums(rows, trust, self._tile, TILES**2), len(rows), most)
        rows[:, 0] = left if predicted is None else left + share * predicted
        sums = row_sums(
            rows, self._sides, self._seen.row_time, trust, self._first, self._width, self._count
        )
        scaled = sums._replace(
            normal=sums.normal * (share**2 / noise), pull=sums.pull * (share / noise)
        )
        return explain_rows(scaled, self._first, self._width, motion, bounds)

    def predict(self, fit: RowFit, motion: Array) -> Array:
        """What a fit makes of the residuals (N,)."""
        change, time = self._rows[:, 1:], self._seen.row_time
        knots = self._first + self._width * np.arange(self._count + 1)
        sway = np.stack([np.interp(time, knots, axis) for axis in fit.sway.T], axis=1)
        static = change @ fit.step[:6] + self._sides @ fit.step[6:]
        drift = time * (change @ (fit.motion - motion))
        return np.asarray(static + drift + (change[:, 3:] * sway).sum(axis=1))


def _blur_variance(rows: Array, edge_points: EdgePoints) -> Array:
    """Variances (3,) of the attitude while a row was exposed, radians², by the steps' widths."""
    turns, weight = rows[:, 4:6] ** 2, edge_points.weight
    normal = (turns * weight[:, None]).T @ turns
    tie = _ALIKE * np.trace(normal) * np.array([[1.0, -1.0], [-1.0, 1.0]])
    right = turns.T @ (weight * (edge_points.blur_px2 - _SHARP_WITHIN))
    tilts = np.maximum(np.linalg.solve(normal + tie, right), 0) / _BLUR_GAIN
    return np.array([*tilts, tilts.mean()])


def _widened(covariance: Array, blur: Array, height_mm: float, focal_px: float) -> Array:
    """A covariance (6, 6) with what no residual shows."""
    out = covariance.copy()
    stretch = _STRETCH + _BLURRED_STRETCH * np.sqrt(blur[2]) * focal_px
    out[[0, 1, 2], [0, 1, 2]] += (stretch * height_mm) ** 2
    out[[3, 4, 5], [3, 4, 5]] += blur
    return out
