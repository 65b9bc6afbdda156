"""How the camera moves while a frame is exposed and read out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from padstudio.arrays import Array
from padstudio.errors import SpecError
from padstudio.geometry.pose import Pose

#: Instants per exposure at which a moving camera is placed.
TIME_STEPS = 64


@dataclass(frozen=True, kw_only=True)
class Motion:
    """Velocity at the middle row's mid-exposure.

    Attributes
    ----------
    velocity_mm_s : (x, y, z)
        Of the camera's centre, pad frame.
    angular_deg_s : (x, y, z)
        Turn rate about the camera's own axes.
    """

    velocity_mm_s: tuple[float, float, float] = (0.0, 0.0, 0.0)
    angular_deg_s: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        values = np.array([self.velocity_mm_s, self.angular_deg_s], float)
        if values.shape != (2, 3) or not np.isfinite(values).all():
            raise SpecError("a motion is three finite speeds and three finite turn rates")

    @property
    def still(self) -> bool:
        """True where nothing moves."""
        return not any(self.velocity_mm_s) and not any(self.angular_deg_s)


def row_times_s(height: int, readout_ms: float) -> Array:
    """(H,) float64, each row's mid-exposure relative to the frame's middle, seconds."""
    return (np.arange(height) - (height - 1) / 2) / height * readout_ms / 1000.0


def poses_at(pose: Pose, motion: Motion, times_s: Array) -> tuple[Array, Array]:
    """Where the camera is at given times.

    Parameters
    ----------
    pose : Pose
        At time 0.
    motion : Motion
    times_s : (...) float64

    Returns
    -------
    rotation : (..., 3, 3) float64
    position_mm : (..., 3) float64
    """
    times = np.asarray(times_s, float)
    position = pose.position_mm + times[..., None] * np.array(motion.velocity_mm_s)
    rate = np.radians(np.array(motion.angular_deg_s))
    speed = float(np.linalg.norm(rate))
    if speed == 0:
        return np.broadcast_to(pose.rotation, (*times.shape, 3, 3)), position
    x, y, z = rate / speed
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = (speed * times)[..., None, None]
    turn = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * (cross @ cross)
    return pose.rotation @ turn, position


def tracks(
    pose: Pose, motion: Motion, height: int, *, exposure_ms: float, readout_ms: float
) -> Array:
    """Poses of each row's exposure, as the kernel reads them.

    Returns
    -------
    (H or 1, T, 12) float64
        Nine of the rotation, row by row, then the position; one row where all rows agree, one
        instant where nothing moves.
    """
    if motion.still or not (exposure_ms or readout_ms):
        rows, steps = np.zeros(1), np.zeros(1)
    else:
        rows = row_times_s(height, readout_ms) if readout_ms else np.zeros(1)
        count = TIME_STEPS if exposure_ms else 1
        steps = ((np.arange(count) + 0.5) / count - 0.5) * exposure_ms / 1000.0
    rotation, position = poses_at(pose, motion, rows[:, None] + steps[None, :])
    flat = rotation.reshape(*rotation.shape[:2], 9)
    return np.ascontiguousarray(np.concatenate([flat, position], axis=-1))
