"""Small, fast turns of a camera that its vehicle shakes, and rotations in numbers."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from padstudio.arrays import Array
from padstudio.errors import SpecError

Vector = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Vibration:
    """A small harmonic turning of the camera about its own axes (motors, propellers).

    The rotation vector of the camera against its unshaken attitude is
    ``amplitude_deg · sin(2π · frequency_hz · t + phase_deg)``, axis by axis; with a rolling
    shutter this is what bends straight lines into waves ("jello").

    Attributes
    ----------
    frequency_hz : float
        0.1 … 2000. Propellers of small drones: 50 … 150.
    amplitude_deg : (x, y, z)
        Peak angle about each axis of the camera, degrees, −5 … 5.
    phase_deg : (x, y, z)
        At the middle row's mid-exposure.
    """

    frequency_hz: float
    amplitude_deg: Vector
    phase_deg: Vector = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        if not 0.1 <= self.frequency_hz <= 2000:
            raise SpecError(
                f"a vibration's frequency is {self.frequency_hz} Hz; it must lie within 0.1 … 2000"
            )
        values = np.array([self.amplitude_deg, self.phase_deg], float)
        if values.shape != (2, 3) or not np.isfinite(values).all():
            raise SpecError("a vibration has three finite amplitudes and three finite phases")
        if np.abs(values[0]).max() > 5:
            raise SpecError(
                f"a vibration's amplitudes are {self.amplitude_deg} degrees; they must lie within "
                "-5 … 5"
            )

    @classmethod
    def drawn(
        cls, rng: np.random.Generator, frequency_hz: float, amplitude_deg: float
    ) -> Vibration:
        """One of the same amplitude about each axis, with phases drawn at random."""
        x, y, z = (float(value) for value in rng.uniform(0.0, 360.0, 3))
        return cls(
            frequency_hz=frequency_hz,
            amplitude_deg=(amplitude_deg, amplitude_deg, amplitude_deg),
            phase_deg=(x, y, z),
        )

    def later(self, time_s: float) -> Vibration:
        """The same vibration, seen from a time that is so much later."""
        turn = 360.0 * math.fmod(self.frequency_hz * time_s, 1.0)
        x, y, z = (float(value) + turn for value in self.phase_deg)
        return replace(self, phase_deg=(x, y, z))


def shaking(vibrations: tuple[Vibration, ...], times_s: Array) -> Array:
    """Rotations (..., 3, 3) from the unshaken to the shaken camera at times (...,)."""
    times = np.asarray(times_s, float)
    vectors = np.zeros((*times.shape, 3))
    for vibration in vibrations:
        swing = 2 * math.pi * vibration.frequency_hz * times[..., None]
        phase = np.radians(np.array(vibration.phase_deg))
        vectors += np.radians(np.array(vibration.amplitude_deg)) * np.sin(swing + phase)
    angles = np.maximum(np.linalg.norm(vectors, axis=-1), 1e-30)[..., None, None]
    return rodrigues(cross_matrices(vectors) / angles, angles)


def cross_matrices(vectors: Array) -> Array:
    """Matrices (..., 3, 3) of the cross product with vectors (..., 3)."""
    x, y, z = np.moveaxis(vectors, -1, 0)
    zero = np.zeros_like(x)
    rows = [[zero, -z, y], [z, zero, -x], [-y, x, zero]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def rodrigues(cross: Array, angle: Array) -> Array:
    """Rotations by angles (..., 1, 1) about axes as `cross_matrices` gives them."""
    return np.asarray(
        np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * (cross @ cross), float
    )
