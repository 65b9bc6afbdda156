"""How well four corners hold a pose: residuals, covariance, and whether it is good enough."""

from __future__ import annotations

import numpy as np

from padstudio.arrays import Array
from padstudio.geometry.camera import Camera
from padstudio.geometry.planar_pnp import least_squares, spread_of
from padstudio.geometry.pose import Pose
from padstudio.vision.stage.detection import Uncertainty
from padstudio.vision.stage.trace import Reason, StageFailure


def corner_residuals(pose: Pose, camera: Camera, points_mm: Array, xy: Array) -> Array:
    """Measured less predicted pixels (N, 2) of pad points (N, 3); NaN behind the camera."""
    return xy - camera.project(pose.to_camera(points_mm))


def corner_covariance(
    pose: Pose, camera: Camera, points_mm: Array, xy: Array, scatter: Array
) -> Array:
    """Covariance of a polished pose from corners whose scatter is known.

    The corners are moved either way along the scatter's principal axes and the pose found again:
    seen from straight above, tilt bends so strongly that a derivative would promise too much.
    Where the corners are farther off the pose than their scatter explains, it is taken to be
    larger: motion during the exposure bends a square though each of its sides is sharp.

    Parameters
    ----------
    pose : Pose
    camera : Camera
    points_mm : (N, 3) float64
    xy : (N, 2) float64
        Where they are seen, pixels.
    scatter : (2 N, 2 N) float64
        Covariance of `xy`, x and y of one corner after the other.

    Returns
    -------
    (6, 6) float64
        Centre (mm, pad frame), then attitude (radians, about the camera's axes).
    """
    values, axes = np.linalg.eigh(scatter)
    moves = (axes * np.sqrt(np.maximum(values, 0.0))).T
    rays = camera.normalize(xy)
    start = least_squares(points_mm, rays, pose)[1]
    covariance, expected = _spread(start, camera, points_mm, xy, moves)
    excess = float((_off(start, points_mm, rays) ** 2).sum()) / max(expected, 1e-30)
    if not excess > 1:
        return covariance
    return _spread(start, camera, points_mm, xy, moves * np.sqrt(excess))[0]


def _spread(
    start: Pose, camera: Camera, points_mm: Array, xy: Array, moves: Array
) -> tuple[Array, float]:
    """A pose's covariance from moves (M, 2 N) of its corners; the squares left unexplained."""
    there = xy + np.concatenate([moves, -moves]).reshape(-1, *xy.shape)
    moved = camera.normalize(there.reshape(-1, 2)).reshape(there.shape)
    return spread_of(points_mm, camera.normalize(xy), moved, start)


def _off(pose: Pose, points_mm: Array, rays: Array) -> Array:
    """How far rays (N, 2) are from where a pose has its points, on the plane z = 1."""
    at = pose.to_camera(points_mm)
    return np.asarray(rays - at[:, :2] / at[:, 2:], float)


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
