"""How sure a pose is that borders were measured for, and the pose itself, motion considered.

Residuals tell their own noise: weights that fall as residuals grow are put right by the sandwich of
squared scores, residuals that are alike near each other by their sums over tiles. Motion while the
shutter rolled is told by the rows (`row_motion`), motion while they were exposed by how much wider
steps are than those of a sharp picture: by the middle of its exposure a vibrating camera may be
anywhere within its blur.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from padstudio.arrays import Array
from padstudio.geometry.camera import Camera
from padstudio.geometry.rolling_shutter import MovingPose, row_times
from padstudio.vision.pose.covariance import TILES, newton_share, noise_share, tiles_of
from padstudio.vision.pose.edge_points import LEAST_BORDERS, EdgePoints, Sway
from padstudio.vision.pose.least_squares_kernel import (
    Sightings,
    Solution,
    linearize,
    scatter,
    trust_of,
)
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
# An exposure too short to blur a pattern visibly shows a shaking smaller by such a share.
_UNSEEN_SHARE = 0.2
# A profile measures a step that is off by less than this share of a cell, a pattern by less than
# its blur.
_EDGE_RANGE, _PATTERN_RANGE_PX = 0.21, 1.0
# Profiles are centred again as long as that moves them by more than this share of their range.
_CENTRED, _MOST_AGAIN = 0.15, 4
# A pattern is matched again, so often at the most, until its rows move by less than so many pixels
# and the pose by less than this, in squared standard deviations.
_MOST_MATCHED, _MATCHED_PX, _MATCHED = 12, 0.05, 0.2
# Borders are seen within such a share of the frame of the row where they are expected.
_SAME_ROW = 0.05
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
    measured = _Measured(found.rows, _at_predicted_rows(seen, pose, camera), edge_points)
    fit = measured.explain(found.rows[:, 0], None, _motion(pose), bounds)
    shaking = fit.log_odds if fit.shaken else 0.0
    range_px = _EDGE_RANGE * float(np.linalg.norm(edge_points.borders.across_mm[0]))
    range_px *= camera.focal_px / bounds.height_mm
    if fit.shaken:
        pose, measured, fit = _measured_again(pose, measured, fit, camera, (bounds, range_px))
    step = fit.step[:6]
    if fit.shaken or not pose.still:
        step = np.concatenate([step, fit.motion - _motion(pose)])
    blur = np.zeros(3) if bounds.at_rest else measured.blur_variance()
    covariance = fit.covariance * _beyond(fit, camera.focal_px, range_px)
    covariance = _widened(covariance, blur, bounds.height_mm, camera.focal_px)
    return Explained(pose.moved(step), covariance, shaking)


def _motion(pose: MovingPose) -> Array:
    return np.concatenate([pose.shift_mm, pose.rotvec])


def _step(pose: MovingPose, fit: RowFit) -> Array:
    """From a pose to what a fit about it says, motion and all."""
    return np.concatenate([fit.step[:6], fit.motion - _motion(pose)])


def _distance(step: Array, covariance: Array) -> float:
    """Squared length of a step in standard deviations."""
    return float(step @ np.linalg.solve(covariance, step))


def _measured_again(
    pose: MovingPose,
    measured: _Measured,
    fit: RowFit,
    camera: Camera,
    limits: tuple[MotionBounds, float],
) -> tuple[MovingPose, _Measured, RowFit]:
    """A shaken frame's borders, measured where the shaking puts them until that changes little.

    Profiles that are off their steps show less of a shaking than there is, or none.
    """
    bounds, range_px = limits
    looked_with = np.zeros_like(fit.sway)
    for _ in range(_MOST_AGAIN):
        change_px = camera.focal_px * _spread(fit.sway - looked_with)
        finder = measured.edge_points.finder
        if finder is None or change_px < _CENTRED * range_px or not fit.shaken:
            break
        moved = pose.moved(np.concatenate([fit.step[:6], fit.motion - _motion(pose)]))
        sway = measured.sway(fit)
        edge_points = finder.find(moved, sway)
        if len(edge_points.xy) < LEAST_BORDERS:
            break
        pose, measured = moved, _Measured.of(edge_points, moved, camera)
        looked_with = sway.at(measured.knots)
        here = replace(fit, step=np.r_[np.zeros(6), fit.step[6:]], sway=looked_with)
        fit = measured.explain_left(here, _motion(pose), bounds)
    return pose, measured, measured.explain_left(fit, _motion(pose), bounds)


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
    pose: MovingPose,
    rows_seen: Callable[[MovingPose, Sway | None], RowsSeen],
    focal_px: float,
    bounds: MotionBounds,
) -> Explained:
    """As `explain_edges`, of a pose that a pattern was matched with.

    Parameters
    ----------
    pose : MovingPose
    rows_seen : callable
        The pattern's equations where a pose and a shaking put its rows.
    focal_px : float
    bounds : MotionBounds
    """
    rows = rows_seen(pose, None)
    fit = explain_rows(rows.sums, rows.first, rows.width, _motion(pose), bounds)
    looked_with = np.zeros_like(fit.sway)
    for _ in range(_MOST_MATCHED if fit.sway.any() else 0):
        step = _step(pose, fit)
        sway_px = focal_px * _spread(fit.sway - looked_with)
        if sway_px < _MATCHED_PX and _distance(step[:6], fit.covariance) < _MATCHED:
            break
        pose, looked_with = pose.moved(step), fit.sway
        ends = rows.first + rows.width * np.arange(len(fit.sway), dtype=float)
        rows = rows_seen(pose, Sway(ends, fit.sway))
        fit = explain_rows(rows.sums, rows.first, rows.width, _motion(pose), bounds)
    step = fit.step[:6]
    if fit.shaken or not pose.still:
        step = _step(pose, fit)
    turn = _PATTERN_GAIN * max(0.0, rows.blur_px2 - _PATTERN_WITHIN) / focal_px**2
    if fit.shaken:
        turn += (_UNSEEN_SHARE * _spread(fit.sway)) ** 2
    covariance = fit.covariance * _beyond(fit, focal_px, _PATTERN_RANGE_PX)
    covariance = _widened(covariance, np.full(3, turn), bounds.height_mm, focal_px)
    return Explained(pose.moved(step), covariance, fit.log_odds if fit.shaken else 0.0)


def _spread(sway: Array) -> float:
    """Root mean square of rotation vectors (I + 1, 3) about the first two axes."""
    return float(np.sqrt((sway[:, :2] ** 2).sum(axis=1).mean()))


def _beyond(fit: RowFit, focal_px: float, range_px: float) -> float:
    """By how much variances grow where a shaking exceeds what is measured straight.

    Steps further off than a profile reaches are found elsewhere or not at all, and a pattern's
    slopes end where its steps do.
    """
    if not fit.shaken:
        return 1.0
    sway = _spread(fit.sway - fit.sway.mean(axis=0))
    return 1.0 + (sway * focal_px / range_px) ** 2


def _at_predicted_rows(seen: Sightings, pose: MovingPose, camera: Camera) -> Sightings:
    """Borders at the rows where a pose puts them: at those where they were seen, their residuals
    would pass for motion."""
    predicted = row_times(camera, pose.project(camera, seen.points_mm)[:, 1])
    # A wide lens's polynomial has no row for some rays, or one far away.
    near = np.abs(predicted - seen.row_time) < _SAME_ROW
    return seen._replace(row_time=np.where(near, predicted, seen.row_time))


class _Measured:
    """Linearized residuals of borders by rows."""

    def __init__(self, rows: Array, seen: Sightings, edge_points: EdgePoints) -> None:
        self._rows, self._seen, self.edge_points = rows, seen, edge_points
        self._tile = tiles_of(edge_points.xy)
        step, upright = np.sign(edge_points.borders.step), edge_points.borders.across_mm[:, 0] != 0
        self._sides = np.stack([step * upright, step * ~upright], axis=1)
        time = seen.row_time
        self._first, self._width, self._count = intervals_over(float(time.min()), float(time.max()))

    @classmethod
    def of(cls, edge_points: EdgePoints, pose: MovingPose, camera: Camera) -> _Measured:
        """Borders about a pose."""
        seen = _at_predicted_rows(edge_points.seen_by(camera), pose, camera)
        return cls(linearize(seen, pose.state) * camera.focal_px, seen, edge_points)

    @property
    def knots(self) -> Array:
        """Row times of the intervals' ends, (I + 1,)."""
        return np.asarray(self._first + self._width * np.arange(self._count + 1))

    def sway(self, fit: RowFit) -> Sway:
        """A fit's shaking."""
        return Sway(self.knots, fit.sway)

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

    def explain_left(self, fit: RowFit, motion: Array, bounds: MotionBounds) -> RowFit:
        """`explain` of what a fit with the same intervals leaves."""
        change, time = self._rows[:, 1:], self._seen.row_time
        static = change @ fit.step[:6] + self._sides @ fit.step[6:]
        drift = time * (change @ (fit.motion - motion))
        sway = (change[:, 3:] * self.sway(fit).at(time)).sum(axis=1)
        predicted = np.asarray(static + drift + sway)
        return self.explain(self._rows[:, 0] - predicted, predicted, motion, bounds)

    def blur_variance(self) -> Array:
        """Variances (3,) of the attitude while a row was exposed, radians², by steps' widths."""
        turns, weight = self._rows[:, 4:6] ** 2, self.edge_points.weight
        normal = (turns * weight[:, None]).T @ turns
        tie = _ALIKE * np.trace(normal) * np.array([[1.0, -1.0], [-1.0, 1.0]])
        right = turns.T @ (weight * (self.edge_points.blur_px2 - _SHARP_WITHIN))
        tilts = np.maximum(np.linalg.solve(normal + tie, right), 0) / _BLUR_GAIN
        return np.array([*tilts, tilts.mean()])


def _widened(covariance: Array, blur: Array, height_mm: float, focal_px: float) -> Array:
    """A covariance (6, 6) with what no residual shows."""
    out = covariance.copy()
    stretch = _STRETCH + _BLURRED_STRETCH * np.sqrt(blur[2]) * focal_px
    out[[0, 1, 2], [0, 1, 2]] += (stretch * height_mm) ** 2
    out[[3, 4, 5], [3, 4, 5]] += blur
    return out
