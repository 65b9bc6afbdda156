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
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.vision.pose.drift_kernel import Rows
from padstudio.vision.pose.edge_points import LEAST_BORDERS, EdgePoints, Sway
from padstudio.vision.pose.least_squares_kernel import Sightings, linearize
from padstudio.vision.pose.measured_kernel import (
    Measured,
    blur_variance,
    explained_by,
    measured,
    predicted_rows,
    weighed,
)
from padstudio.vision.pose.row_motion import MotionBounds, RowFit, explain_rows

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
    fitted: tuple[Array, Sightings],
    camera: Camera,
    bounds: MotionBounds,
) -> Explained:
    """The pose at the middle row, and how sure it is.

    Parameters
    ----------
    pose : MovingPose
        Fitted to the borders.
    edge_points : EdgePoints
    fitted : ((N, 7) float64, Sightings)
        Residuals and their change with the pose, as of
        `padstudio.vision.pose.least_squares_kernel.Solution`.
    camera : Camera
    bounds : MotionBounds
    """
    rows, seen = fitted
    projector = pose.projector(camera)
    found = _Measured(
        measured(rows, seen, edge_points.borders, edge_points.xy, projector), edge_points
    )
    fit = found.explain(_motion(pose), bounds)
    shaking = fit.log_odds if fit.shaken else 0.0
    range_px = _EDGE_RANGE * float(np.linalg.norm(edge_points.borders.across_mm[0]))
    range_px *= camera.focal_px / bounds.height_mm
    if fit.shaken:
        pose, found, fit = _measured_again(pose, found, fit, camera, (bounds, range_px))
    step = fit.step[:6]
    if fit.shaken or not pose.still:
        step = np.concatenate([step, fit.motion - _motion(pose)])
    blur = np.zeros(3) if bounds.at_rest else found.blur_variance()
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
    found: _Measured,
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
        finder = found.edge_points.finder
        if finder is None or change_px < _CENTRED * range_px or not fit.shaken:
            break
        moved = pose.moved(np.concatenate([fit.step[:6], fit.motion - _motion(pose)]))
        sway = found.sway(fit)
        edge_points = finder.find(moved, sway)
        if len(edge_points.xy) < LEAST_BORDERS:
            break
        pose, found = moved, _Measured.of(edge_points, moved, camera)
        looked_with = sway.at(found.knots)
        here = replace(fit, step=np.r_[np.zeros(6), fit.step[6:]], sway=looked_with)
        fit = found.explain_left(here, _motion(pose), bounds)
    return pose, found, found.explain_left(fit, _motion(pose), bounds)


class RowsSeen(NamedTuple):
    """What a pattern's rows show.

    Attributes
    ----------
    rows : Rows
        Of biases nothing.
    blur_px2 : float
        By how much the picture is blurrier than the pattern, frame pixels squared.
    """

    rows: Rows
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
    rows, blur_px2 = rows_seen(pose, None)
    fit = explain_rows(rows, _motion(pose), bounds)
    looked_with = np.zeros_like(fit.sway)
    for _ in range(_MOST_MATCHED if fit.sway.any() else 0):
        step = _step(pose, fit)
        sway_px = focal_px * _spread(fit.sway - looked_with)
        if sway_px < _MATCHED_PX and _distance(step[:6], fit.covariance) < _MATCHED:
            break
        pose, looked_with = pose.moved(step), fit.sway
        ends = rows.first + rows.width * np.arange(len(fit.sway), dtype=float)
        rows, blur_px2 = rows_seen(pose, Sway(ends, fit.sway))
        fit = explain_rows(rows, _motion(pose), bounds)
    step = fit.step[:6]
    if fit.shaken or not pose.still:
        step = _step(pose, fit)
    turn = _PATTERN_GAIN * max(0.0, blur_px2 - _PATTERN_WITHIN) / focal_px**2
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


class _Measured:
    """Linearized residuals of borders by rows."""

    def __init__(self, measured: Measured, edge_points: EdgePoints) -> None:
        self._measured, self.edge_points = measured, edge_points

    @classmethod
    def of(cls, edge_points: EdgePoints, pose: MovingPose, camera: Camera) -> _Measured:
        """Borders about a pose."""
        seen, projector = edge_points.seen_by(camera), pose.projector(camera)
        there = seen._replace(row_time=predicted_rows(seen, projector))
        rows = linearize(there, pose.state) * camera.focal_px
        found = measured(rows, seen, edge_points.borders, edge_points.xy, projector)
        return cls(found, edge_points)

    @property
    def knots(self) -> Array:
        """Row times of the intervals' ends, (I + 1,)."""
        here = self._measured
        return np.asarray(here.first + here.width * np.arange(here.intervals + 1))

    def sway(self, fit: RowFit) -> Sway:
        """A fit's shaking."""
        return Sway(self.knots, fit.sway)

    def explain(self, motion: Array, bounds: MotionBounds) -> RowFit:
        """`explain_rows` of all that was measured."""
        left = self._measured.rows[:, 0].copy()
        rows = weighed(self._measured, left, np.zeros(len(left)), _MOST_ALIKE)
        return explain_rows(rows, motion, bounds)

    def explain_left(self, fit: RowFit, motion: Array, bounds: MotionBounds) -> RowFit:
        """`explain_rows` of what a fit with the same intervals leaves."""
        predicted = explained_by(self._measured, fit.step, fit.motion - motion, fit.sway)
        left = self._measured.rows[:, 0] - predicted
        return explain_rows(weighed(self._measured, left, predicted, np.inf), motion, bounds)

    def blur_variance(self) -> Array:
        """Variances (3,) of the attitude while a row was exposed, radians², by steps' widths."""
        here = self.edge_points
        return blur_variance(self._measured.rows, here.weight, here.blur_px2)


def _widened(covariance: Array, blur: Array, height_mm: float, focal_px: float) -> Array:
    """A covariance (6, 6) with what no residual shows."""
    out = covariance.copy()
    stretch = _STRETCH + _BLURRED_STRETCH * np.sqrt(blur[2]) * focal_px
    out[[0, 1, 2], [0, 1, 2]] += (stretch * height_mm) ** 2
    out[[3, 4, 5], [3, 4, 5]] += blur
    return out
