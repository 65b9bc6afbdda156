"""How the camera moves while a frame is exposed and read out: steadily, and by shaking."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from padstudio.arrays import Array
from padstudio.errors import LimitError, SpecError
from padstudio.geometry.pose import Pose
from padstudio.simulate.vibration import Vector, Vibration, cross_matrices, rodrigues, shaking

#: Instants per exposure at which a moving camera is placed; a fast vibration asks for more.
TIME_STEPS = 64
# Of a vibration's period: so many instants, and so many pieces that are straight enough.
_STEPS_A_PERIOD = 16
_PIECES_A_PERIOD = 8
#: Periods of a vibration within one exposure.
MOST_PERIODS = 64


@dataclass(frozen=True, kw_only=True)
class Motion:
    """What the camera does about the middle row's mid-exposure.

    Attributes
    ----------
    velocity_mm_s : (x, y, z)
        Of the camera's centre, pad frame.
    angular_deg_s : (x, y, z)
        Turn rate about the camera's own axes.
    vibrations : tuple of Vibration
        Their rotation vectors add up. The frame's pose has them in it, as they are at that moment.
    """

    velocity_mm_s: Vector = (0.0, 0.0, 0.0)
    angular_deg_s: Vector = (0.0, 0.0, 0.0)
    vibrations: tuple[Vibration, ...] = ()

    def __post_init__(self) -> None:
        values = np.array([self.velocity_mm_s, self.angular_deg_s], float)
        if values.shape != (2, 3) or not np.isfinite(values).all():
            raise SpecError("a motion is three finite speeds and three finite turn rates")

    @property
    def still(self) -> bool:
        """True where nothing moves."""
        shaken = any(any(vibration.amplitude_deg) for vibration in self.vibrations)
        return not any(self.velocity_mm_s) and not any(self.angular_deg_s) and not shaken


@dataclass(frozen=True, eq=False)
class Course:
    """The camera's poses during a frame, as the inner loop reads them.

    Attributes
    ----------
    poses : (H or 1, T, 12) float64
        At evenly spaced instants of each row's exposure: nine of the rotation, row by row, then
        the position; one row where all rows agree, one instant where nothing moves.
    pieces : int
        Into how many pieces, each as good as straight, an exposure's path falls.
    """

    poses: Array
    pieces: int = 1


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
    turn = _steady_turn(np.radians(np.array(motion.angular_deg_s)), times)
    if motion.vibrations:
        before = shaking(motion.vibrations, np.zeros(()))
        turn = before.T @ turn @ shaking(motion.vibrations, times)
    return pose.rotation @ turn, position


def _steady_turn(rate: Array, times: Array) -> Array:
    """Rotations (..., 3, 3) by a turn rate (3,), radians a second."""
    speed = float(np.linalg.norm(rate))
    if speed == 0:
        return np.broadcast_to(np.eye(3), (*times.shape, 3, 3))
    return rodrigues(cross_matrices(rate / speed), (speed * times)[..., None, None])


def course(
    pose: Pose, motion: Motion, height: int, *, exposure_ms: float, readout_ms: float
) -> Course:
    """The poses of each row's exposure.

    Raises
    ------
    LimitError
        If a vibration swings more than `MOST_PERIODS` times in an exposure.
    """
    periods = max((v.frequency_hz for v in motion.vibrations), default=0.0) * exposure_ms / 1000.0
    if periods > MOST_PERIODS:
        raise LimitError(
            f"a vibration swings {periods:.0f} times in an exposure of {exposure_ms:g} ms; the "
            f"simulator's limit is {MOST_PERIODS}, give a shorter exposure",
            code="vibration_too_fast",
            detail={"periods": periods, "limit": MOST_PERIODS},
        )
    if motion.still or not (exposure_ms or readout_ms):
        rows, steps = np.zeros(1), np.zeros(1)
    else:
        rows = row_times_s(height, readout_ms) if readout_ms else np.zeros(1)
        finest = max(TIME_STEPS, math.ceil(_STEPS_A_PERIOD * periods))
        count = finest if exposure_ms else 1
        steps = ((np.arange(count) + 0.5) / count - 0.5) * exposure_ms / 1000.0
    rotation, position = poses_at(pose, motion, rows[:, None] + steps[None, :])
    flat = rotation.reshape(*rotation.shape[:2], 9)
    poses = np.ascontiguousarray(np.concatenate([flat, position], axis=-1))
    return Course(poses, max(1, math.ceil(_PIECES_A_PERIOD * periods)))
