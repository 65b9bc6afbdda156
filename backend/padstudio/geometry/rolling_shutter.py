"""A pose that may change while a rolling shutter reads the frame.

It changes steadily: each row is seen from a pose of its own, linear in the time of the row.

References
----------
Meingast, M., Geyer, C. and Sastry, S. (2005). Geometric models of rolling-shutter cameras.
arXiv:cs/0503076.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from padstudio.arrays import Array
from padstudio.geometry import projection
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose, rotation_from_vector
from padstudio.geometry.projection import PoseState, Projector

# Poses that differ by less are one to begin with.
_NEAR_RAD = 0.01


def cross(a: Array, b: Array) -> Array:
    """Cross products of rows, (N, 3) or (3,) each; `numpy.cross` costs four times as much."""
    ax, ay, az = a.T
    bx, by, bz = b.T
    return np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=-1)


@dataclass(frozen=True, eq=False)
class KnownMotion:
    """How a pose changes while its frame is read, known from the frames before.

    Attributes
    ----------
    shift_mm, rotvec : (3,) float64
        As of `MovingPose`.
    climb_sigma_mm : float
        One standard deviation of the change of height.
    """

    shift_mm: Array
    rotvec: Array
    climb_sigma_mm: float


@dataclass(frozen=True, eq=False)
class MovingPose:
    """The pose at the frame's middle row and its change from top to bottom.

    Attributes
    ----------
    pose : Pose
        At the middle row's exposure.
    shift_mm : (3,) float64
        Change of the camera's centre from the first row to the last, pad frame.
    rotvec : (3,) float64
        Rotation vector of the change of attitude from the first row to the last, camera frame,
        radians.
    """

    pose: Pose
    shift_mm: Array = field(default_factory=lambda: np.zeros(3))
    rotvec: Array = field(default_factory=lambda: np.zeros(3))

    @classmethod
    def of(cls, state: PoseState) -> MovingPose:
        """The pose that compiled loops found."""
        return cls(Pose(state.centre, state.rotation), state.shift, state.rotvec)

    @cached_property
    def still(self) -> bool:
        """True where nothing changes during the frame."""
        return not (self.shift_mm.any() or self.rotvec.any())

    @cached_property
    def state(self) -> PoseState:
        """The pose as compiled loops take it."""
        parts = (self.pose.rotation, self.pose.position_mm, self.shift_mm, self.rotvec)
        return PoseState(*(np.ascontiguousarray(part, float) for part in parts))

    def project(self, camera: Camera, points_mm: Array) -> Array:
        """Frame pixels (N, 2) of pad points (N, 3); NaN behind the camera."""
        return projection.project(np.ascontiguousarray(points_mm, float), self.projector(camera))

    def projector(self, camera: Camera) -> Projector:
        """The pose and the camera as compiled loops take them."""
        return Projector(self.state, camera.lens, self.still)

    def moved(self, step: Array) -> MovingPose:
        """The pose after a step (6,) as of `Pose.step_to`, or (12,) with those of the changes."""
        rotation = self.pose.rotation @ rotation_from_vector(step[3:6])
        # One step of Newton and Schulz toward the nearest rotation takes away what rounding adds.
        rotation = rotation @ (1.5 * np.eye(3) - 0.5 * (rotation.T @ rotation))
        pose = Pose(self.pose.position_mm + step[:3], rotation)
        if len(step) == 6:
            return MovingPose(pose, self.shift_mm, self.rotvec)
        return MovingPose(pose, self.shift_mm + step[6:9], self.rotvec + step[9:12])

    def near(self, other: MovingPose) -> bool:
        """True where another pose is so near that either leads to the same best one."""
        step = self.step_to(other)
        away = np.linalg.norm(step[:3]) / max(abs(self.pose.position_mm[2]), 1e-9)
        return bool(max(away, np.linalg.norm(step[3:])) < _NEAR_RAD)

    def apart_px(self, other: MovingPose, focal_px: float) -> float:
        """By about how many pixels another pose moves the picture."""
        step = self.step_to(other)
        away = np.abs(step[:3]).max() / max(abs(float(self.pose.position_mm[2])), 1e-9)
        return focal_px * float(max(away, np.abs(step[3:]).max()))

    def step_to(self, other: MovingPose) -> Array:
        """The step (6,) of `moved` that leads to another's pose."""
        return self.pose.step_to(other.pose)


def picture_change(points: Array, rotation: Array) -> Array:
    """Change (N, 2, 6) of pictures x/z, y/z of camera points (N, 3) with centre and attitude."""
    x, y, z = points.T
    zero = np.zeros_like(x)
    slope = np.stack([1 / z, zero, -x / z**2, zero, 1 / z, -y / z**2], axis=1).reshape(-1, 2, 3)
    # A turn w moves a point by −w × p.
    turn = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=1).reshape(-1, 3, 3)
    moved = np.concatenate([np.broadcast_to(-rotation.T, (len(x), 3, 3)), turn], axis=2)
    return np.asarray(slope @ moved)


def row_times(camera: Camera, rows: Array) -> Array:
    """Times at which frame rows are read, −0.5 … 0.5 of the frame."""
    return (rows - (camera.height - 1) / 2) / camera.height
