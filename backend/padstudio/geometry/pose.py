"""The pose of a camera over a plane.

Frames (docs/conventions.md): the pad frame has its origin at the pad's centre, X to the right and
Y up the printed page, Z toward the camera, in millimetres. The camera frame is OpenCV's: x right,
y down, z forward.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from padstudio.arrays import Array


@dataclass(frozen=True, eq=False)
class Pose:
    """Position and attitude of a camera in the pad frame.

    Attributes
    ----------
    position_mm : (3,) float64
        The camera's centre in the pad frame.
    rotation : (3, 3) float64
        Takes camera vectors to pad vectors.
    """

    position_mm: Array
    rotation: Array

    @classmethod
    def from_T_camera_pad(cls, rotation: Array, translation_mm: Array) -> Pose:
        """Build from the transform that takes pad points to camera points.

        Parameters
        ----------
        rotation : (3, 3) float64
            Takes pad vectors to camera vectors, as `cv2.Rodrigues` of a solver's ``rvec``.
        translation_mm : (3,) or (3, 1) float64
            The pad's origin in the camera frame, a solver's ``tvec``.
        """
        inverse = np.asarray(rotation, float).T
        return cls(-inverse @ np.asarray(translation_mm, float).ravel(), inverse)

    @property
    def T_pad_camera(self) -> Array:
        """(4, 4) float64, takes homogeneous camera points to pad points, mm."""
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = self.rotation, self.position_mm
        return T

    @property
    def T_camera_pad(self) -> Array:
        """(4, 4) float64, takes homogeneous pad points to camera points, mm."""
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = self.rotation.T, -self.rotation.T @ self.position_mm
        return T

    def to_camera(self, points_mm: Array) -> Array:
        """Pad points (N, 3) in the camera frame, mm."""
        return np.asarray((points_mm - self.position_mm) @ self.rotation, float)

    def step_to(self, other: Pose) -> Array:
        """The step (6,) to another pose: of the centre, mm, and a rotation vector, camera frame."""
        rotvec = vector_from_rotation(self.rotation.T @ other.rotation)
        return np.concatenate([other.position_mm - self.position_mm, rotvec])

    @property
    def rvec(self) -> Array:
        """(3,) float64, the Rodrigues vector of `T_camera_pad`, radians."""
        return vector_from_rotation(self.rotation.T)

    @property
    def tvec_mm(self) -> Array:
        """(3,) float64, the pad's origin in the camera frame, mm."""
        return np.asarray(-self.rotation.T @ self.position_mm, float)

    @property
    def range_mm(self) -> float:
        """Distance from the camera's centre to the pad's centre, mm."""
        return math.sqrt(float(self.position_mm @ self.position_mm))

    @property
    def bearing(self) -> Array:
        """(3,) float64, unit vector from the camera's centre to the pad's, camera frame."""
        return self.tvec_mm / self.range_mm

    @property
    def quaternion_xyzw(self) -> Array:
        """(4,) float64, unit quaternion of `rotation`, scalar last and not negative."""
        r = self.rotation
        # Shepperd's choice of the largest component keeps the square root away from zero.
        trace = float(np.trace(r))
        squares = np.array([r[0, 0], r[1, 1], r[2, 2], trace])
        k = int(np.argmax(squares))
        q = np.empty(4)
        if k == 3:
            q[3] = 1 + trace
            q[:3] = r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]
        else:
            i, j, m = k, (k + 1) % 3, (k + 2) % 3
            q[i] = 1 + r[i, i] - r[j, j] - r[m, m]
            q[j], q[m] = r[j, i] + r[i, j], r[m, i] + r[i, m]
            q[3] = r[m, j] - r[j, m]
        q /= np.linalg.norm(q)
        return q if q[3] >= 0 else -q

    @property
    def heading_deg(self) -> float:
        """The image-up direction on the pad, clockwise from +Y, in [0, 360)."""
        up = -self.rotation[:, 1]
        return math.degrees(math.atan2(up[0], up[1])) % 360.0

    @property
    def tilt_deg(self) -> float:
        """Angle between the optical axis and straight down (−Z), in [0, 180]."""
        axis = self.rotation[:, 2]
        return math.degrees(math.atan2(math.hypot(axis[0], axis[1]), -axis[2]))

    @property
    def euler_deg(self) -> tuple[float, float, float]:
        """Roll, pitch, yaw about x, y, z in degrees: rotation = Rz(yaw) Ry(pitch) Rx(roll)."""
        r = self.rotation
        pitch = math.atan2(-r[2, 0], math.hypot(r[0, 0], r[1, 0]))
        roll = math.atan2(r[2, 1], r[2, 2])
        yaw = math.atan2(r[1, 0], r[0, 0])
        return math.degrees(roll), math.degrees(pitch), math.degrees(yaw)


def look_at_pad(
    height_mm: float,
    *,
    tilt_deg: float = 0.0,
    heading_deg: float = 0.0,
    tilt_towards_deg: float = 0.0,
    target_mm: tuple[float, float] = (0.0, 0.0),
) -> Pose:
    """Pose of a camera whose optical axis meets the pad plane at a target.

    Parameters
    ----------
    height_mm : float
        Height of the camera's centre over the pad plane.
    tilt_deg : float
        Angle between the optical axis and straight down, in [0, 90).
    heading_deg : float
        Image-up direction for an untilted camera, clockwise from +Y.
    tilt_towards_deg : float
        Compass direction (clockwise from +Y) toward which the optical axis leans.
    target_mm : (x, y)
        Where the optical axis meets the plane.
    """
    lean, tilt = math.radians(tilt_towards_deg), math.radians(tilt_deg)
    h = math.radians(heading_deg)
    down = np.array(
        [
            [math.cos(h), -math.sin(h), 0.0],
            [-math.sin(h), -math.cos(h), 0.0],
            [0.0, 0.0, -1.0],
        ]
    )
    # The turn about this horizontal axis takes straight down toward the lean direction.
    axis = np.array([-math.cos(lean), math.sin(lean), 0.0])
    rotation = rotation_from_vector(-axis * tilt) @ down
    forward = rotation[:, 2]
    target = np.array([target_mm[0], target_mm[1], 0.0])
    return Pose(target + forward * (height_mm / forward[2]), rotation)


def rotation_from_quaternion(quaternion_xyzw: Sequence[float]) -> Array:
    """(3, 3) rotation of a unit quaternion, scalar last."""
    x, y, z, w = np.asarray(quaternion_xyzw, float) / np.linalg.norm(quaternion_xyzw)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def rotation_from_vector(vector: Array) -> Array:
    """The rotation (3, 3) of a rotation vector (3,), radians (Rodrigues' formula)."""
    x, y, z = np.asarray(vector, float).ravel().tolist()
    square = x * x + y * y + z * z
    angle = math.sqrt(square)
    # Plain figures: calls of NumPy and OpenCV cost more than all of it.
    a = 1 - square / 6 if angle < 1e-4 else math.sin(angle) / angle
    b = 0.5 - square / 24 if angle < 1e-4 else 2 * (math.sin(angle / 2) / angle) ** 2
    return np.array(
        [
            [1 - b * (y * y + z * z), b * x * y - a * z, b * x * z + a * y],
            [b * x * y + a * z, 1 - b * (x * x + z * z), b * y * z - a * x],
            [b * x * z - a * y, b * y * z + a * x, 1 - b * (x * x + y * y)],
        ]
    )


def vector_from_rotation(rotation: Array) -> Array:
    """The rotation vector (3,), radians, of a rotation (3, 3)."""
    (r00, r01, r02), (r10, r11, r12), (r20, r21, r22) = rotation.tolist()
    x, y, z = (r21 - r12) / 2, (r02 - r20) / 2, (r10 - r01) / 2
    sine, cosine = math.sqrt(x * x + y * y + z * z), (r00 + r11 + r22 - 1) / 2
    if cosine > 0:
        # OpenCV takes angles below 1e-5 for none.
        scale = math.atan2(sine, cosine) / sine if sine > 0 else 1.0
        return np.array([x * scale, y * scale, z * scale])
    return np.asarray(cv2.Rodrigues(rotation)[0], float).ravel()


def rotation_angle_deg(a: Array, b: Array) -> float:
    """Angle between two rotations, (3, 3) each, in degrees."""
    cosine = (float(np.sum(a * b)) - 1.0) / 2.0
    return math.degrees(math.acos(max(-1.0, min(1.0, cosine))))
