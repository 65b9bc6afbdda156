"""Where a camera is over a pad: smooth paths through time, and single places."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from padstudio.geometry.pose import Pose, look_at_pad, rotation_from_vector
from padstudio.simulate.motion import Motion

Path = Callable[[float], Pose]
# Of the central differences: far below the fastest wave's period of 0.7 s.
_STEP_S = 1e-3


def wandering_path(
    rng: np.random.Generator, from_mm: float, to_mm: float, duration_s: float, strength: float
) -> Path:
    """A smooth path down: even ratios of height, drift and leaning as sums of slow waves.

    Drift is a share of the height, so that the pad stays about in the middle of the picture.
    """
    drift = [_waves(rng, 0.05 * strength) for _ in range(2)]
    lean = [_waves(rng, math.radians(2.0) * strength) for _ in range(2)]
    turn, heading = _waves(rng, math.radians(6.0) * strength), rng.random() * 2 * math.pi

    def path(time_s: float) -> Pose:
        share = min(max(time_s / duration_s, 0.0), 1.0)
        share = share * share * (3.0 - 2.0 * share)
        height = from_mm * (to_mm / from_mm) ** share
        level = look_at_pad(height, heading_deg=math.degrees(heading + turn(time_s))).rotation
        tip = rotation_from_vector(np.array([lean[0](time_s), lean[1](time_s), 0.0]))
        place = np.array([height * drift[0](time_s), height * drift[1](time_s), height])
        return Pose(place, level @ tip)

    return path


def motion_along(path: Path, time_s: float) -> Motion:
    """Velocities on a path, by central differences."""
    before, after = path(time_s - _STEP_S), path(time_s + _STEP_S)
    change = before.step_to(after) / (2 * _STEP_S)
    velocity, rate = change[:3], np.degrees(change[3:])
    return Motion(
        velocity_mm_s=(float(velocity[0]), float(velocity[1]), float(velocity[2])),
        angular_deg_s=(float(rate[0]), float(rate[1]), float(rate[2])),
    )


def _waves(rng: np.random.Generator, amplitude: float) -> Callable[[float], float]:
    periods = np.array([5.0, 2.1, 0.9]) * (0.8 + 0.4 * rng.random(3))
    weights = np.array([1.0, 0.4, 0.12])
    phases = rng.random(3) * 2 * math.pi

    def wave(time_s: float) -> float:
        angles = 2 * math.pi * time_s / periods + phases
        return float(amplitude * (weights * np.sin(angles)).sum())

    return wave


def scattered(rng: np.random.Generator, height_mm: float, sway: float) -> Pose:
    """A pose about the pad's centre with any heading and a small tilt."""
    reach = min(0.1 * height_mm, 250.0) * sway
    x, y = rng.uniform(-reach, reach, 2)
    return look_at_pad(
        height_mm,
        tilt_deg=min(float(rng.random()) * 8.0 * sway, 60.0),
        heading_deg=float(rng.random()) * 360.0,
        tilt_towards_deg=float(rng.random()) * 360.0,
        target_mm=(float(x), float(y)),
    )


def tilted(rng: np.random.Generator, distance_mm: float, tilt_deg: float) -> Pose:
    """A pose at a distance from the pad's centre, toward any side."""
    toward = float(rng.random()) * 360.0
    return look_at_pad(
        distance_mm * math.cos(math.radians(tilt_deg)),
        tilt_deg=tilt_deg,
        heading_deg=toward,
        tilt_towards_deg=toward,
    )
