"""From a board's points to the camera's pose: the same way for all boards but the pad."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose

_LEAST_POINTS = 4
# How far off a point may be to count for the pose, pixels.
_INLIER_PX = 3.0


def pose_of(
    points_mm: NDArray[np.float64], pixels: NDArray[np.float64], camera: Camera
) -> Pose | None:
    """The pose from points of the board's plane and where they are seen.

    A homography by RANSAC drops misread points; the better answer of IPPE (Collins and Bartoli,
    "Infinitesimal Plane-Based Pose Estimation", 2014) is refined on the others by
    Levenberg–Marquardt.

    Parameters
    ----------
    points_mm : (N, 2) float64
        Pad frame, of its plane.
    pixels : (N, 2) float64
    camera : Camera

    Returns
    -------
    Pose or None
        None where fewer than four points agree.
    """
    if len(points_mm) < _LEAST_POINTS:
        return None
    rays = camera.normalize(pixels)
    seen = np.isfinite(rays).all(axis=1)
    points_mm, rays = points_mm[seen], rays[seen]
    if len(rays) < _LEAST_POINTS:
        return None
    _, kept = cv2.findHomography(points_mm, rays, cv2.RANSAC, _INLIER_PX / camera.focal_px)
    if kept is None or kept.sum() < _LEAST_POINTS:
        return None
    keep = kept.ravel() > 0
    points = np.column_stack([points_mm[keep], np.zeros(keep.sum())])
    eye, none = np.eye(3), np.zeros(4)
    found, turns, shifts, _ = cv2.solvePnPGeneric(
        points, rays[keep], eye, none, flags=cv2.SOLVEPNP_IPPE
    )
    if not found:
        return None
    turn, shift = cv2.solvePnPRefineLM(points, rays[keep], eye, none, turns[0], shifts[0])
    rotation = np.asarray(cv2.Rodrigues(turn)[0], float)
    return Pose.from_T_camera_pad(rotation, np.asarray(shift, float))


def pose_of_squares(
    found: Sequence[tuple[NDArray[np.float64], NDArray[np.float64]]],
    camera: Camera,
    *,
    largest: bool = False,
) -> Pose | None:
    """The pose from the corners of markers, as `pose_of`.

    Parameters
    ----------
    found : sequence of ((4, 2) float64, (4, 2) float64)
        Where each marker's corners are on the page, mm, and in the picture, pixels.
    camera : Camera
    largest : bool
        From the largest marker alone: the corners of one that is a fraction of its size say
        nothing beside its own, but would count as much.
    """
    if not found:
        return None
    chosen = [max(found, key=lambda one: float(np.ptp(one[0])))] if largest else found
    points, pixels = (np.concatenate(parts) for parts in zip(*chosen, strict=True))
    return pose_of(points, pixels, camera)
