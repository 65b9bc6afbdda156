"""What goes into the filter for a frame, and what comes out."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from padstudio.arrays import Array
from padstudio.geometry.curvature import without_curvature
from padstudio.geometry.pose import Pose


@dataclass(frozen=True, eq=False)
class Measurement:
    """The pose of a single frame.

    Attributes
    ----------
    time_s : float
    pose : Pose
    covariance : (6, 6) float64
        As of `padstudio.vision.stage.detection.Uncertainty`.
    """

    time_s: float
    pose: Pose
    covariance: Array

    @property
    def is_usable(self) -> bool:
        """False where it holds what no filter can reckon with."""
        numbers = (self.pose.position_mm, self.pose.rotation, self.covariance)
        # What is not finite in a part is not in its sum of squares, either.
        finite = all(math.isfinite(float(np.vdot(part, part))) for part in numbers)
        return finite and bool((self.covariance.diagonal() > 0).all())

    @property
    def seen(self) -> tuple[Array, Array, Array]:
        """The pad's centre in the camera frame, the attitude, and the covariance of both."""
        by_pose = seen_by_pose(self.pose)
        rotation = np.ascontiguousarray(self.pose.rotation, float)
        first = without_curvature(self.covariance, self.pose)
        return self.pose.tvec_mm, rotation, by_pose @ first @ by_pose.T


def seen_by_pose(pose: Pose) -> Array:
    """Derivatives (6, 6) of the pad's centre in the camera frame and the attitude by the pose."""
    out = np.eye(6)
    x, y, z = pose.tvec_mm
    out[:3, :3] = -pose.rotation.T
    out[:3, 3:] = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]
    return out


def pose_by_seen(pose: Pose) -> Array:
    """The inverse of `seen_by_pose`."""
    out = seen_by_pose(pose)
    out[:3, 3:] = pose.rotation @ out[:3, 3:]
    out[:3, :3] = -pose.rotation
    return out


@dataclass(frozen=True, eq=False)
class Fused:
    """A frame's pose as all frames up to it, or about it, have it.

    Attributes
    ----------
    pose : Pose
    covariance : (6, 6) float64
    is_outlier : bool
        The frame's own pose was not believed, and does not count.
    """

    pose: Pose
    covariance: Array
    is_outlier: bool = False
