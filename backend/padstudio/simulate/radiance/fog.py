"""Fog, dust and smoke between the camera and the ground."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.color import linear_from_srgb
from padstudio.errors import SpecError
from padstudio.simulate.radiance.inks import Rgb

# Contrast at which a dark thing before the sky is just seen.
_THRESHOLD = 0.05
# Rows at a time, for the memory that their rays take.
_BAND = 256


@dataclass(frozen=True, kw_only=True)
class Fog:
    """Even fog: light L at distance d arrives as L t + A (1 − t) with t = exp(−β d).

    Koschmieder's law (H. Koschmieder, Theorie der horizontalen Sichtweite, 1924). The extinction
    β follows from the meteorological optical range (WMO-No. 8), at which 5 % of contrast is left:
    β = ln 20 / visibility.

    Attributes
    ----------
    visibility_m : float
        0.1 … 100 000. Thick fog is 50, a rotor's dust or smoke a few metres.
    airlight : (r, g, b)
        The fog's own colour A, sRGB 0 … 255 of a correctly exposed picture.
    """

    visibility_m: float
    airlight: Rgb = (196.0, 200.0, 204.0)

    def __post_init__(self) -> None:
        if not 0.1 <= self.visibility_m <= 100_000:
            raise SpecError(f"visibility_m is {self.visibility_m}; it must lie within 0.1 … 100000")
        if not (min(self.airlight) >= 0 and max(self.airlight) <= 255):
            raise SpecError(f"the fog's airlight is {self.airlight}; give sRGB within 0 … 255")

    @property
    def extinction_per_mm(self) -> float:
        """β, per mm."""
        return -math.log(_THRESHOLD) / (1000 * self.visibility_m)

    def veil(
        self, light: NDArray[np.float32], rays: NDArray[np.float32], pose: Array, level: float
    ) -> None:
        """Put fog into a picture.

        Parameters
        ----------
        light : (H, W, 3) float32
            Linear RGB; overwritten.
        rays : (H + 2, W + 2, 3) float32
            As of `padstudio.simulate.radiance.lens.ray_map`.
        pose : (12,) float64
            Rotation and position at the frame's middle; what moves within the frame changes the
            distance too little to be seen.
        level : float
            Of the light that the fog scatters.
        """
        air = (level * linear_from_srgb(np.array(self.airlight) / 255.0)).astype(np.float32)
        for first in range(0, light.shape[0], _BAND):
            part = rays[1 + first : 1 + min(first + _BAND, light.shape[0]), 1:-1].astype(float)
            drop = -(part @ pose[6:9])
            length = np.linalg.norm(part, axis=-1)
            # Above the horizon there is nothing but fog.
            distance = np.full(drop.shape, np.inf)
            seen = drop > 1e-6
            distance[seen] = pose[11] * length[seen] / drop[seen]
            through = np.exp(-self.extinction_per_mm * distance).astype(np.float32)[..., None]
            band = light[first : first + _BAND]
            band *= through
            band += air * (1 - through)
