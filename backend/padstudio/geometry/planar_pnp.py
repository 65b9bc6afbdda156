"""Stage `pose`, first half: a first pose from points on the pad's plane, both planar answers.

The closed form is infinitesimal plane-based pose estimation (IPPE); Levenberg and Marquardt's
least squares follow.

References
----------
Collins, T. and Bartoli, A. (2014). Infinitesimal plane-based pose estimation.
doi:10.1007/s11263-014-0725-5. Schweighofer, G. and Pinz, A. (2006). Robust pose estimation from a
planar target. doi:10.1109/TPAMI.2006.252 (both answers of a plane).
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from padstudio.arrays import Array
from padstudio.geometry import planar_pnp_kernel
from padstudio.geometry.pose import Pose, rotation_angle_deg, rotation_from_vector

# Poses nearer to each other than this are one: below what corners tell, above what rounding leaves.
_ALIKE_DEG = 0.05
# Levenberg and Marquardt's steps at the most; a fit that converges ends long before by itself.
_MOST_STEPS = 30


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
    """
    starts = _closed_form(points_mm, rays) + _from_homography(points_mm, rays)
    if not starts:
        return None
    found = sorted(
        (least_squares(points_mm, rays, start) for start in starts), key=lambda item: item[0]
    )
    error, pose = found[0]
    if not np.isfinite(error):
        return None
    for other_error, other in found[1:]:
        if rotation_angle_deg(pose.rotation, other.rotation) > _ALIKE_DEG:
            return PlanarPose(pose, min(1.0, error / max(other_error, 1e-12)), other, error)
    return PlanarPose(pose, 0.0, None, error)


def ambiguity(pose: Pose, points_mm: Array, sigma: float) -> float:
    """How well the other planar pose would explain the points too, 0 (not at all) … 1 (alike).

    Seen from afar, a plane and its mirror image about the line of sight look almost alike. The
    points as the pose shows them are explained again; the best other pose is off by some root mean
    square, which is compared with how well the points' pattern as a whole is measured.

    Parameters
    ----------
    pose : Pose
    points_mm : (N, 3) float64
        Points that span what was measured, pad frame.
    sigma : float
        Standard deviation of the pattern, on the plane z = 1.
    """
    squares, rotation = planar_pnp_kernel.fit_mirrored(
        np.ascontiguousarray(points_mm, float),
        np.ascontiguousarray(pose.rotation),
        pose.position_mm,
        _MOST_STEPS,
    )
    if rotation_angle_deg(pose.rotation, rotation) <= _ALIKE_DEG:
        return 0.0
    away = float(np.sqrt(squares / len(points_mm)))
    return sigma / float(np.hypot(sigma, away)) if sigma + away > 0 else 0.0


def mirrored(pose: Pose) -> Pose:
    """The pose from which a small plane looks the same: its normal mirrored at the line of sight.

    Up to perspective, that is; the plane's origin keeps its place in the camera frame.
    """
    sight = pose.tvec_mm / np.linalg.norm(pose.tvec_mm)
    half_turn = 2 * np.outer(sight, sight) - np.eye(3)
    rotation = half_turn @ pose.rotation.T @ np.diag([-1.0, -1.0, 1.0])
    return Pose.from_T_camera_pad(rotation, pose.tvec_mm)


def _closed_form(points_mm: Array, rays: Array) -> list[Pose]:
    try:
        count, vectors, shifts, _ = cv2.solvePnPGeneric(
            points_mm.reshape(-1, 1, 3),
            rays.reshape(-1, 1, 2),
            np.eye(3),
            None,
            flags=cv2.SOLVEPNP_IPPE,
        )
    except cv2.error:
        return []
    poses = []
    for k in range(count):
        rotation = rotation_from_vector(np.asarray(vectors[k], float))
        pose = Pose.from_T_camera_pad(rotation, np.asarray(shifts[k], float))
        if np.isfinite(pose.position_mm).all() and pose.position_mm[2] > 0:
            poses.append(pose)
    return poses


def _from_homography(points_mm: Array, rays: Array) -> list[Pose]:
    """A pose that holds where the plane is seen straight on, too, where the closed form breaks.

    The columns of the homography are the plane's axes and origin in the camera frame, up to scale.
    """
    homography, _ = cv2.findHomography(points_mm[:, :2], rays)
    if homography is None or not np.isfinite(homography).all():
        return []
    columns = homography / np.linalg.norm(homography[:, :2], axis=0).mean()
    columns *= np.sign(columns[2, 2]) or 1.0
    first, second, origin = columns.T
    u, _, vt = np.linalg.svd(np.stack([first, second, np.cross(first, second)], axis=1))
    pose = Pose.from_T_camera_pad(np.asarray(u @ vt, float), np.asarray(origin, float))
    return [pose] if pose.position_mm[2] > 0 else []


def spread_of(points_mm: Array, rays: Array, moved: Array, pose: Pose) -> tuple[Array, float]:
    """A pose's covariance from moves of its points, after each of which it is found anew.

    Parameters
    ----------
    points_mm : (N, 3) float64
    rays : (N, 2) float64
        Where they are seen, on the plane z = 1.
    moved : (2 M, N, 2) float64
        The same after each of M moves, and after its contrary.
    pose : Pose
        Of least squares.

    Returns
    -------
    covariance : (6, 6) float64
        Centre (mm, pad frame), then attitude (radians, about the camera's axes).
    unexplained : float
        Squares of the moves that no pose follows.
    """
    covariance, unexplained = planar_pnp_kernel.spread(
        np.ascontiguousarray(points_mm, float),
        np.ascontiguousarray(rays, float),
        np.ascontiguousarray(moved, float),
        np.ascontiguousarray(pose.rotation),
        np.asarray(pose.position_mm, float),
        _MOST_STEPS,
    )
    return covariance, float(unexplained)


def least_squares(points_mm: Array, rays: Array, pose: Pose) -> tuple[float, Pose]:
    """The pose nearby with the least reprojection error.

    A closed-form planar pose reads tilt off foreshortening, which from straight above is the
    square root of the points' error; least squares uses the perspective as well.

    Returns
    -------
    rms : float
        On the plane z = 1; infinite where there is no such pose, which then is the given one.
    pose : Pose
    """
    squares, rotation, centre = planar_pnp_kernel.fit_points(
        np.ascontiguousarray(points_mm, float),
        np.ascontiguousarray(rays, float),
        np.ascontiguousarray(pose.rotation),
        np.asarray(pose.position_mm, float),
        _MOST_STEPS,
    )
    if not np.isfinite(squares) or centre[2] <= 0:
        return np.inf, pose
    return float(np.sqrt(squares / len(points_mm))), Pose(centre, rotation)
