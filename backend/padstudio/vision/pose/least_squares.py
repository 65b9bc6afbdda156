"""Stage `pose`, second half: all borders, all visible layers, least squares with covariance.

Each border's measured point must lie on the border's predicted line; the distance is measured on
the plane z = 1, undistorted. With p the border's point in the camera frame, x = p/z its picture
and n the normal of the border's picture, the distance is (ray − x)·n; from p = Rᵀ(P − C) follow
dp/dC = −Rᵀ and, for a rotation vector w of the camera, dp = −w × p. A rolling shutter reads rows
one after another, so a second model lets the pose change steadily from top to bottom; it is taken
only where the residuals ask for it.

Solved by Gauss–Newton with iteratively reweighted least squares (IRLS) and the weights
1/(1 + x²)² of Geman and McClure.

References
----------
Holland, P. W. and Welsch, R. E. (1977). Robust regression using iteratively reweighted
least-squares. doi:10.1080/03610927708827533. Geman, S. and McClure, D. E. (1987). Statistical
methods for tomographic image reconstruction. Bulletin of the ISI 52.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.geometry.camera import Camera
from padstudio.geometry.rolling_shutter import KnownMotion, MovingPose
from padstudio.vision.pose import least_squares_kernel
from padstudio.vision.pose.edge_points import LEAST_BORDERS, EdgePoints
from padstudio.vision.pose.pose_posterior import Explained, explain_edges
from padstudio.vision.pose.row_motion import MotionBounds

# Expected change while a frame is read: of position, sideways and in height, as a share of height,
# of attitude in radians. A landing drone's 0.5 m/s at 2 m and 10°/s in 20 ms are of this size.
# Change of height looks like tilt to a rolling shutter, so its bound is what keeps them apart.
_SHIFT_SIGMA, _CLIMB_SIGMA, _TURN_SIGMA = 0.005, 0.0005, 0.004
# A known motion is held to this many times more tightly, in variances.
_KNOWN_MOTION = 4.0
# The moving model must lower the sum of squares by this many variances. Six parameters more lower
# it by chance by χ² of six degrees of freedom: six on average, 40 once in two million.
_MOTION_GAIN = 40.0
_CHANCE_GAIN = 6.0
# What lens, sensor and ink leave over near the ground is no motion, however well it is measured.
_LEAST_RMS_PX = 0.06
# A tone curve draws steps toward the dark by about so many pixels of the picture.
_BIAS = 0.3
# Fewer inliers do not bear out six unknowns.
_LEAST_INLIERS = 10


@dataclass(frozen=True, eq=False)
class Fit:
    """A pose fitted to measured borders.

    Attributes
    ----------
    pose : MovingPose
    rms_px : float
        Root mean square of the weighted residuals, frame pixels.
    inliers : (N,) bool
        Which of the measured borders, or of the matched pixels, count.
    explain : callable
        Makes the pose and the covariance of `settled`; few fits are ever asked for it.
    doubt : (6,) float64
        By how much the model that was not chosen disagrees, in the covariance's units, as far as
        it may be right.
    """

    pose: MovingPose
    rms_px: float
    inliers: NDArray[np.bool_]
    explain: Callable[[], Explained]
    doubt: Array = field(default_factory=lambda: np.zeros(6))

    @cached_property
    def covariance(self) -> Array:
        """(6, 6) float64: centre (mm, pad frame), then attitude (radians, camera axes)."""
        return self._explained.covariance + np.outer(self.doubt, self.doubt)

    @cached_property
    def _explained(self) -> Explained:
        return self.explain()

    @property
    def shaking(self) -> float:
        """Natural logarithm of the odds that the camera shook while the shutter rolled."""
        return self._explained.shaking

    def settled(self) -> Fit:
        """With the pose that `covariance` is of: the mean over all motions that may be."""
        explained = self._explained
        return replace(self, pose=explained.pose, explain=lambda: explained)


@dataclass(frozen=True)
class MotionModel:
    """What a fit lets the camera do while a frame is read.

    Attributes
    ----------
    moving : bool
        Let the pose change.
    known : KnownMotion or None
        What the change should be near to.
    rolling : bool
        The shutter may roll, so that a change of height that a still pose leaves out enters the
        covariance.
    readout_ms : float or None
        How long it rolls, where that is known.
    at_rest : bool
        Nothing moves, neither while the shutter rolls nor while it is open.
    """

    moving: bool
    known: KnownMotion | None = None
    rolling: bool = True
    readout_ms: float | None = None
    at_rest: bool = False


STILL, MOVING = MotionModel(moving=False), MotionModel(moving=True)


def fit_pose(
    start: MovingPose,
    edge_points: EdgePoints,
    camera: Camera,
    model: MotionModel,
    iterations: int = 4,
) -> Fit | None:
    """Fit a pose to measured borders by robust Gauss–Newton.

    Parameters
    ----------
    start : MovingPose
    edge_points : EdgePoints
    camera : Camera
    model : MotionModel
    iterations : int

    Returns
    -------
    Fit or None
        None where fewer than twelve borders were measured, or they leave the pose undetermined.
    """
    if len(edge_points.xy) < LEAST_BORDERS:
        return None
    prior = MotionPrior.of(start, model)
    begin = start if model.moving else MovingPose(start.pose)
    seen = edge_points.seen_by(camera)
    found = least_squares_kernel.fit(
        seen, begin.state, prior.weight, prior.expected, camera.focal_px, iterations
    )
    if not found.solved or np.count_nonzero(found.inliers) < _LEAST_INLIERS:
        return None
    settled = MovingPose.of(found.pose)

    def explain() -> Explained:
        bounds = bounds_of(settled, model, edge_points.pixel)
        return explain_edges(settled, edge_points, (found.rows, seen), camera, bounds)

    return Fit(settled, found.rms, found.inliers, explain)


def bounds_of(pose: MovingPose, model: MotionModel, pixel: float) -> MotionBounds:
    """What is known beforehand of the motion in a frame.

    Parameters
    ----------
    pose : MovingPose
    model : MotionModel
    pixel : float
        Side of a pixel of the picture that was measured, frame pixels.
    """
    height, bias = max(abs(float(pose.pose.position_mm[2])), 1.0), _BIAS * pixel
    bounds = MotionBounds.unknown(height, bias, model.readout_ms, rolling=model.rolling)
    if model.known is None:
        return replace(bounds, at_rest=model.at_rest)
    expected = np.concatenate([model.known.shift_mm, model.known.rotvec])
    return replace(bounds, expected=expected, climb_mm=model.known.climb_sigma_mm)


def better_of(still: Fit, moving: Fit | None) -> Fit:
    """The moving model where the residuals ask for it, else the still one."""
    if moving is None:
        return still
    count = int(still.inliers.sum())
    gain = count * (still.rms_px**2 - moving.rms_px**2) / max(moving.rms_px, _LEAST_RMS_PX) ** 2
    if gain > _MOTION_GAIN:
        return moving
    # Six free parameters gain six variances by chance; what gains more may well be right.
    doubt = still.pose.step_to(moving.pose) * np.sqrt(np.clip(gain / _CHANCE_GAIN, 0.0, 1.0))
    return replace(still, doubt=doubt)


@dataclass(frozen=True, eq=False)
class MotionPrior:
    """What is known beforehand of the change within a frame; nothing is of the pose itself.

    Attributes
    ----------
    weight : (6,) or (12,) float64
        Inverse variances of the parameters.
    expected : (6,) or (12,) float64
    """

    weight: Array
    expected: Array

    @classmethod
    def of(cls, start: MovingPose, model: MotionModel) -> MotionPrior:
        """The prior at a height, round no motion or a known one."""
        known, size = model.known, 12 if model.moving else 6
        height = max(abs(float(start.pose.position_mm[2])), 1.0)
        weight, expected = np.zeros(12), np.zeros(12)
        weight[6:8] = 1 / (_SHIFT_SIGMA * height) ** 2
        weight[8] = 1 / (_CLIMB_SIGMA * height) ** 2
        weight[9:12] = 1 / _TURN_SIGMA**2
        if known is not None:
            weight *= _KNOWN_MOTION
            expected[6:9], expected[9:] = known.shift_mm, known.rotvec
        return cls(weight[:size], expected[:size])

    def pull(self, pose: MovingPose) -> Array:
        """The prior's part of the right side of the normal equations."""
        now = np.concatenate([np.zeros(6), pose.shift_mm, pose.rotvec])[: len(self.weight)]
        return np.asarray(self.weight * (self.expected - now))
