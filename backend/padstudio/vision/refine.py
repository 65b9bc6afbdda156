"""Stage `pose`, second half: all borders, all visible layers, least squares with covariance.

Each border's measured point must lie on the border's predicted line; the distance is measured on
the plane z = 1, undistorted. A rolling shutter reads rows one after another, so a second model
lets the pose change steadily from top to bottom; it is taken only where the residuals ask for it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from padstudio.geometry.camera import Camera
from padstudio.vision.borders import Measured
from padstudio.vision.motion import MovingPose, cross
from padstudio.vision.types import Array

# Expected change while a frame is read: of position, sideways and in height, as a share of height,
# of attitude in radians. A landing drone's 0.5 m/s at 2 m and 10°/s in 20 ms are of this size.
# Change of height looks like tilt to a rolling shutter, so its bound is what keeps them apart.
_SHIFT_SIGMA, _CLIMB_SIGMA, _TURN_SIGMA = 0.005, 0.0005, 0.004
# The moving model must lower the sum of squares by this many variances, six being free.
_MOTION_GAIN = 40.0


@dataclass(frozen=True, eq=False)
class Fit:
    """A pose fitted to measured borders.

    Attributes
    ----------
    pose : MovingPose
    rms_px : float
        Root mean square of the weighted residuals, frame pixels.
    covariance : (6, 6) float64
        Centre (mm, pad frame) then attitude (radians, camera axes).
    inliers : (N,) bool
        Which of the measured borders count.
    """

    pose: MovingPose
    rms_px: float
    covariance: Array
    inliers: NDArray[np.bool_]


def fit_pose(
    start: MovingPose, measured: Measured, camera: Camera, *, motion: bool, iterations: int = 4
) -> Fit | None:
    """Fit a pose to measured borders by robust Gauss–Newton.

    Parameters
    ----------
    start : MovingPose
    measured : Measured
    camera : Camera
    motion : bool
        Let the pose change within the frame.
    iterations : int

    Returns
    -------
    Fit or None
        None where fewer than twelve borders were measured, or they leave the pose undetermined.
    """
    if len(measured.xy) < 12:
        return None
    rays = np.column_stack([camera.normalize(measured.xy), np.ones(len(measured.xy))])
    moment = start.moment(camera, measured.xy[:, 1])
    size = 12 if motion else 6
    prior = motion_prior(start, size)
    pose, sigma = (start if motion else MovingPose(start.pose)), 1.0
    for _ in range(iterations):
        residual, jacobian = _linearize(pose, measured, rays, moment, size)
        residual, jacobian = residual * camera.focal_px, jacobian * camera.focal_px
        sigma = _scale(residual, measured.weight)
        robust = measured.weight / (1 + (residual / (2.5 * sigma)) ** 2) ** 2
        held = np.concatenate([np.zeros(6), pose.shift_mm, pose.turn])[:size]
        normal = (jacobian * robust[:, None]).T @ jacobian / sigma**2 + np.diag(prior)
        right = (jacobian * robust[:, None]).T @ residual / sigma**2 - prior * held
        try:
            step = np.linalg.solve(normal, right)
        except np.linalg.LinAlgError:
            return None
        if not np.isfinite(step).all():
            return None
        pose = pose.moved(step)
    residual, _ = _linearize(pose, measured, rays, moment, size)
    residual = residual * camera.focal_px
    inliers = np.abs(residual) < 4 * sigma
    if inliers.sum() < 10:
        return None
    trust = measured.weight[inliers]
    rms = float(np.sqrt((trust * residual[inliers] ** 2).sum() / trust.sum()))
    covariance = np.asarray(np.linalg.inv(normal)[:6, :6], float)
    return Fit(pose, rms, covariance, inliers)


def better_of(still: Fit, moving: Fit | None) -> Fit:
    """The moving model where the residuals ask for it, else the still one."""
    if moving is None:
        return still
    count = int(still.inliers.sum())
    gain = count * (still.rms_px**2 / max(moving.rms_px, 1e-6) ** 2 - 1)
    return moving if gain > _MOTION_GAIN else still


def motion_prior(start: MovingPose, size: int) -> Array:
    """Inverse variances of the parameters; none for the pose itself."""
    height = max(abs(float(start.pose.position_mm[2])), 1.0)
    prior = np.zeros(12)
    prior[6:8] = 1 / (_SHIFT_SIGMA * height) ** 2
    prior[8] = 1 / (_CLIMB_SIGMA * height) ** 2
    prior[9:12] = 1 / _TURN_SIGMA**2
    return prior[:size]


def _linearize(
    pose: MovingPose, measured: Measured, rays: Array, moment: Array, size: int
) -> tuple[Array, Array]:
    """Distances of measured points from predicted borders, and their change with the pose."""
    b = measured.borders
    p = pose.to_camera(b.points_mm, moment)
    q = pose.to_camera(b.points_mm + 0.2 * b.along_mm, moment)
    x = p[:, :2] / p[:, 2:]
    along = q[:, :2] / q[:, 2:] - x
    normal = np.stack([-along[:, 1], along[:, 0]], axis=1)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-15)
    residual = ((rays[:, :2] - x) * normal).sum(axis=1)
    # d(x)/d(p), dotted with the normal.
    gradient = np.column_stack([normal, -(normal * x).sum(axis=1)]) / p[:, 2:]
    # p = Rᵀ(P − C) gives dp/dC = −Rᵀ; a turn w of the camera gives dp = −w × p.
    by_centre = -gradient @ pose.pose.rotation.T
    by_turn = -cross(p, gradient)
    jacobian = np.column_stack([by_centre, by_turn])
    if size == 12:
        jacobian = np.column_stack([jacobian, moment[:, None] * jacobian])
    return residual, jacobian


def _scale(residual: Array, weight: Array) -> float:
    """Robust standard deviation: the weighted median of |residual| over 0.6745."""
    order = np.argsort(np.abs(residual))
    total = np.cumsum(weight[order])
    middle = int(np.searchsorted(total, total[-1] / 2))
    return max(float(np.abs(residual)[order[middle]]) / 0.6745, 1e-3)
