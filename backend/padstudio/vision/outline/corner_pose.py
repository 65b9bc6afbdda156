"""How well four corners hold a pose: residuals, covariance, and whether it is good enough."""

from __future__ import annotations

import numpy as np

from padstudio.arrays import Array
from padstudio.geometry.camera import Camera
from padstudio.geometry.planar_pnp import least_squares
from padstudio.geometry.pose import Pose
from padstudio.vision.stage.detection import Uncertainty
from padstudio.vision.stage.trace import Reason, StageFailure


def corner_residuals(pose: Pose, camera: Camera, points_mm: Array, xy: Array) -> Array:
    """Measured less predicted pixels (N, 2) of pad points (N, 3); NaN behind the camera."""
    return xy - camera.project(pose.to_camera(points_mm))


def corner_sigma_px(residuals: Array, known_px: float) -> float:
    """Standard deviation of a corner's coordinate, pixels.

    The larger of what is known of the lines and what the residuals of a pose from N corners show:
    motion during the exposure bends a square though each of its sides is sharp.

    Parameters
    ----------
    residuals : (N, 2) float64
        Pixels.
    known_px : float
    """
    freedom = residuals.size - 6
    return max(known_px, float(np.sqrt((residuals**2).sum() / max(freedom, 1))))


def corner_covariance(
    pose: Pose, camera: Camera, points_mm: Array, xy: Array, sigma_px: float
) -> Array:
    """Covariance of a polished pose from corners that are independently off by `sigma_px`.

    Each coordinate is moved either way by its standard deviation and the pose found again: seen
    from straight above, tilt bends so strongly that a derivative would promise too much.

    Returns
    -------
    (6, 6) float64
        Centre (mm, pad frame), then attitude (radians, about the camera's axes).
    """
    start = least_squares(points_mm, camera.normalize(xy), pose)[1]
    covariance = np.zeros((6, 6))
    for move in sigma_px * np.concatenate([np.eye(xy.size), -np.eye(xy.size)]):
        moved = least_squares(points_mm, camera.normalize(xy + move.reshape(xy.shape)), start)[1]
        off = start.step_to(moved)
        covariance += np.outer(off, off) / 2
    return covariance


def unsure(
    pose: Pose, covariance: Array, side_px: float, share: float, attitude_deg: float
) -> StageFailure | None:
    """Refuse a pose that its corners leave too open.

    Parameters
    ----------
    pose : Pose
    covariance : (6, 6) float64
    side_px : float
        How far the corners are apart, frame pixels.
    share, attitude_deg : float
        Most standard deviation of the position, as a share of the height, and of the attitude.
    """
    sigma = Uncertainty.of(pose, covariance)
    found = float(np.linalg.norm(sigma.position_sigma_mm)) / max(float(pose.position_mm[2]), 1.0)
    turn = float(sigma.attitude_sigma_deg.max())
    if found <= share and turn <= attitude_deg:
        return None
    return StageFailure(
        "pose",
        Reason.CELLS_TOO_SMALL,
        f"four corners {side_px:.0f} px apart leave {100 * found:.1f} % of the height and "
        f"{turn:.1f} degrees open, {100 * share:.0f} % and {attitude_deg:.0f} degrees are allowed",
        "fly lower or shorten the exposure, or take the dense method, which uses all corners",
    )
