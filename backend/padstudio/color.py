"""sRGB and linear light (IEC 61966-2-1)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array, Image


def linear_from_srgb(values: Array) -> Array:
    """Linear light 0 … 1 from sRGB values 0 … 1, of any shape."""
    values = np.asarray(values, float)
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


def srgb_from_linear(values: Array) -> Array:
    """sRGB values 0 … 1 from linear light, clipped to 0 … 1, of any shape."""
    values = np.clip(values, 0.0, 1.0)
    return np.where(values <= 0.0031308, 12.92 * values, 1.055 * values ** (1 / 2.4) - 0.055)


def picture_from_linear(linear: NDArray[np.float32]) -> Image:
    """8-bit sRGB values from linear light, clipped to 0 … 1, by a table of 4096 steps."""
    table = np.round(255 * srgb_from_linear(np.arange(4096) / 4095)).astype(np.uint8)
    encoded: Image = table[np.clip(linear * 4095 + 0.5, 0, 4095).astype(np.uint16)]
    return encoded
