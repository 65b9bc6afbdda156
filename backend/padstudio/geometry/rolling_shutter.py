"""A pose that may change while a rolling shutter reads the frame."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import cv2
import numpy as np

from padstudio.arrays import Array
from padstudio.geometry import projection
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose

# Poses that differ by less are one to begin with.
_NEAR_RAD = 0.01


def cross(a: Array, b: Array) -> Array:
    """Cross products of rows, (N, 3) each; `numpy.cross` costs four times as much on thousands."""
    ax, ay, az = a.T
    bx, by, bz = b.T
    return np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=1)


@dataclass(frozen=True, eq=False)
class KnownMotion:
    """How a pose changes while its frame is read, known from the frames before.

    Attributes
    ----------
    shift_mm, turn : (3,) float64
        As of `MovingPose`.
    climb_sigma_mm : float
        One standard deviation of the change of height.
    """

    shift_mm: Array
    turn: Array
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
    turn : (3,) float64
        Rotation vector of the change of attitude from the first row to the last, camera frame,
        radians.
    """

    pose: Pose
    shift_mm: Array = field(default_factory=lambda: np.zeros(3))
    turn: Array = field(default_factory=lambda: np.zeros(3))

    @cached_property
    def still(self) -> bool:
        """True where nothing changes during the frame."""
        return not (self.shift_mm.any() or self.turn.any())

    @cached_property
    def _stacked(self) -> Array:
        return np.vstack([self.pose.rotation, self.pose.position_mm, self.shift_mm, self.turn])

    def to_camera(self, points_mm: Array, moment: Array | float = 0.0) -> Array:
        """Pad points (N, 3) in the camera frame of given moments, −0.5 … 0.5 of the frame."""
        s = np.broadcast_to(np.asarray(moment, float), (len(points_mm),))[:, None]
        seen = (points_mm - self.pose.position_mm - s * self.shift_mm) @ self.pose.rotation
        # The turn within one frame is small: first order suffices.
        if self.still:
            return np.asarray(seen, float)
        return np.asarray(seen - s * cross(np.broadcast_to(self.turn, seen.shape), seen), float)

    def moment(self, camera: Camera, rows: Array) -> Array:
        """Moments of frame rows, −0.5 … 0.5."""
        return (rows - (camera.height - 1) / 2) / camera.height

    def project(self, camera: Camera, points_mm: Array) -> Array:
        """Frame pixels (N, 2) of pad points (N, 3); NaN behind the camera."""
        return projection.project(np.ascontiguousarray(points_mm, float), *self.plain(camera))

    def plain(self, camera: Camera) -> tuple[Array, Array, Array, int, bool]:
        """The pose (6, 3) and the camera as `padstudio.geometry.projection` takes them."""
        return self._stacked, camera.matrix, _lens(camera), camera.height, self.still

    def moved(self, step: Array) -> MovingPose:
        """The pose after a step of 6 or 12: centre (mm, pad), turn (camera), and their changes."""
        turn = np.asarray(cv2.Rodrigues(np.asarray(step[3:6], float))[0], float)
        rotation = self.pose.rotation @ turn
        # One step of Newton's toward the nearest rotation takes away what rounding adds.
        rotation = rotation @ (1.5 * np.eye(3) - 0.5 * (rotation.T @ rotation))
        pose = Pose(self.pose.position_mm + step[:3], rotation)
        if len(step) == 6:
            return MovingPose(pose, self.shift_mm, self.turn)
        return MovingPose(pose, self.shift_mm + step[6:9], self.turn + step[9:12])

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
        turn = cv2.Rodrigues(self.pose.rotation.T @ other.pose.rotation)[0].ravel()
        return np.concatenate([other.pose.position_mm - self.pose.position_mm, turn])


def normalized(camera: Camera, pixels: Array) -> Array:
    """As `Camera.normalize`, for thousands of points through a lens."""
    if not camera.distorted:
        return camera.normalize(pixels)
    return projection.undistorted(np.ascontiguousarray(pixels, float), camera.matrix, _lens(camera))


@lru_cache(maxsize=8)
def _lens(camera: Camera) -> Array:
    """The lens (9,) as of `padstudio.geometry.projection.distorted`."""
    lens = np.zeros(9)
    lens[0] = camera.model == "fisheye"
    lens[1 : 1 + len(camera.distortion)] = camera.distortion
    return lens
