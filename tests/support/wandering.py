"""Cameras that wander over a pad, and what single frames would say of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from padstudio.arrays import Array
from padstudio.geometry.curvature import with_curvature
from padstudio.geometry.pose import Pose, look_at_pad, rotation_from_vector
from padstudio.vision.fusion.measurement import Measurement


@dataclass(frozen=True)
class Wandering:
    """How a camera wanders, and what frames see.

    Attributes
    ----------
    height_mm : float
    fps : float
    tilt_sigma_deg : float
        Of a frame's attitude; the position errs along the arc about the pad with it.
    sight_px : float
        Error of where a frame sees the pad, pixels of a camera of 600 pixels focal length.
    shake_deg : float
        Of the camera, from frame to frame.
    share, memory_s : float
        Of the frames' errors the part that lasts, and how long.
    """

    height_mm: float = 8000.0
    fps: float = 15.0
    tilt_sigma_deg: float = 5.0
    sight_px: float = 0.1
    shake_deg: float = 0.1
    share: float = 0.2
    memory_s: float = 1.5

    def frames(self, count: int, seed: int) -> tuple[list[Measurement], list[Pose]]:
        """What frames say, and the true poses."""
        rng = np.random.default_rng(seed)
        course = _course(rng, self.height_mm)
        lasting, kept = rng.standard_normal(6), np.exp(-1 / self.fps / self.memory_s)
        found, truth = [], []
        for number in range(count):
            time_s = number / self.fps
            steady = course(time_s)
            shake = np.radians(self.shake_deg) * rng.standard_normal(3)
            pose = Pose(steady.position_mm, steady.rotation @ rotation_from_vector(shake))
            lasting = kept * lasting + np.sqrt(1 - kept**2) * rng.standard_normal(6)
            parts = np.sqrt(self.share) * lasting
            parts = parts + np.sqrt(1 - self.share) * rng.standard_normal(6)
            found.append(self._measured(time_s, pose, parts))
            truth.append(pose)
        return found, truth

    def _measured(self, time_s: float, pose: Pose, parts: Array) -> Measurement:
        range_mm = float(np.linalg.norm(pose.position_mm))
        across = self.sight_px / 600 * range_mm
        tilt = np.radians(self.tilt_sigma_deg)
        sigma = np.array([across, across, 0.002 * range_mm, tilt, tilt, tilt / 20])
        seen, turn = (sigma * parts)[:3], (sigma * parts)[3:]
        rotation = pose.rotation @ rotation_from_vector(turn)
        centre = pose.tvec_mm + seen
        x, y, z = centre
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        by_seen = np.block([[-rotation, rotation @ cross], [np.zeros((3, 3)), np.eye(3)]])
        covariance = by_seen @ np.diag(sigma**2) @ by_seen.T
        return Measurement(time_s, *_curved(Pose(-rotation @ centre, rotation), covariance))


def _curved(pose: Pose, covariance: Array) -> tuple[Pose, Array]:
    return pose, with_curvature(covariance, pose)


def _course(rng: np.random.Generator, height_mm: float):  # type: ignore[no-untyped-def]
    """A smooth path: accelerations of about 1 m/s², leaning by some degrees."""
    periods = rng.uniform(2.0, 5.0, 6)
    phases = rng.uniform(0, 2 * np.pi, 6)
    sizes = np.array([300.0, 300.0, 200.0, 0.05, 0.05, 0.1])
    level = look_at_pad(height_mm, heading_deg=float(rng.uniform(0, 360))).rotation

    def course(time_s: float) -> Pose:
        waves = sizes * np.sin(2 * np.pi * time_s / periods + phases)
        position = waves[:3] + np.array([0.0, 0.0, height_mm])
        return Pose(position, level @ rotation_from_vector(waves[3:]))

    return course


def normalized_error(truth: Pose, pose: Pose, covariance: Array) -> float:
    """Squared error over the covariance, a degree of freedom: 1 on average where it is true."""
    error = pose.step_to(truth)
    return float(error @ np.linalg.solve(covariance, error)) / 6


def position_error(truth: Pose, pose: Pose) -> float:
    """Share of the range."""
    return float(
        np.linalg.norm(truth.position_mm - pose.position_mm) / np.linalg.norm(truth.position_mm)
    )
