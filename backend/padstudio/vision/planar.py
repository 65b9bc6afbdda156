"""Stage `pose`, first half: a first pose from points on the pad's plane, both planar answers."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from padstudio.geometry.pose import Pose
from padstudio.vision.types import Array


@dataclass(frozen=True, eq=False)
class PlanarPose:
    """The better of the two poses that explain points of a plane.

    Attributes
    ----------
    pose : Pose
    ambiguity : float
        Reprojection error of this pose over that of the other, 0 (clear) … 1 (both fit alike).
    other : Pose or None
        The other pose.
    error : float
        Root mean square on the plane z = 1.
    """

    pose: Pose
    ambiguity: float
    other: Pose | None
    error: float


def planar_pose(points_mm: Array, rays: Array) -> PlanarPose | None:
    """Pose of a calibrated camera from at least four points of the pad's plane.

    Parameters
    ----------
    points_mm : (N, 3) float64
        Pad frame, Z = 0.
    rays : (N, 2) float64
        Their pictures on the plane z = 1, undistorted.

    Returns
    -------
    PlanarPose or None
        None where the points leave the pose undetermined.

    References
    ----------
    Collins, T. and Bartoli, A. (2014). Infinitesimal plane-based pose estimation.
    doi:10.1007/s11263-014-0725-5
    """
    try:
        count, turns, shifts, errors = cv2.solvePnPGeneric(
            points_mm.reshape(-1, 1, 3),
            rays.reshape(-1, 1, 2),
            np.eye(3),
            None,
            flags=cv2.SOLVEPNP_IPPE,
        )
    except cv2.error:
        return None
    poses = []
    for k in range(count):
        rotation = np.asarray(cv2.Rodrigues(turns[k])[0], float)
        pose = Pose.from_T_camera_pad(rotation, np.asarray(shifts[k], float))
        if np.isfinite(pose.position_mm).all() and pose.position_mm[2] > 0:
            poses.append((float(np.ravel(errors[k])[0]), pose))
    if not poses:
        return None
    poses = [_polished(points_mm, rays, pose) for _, pose in poses]
    poses.sort(key=lambda item: item[0])
    error, pose = poses[0]
    if len(poses) == 1:
        return PlanarPose(pose, 0.0, None, error)
    return PlanarPose(pose, min(1.0, error / max(poses[1][0], 1e-12)), poses[1][1], error)


def _polished(points_mm: Array, rays: Array, pose: Pose) -> tuple[float, Pose]:
    """Least squares from a closed-form pose: root mean square on the plane z = 1, and the pose."""
    rvec, tvec = cv2.solvePnPRefineLM(
        points_mm, rays, np.eye(3), None, pose.rvec.copy(), pose.tvec_mm.copy()
    )
    rotation = np.asarray(cv2.Rodrigues(rvec)[0], float)
    refined = Pose.from_T_camera_pad(rotation, np.asarray(tvec, float))
    seen = (points_mm - refined.position_mm) @ refined.rotation
    if not np.isfinite(seen).all() or refined.position_mm[2] <= 0 or (seen[:, 2] <= 0).any():
        refined = pose
        seen = (points_mm - pose.position_mm) @ pose.rotation
    off = seen[:, :2] / seen[:, 2:] - rays
    return float(np.sqrt((off**2).sum(axis=1).mean())), refined
