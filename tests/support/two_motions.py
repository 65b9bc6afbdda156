"""A camera and the vehicle that carries it, on clocks of their own, with gaps and noise."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import cv2
import numpy as np


def turn(vector: Any) -> Any:
    """(3, 3) of a rotation vector, rad."""
    return cv2.Rodrigues(np.array(vector, float))[0]


def quaternion_wxyz(matrices: Any) -> Any:
    """(N, 4), scalar first."""
    found = []
    for matrix in matrices:
        vector = cv2.Rodrigues(np.ascontiguousarray(matrix))[0].ravel()
        angle = np.linalg.norm(vector)
        axis = vector / angle if angle > 0 else vector
        found.append([np.cos(angle / 2), *(np.sin(angle / 2) * axis)])
    return np.array(found)


@dataclass(frozen=True)
class TwoMotions:
    """Smooth motion of chance; ``axes`` of it turn, of roll, pitch and yaw."""

    seed: int = 1
    axes: tuple[float, float, float] = (0.1, 0.1, 0.4)
    climb_m: float = 1.0
    mount: Any = field(default_factory=lambda: turn([0.3, -0.2, 1.2]))
    pad: Any = field(default_factory=lambda: turn([3.0, 0.4, 0.1]))

    def _wave(self, number: int, time_s: Any) -> Any:
        rng = np.random.default_rng([self.seed, number])
        hertz, phase = rng.uniform(0.05, 0.9, 7), rng.uniform(0, 2 * np.pi, 7)
        weight = rng.normal(size=7) / (1 + 3 * hertz)
        return np.sin(2 * np.pi * np.outer(time_s, hertz) + phase) @ weight

    def height_m(self, time_s: Any) -> Any:
        """Of both, over the pad."""
        return 5 + self.climb_m * self._wave(3, time_s)

    def angles(self, time_s: Any) -> Any:
        """(N, 3) roll, pitch and yaw of the body."""
        return np.column_stack([self.axes[k] * self._wave(k, time_s) for k in range(3)])

    def body(self, time_s: Any) -> Any:
        """(N, 3, 3) local from body."""
        return np.array(
            [
                turn([0, 0, yaw]) @ turn([0, pitch, 0]) @ turn([roll, 0, 0])
                for roll, pitch, yaw in self.angles(time_s)
            ]
        )

    def camera(self, time_s: Any, sigma_deg: float = 0.0, seed: int = 0) -> Any:
        """(N, 3, 3) pad from camera."""
        noise = np.random.default_rng(seed).normal(size=(len(time_s), 3)) * np.radians(sigma_deg)
        shaken = np.array([turn(each) for each in noise])
        return self.pad @ self.body(time_s) @ self.mount @ shaken
