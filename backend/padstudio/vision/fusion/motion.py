"""What the filter takes for granted of cameras and of frames."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from padstudio.arrays import Array
from padstudio.vision.fusion.kernel import Noise


@dataclass(frozen=True, kw_only=True)
class MotionModel:
    """How a camera may move, and how frames err: generous for a small drone.

    Acceleration is taken for white noise: of the size given, and as long in one direction as
    `gust_s`, `turn_s` say.

    Attributes
    ----------
    acceleration_m_s2, gust_s : float
        Of the camera's centre, each axis.
    turning_deg_s2, turn_s : float
        Angular, about each axis.
    shake_deg : float
        One standard deviation of the attitude's shaking about each axis, which differs from frame
        to frame: motors and propellers.
    speed_m_s, rate_deg_s : float
        One standard deviation of velocity and turn rate of a camera that is seen for the first
        time.
    share : float
        Of a frame's covariance the part that the frames about it share: what calibration, print
        and template leave over.
    memory_s : float
        For how long.
    """

    acceleration_m_s2: float = 2.0
    gust_s: float = 0.3
    turning_deg_s2: float = 150.0
    turn_s: float = 0.1
    shake_deg: float = 0.1
    speed_m_s: float = 5.0
    rate_deg_s: float = 100.0
    share: float = 0.2
    memory_s: float = 1.5

    @property
    def noise(self) -> Noise:
        """In the filter's units."""
        return Noise(
            acceleration=(1000 * self.acceleration_m_s2) ** 2 * 2 * self.gust_s,
            turning=math.radians(self.turning_deg_s2) ** 2 * 2 * self.turn_s,
            shake=math.radians(self.shake_deg) ** 2,
            share=self.share,
            memory_s=self.memory_s,
        )

    @property
    def fastest(self) -> Array:
        """(2,) float64, mm/s and radians/s, as of `padstudio.vision.fusion.kernel.begun`."""
        return np.array([1000 * self.speed_m_s, math.radians(self.rate_deg_s)])
