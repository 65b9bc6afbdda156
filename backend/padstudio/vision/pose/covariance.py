"""What every frame's pose is less sure by than its residuals tell."""

from __future__ import annotations

from padstudio.arrays import Array

# Sensor mosaic, chroma of half resolution and calibration move the whole picture by so much.
_PICTURE_SHIFT_PX = 0.03


def with_picture_shift(covariance: Array, focal_px: float) -> Array:
    """A pose's covariance (6, 6) with what moves all of a picture alike: a turn of the camera."""
    out = covariance.copy()
    out[[3, 4], [3, 4]] += (_PICTURE_SHIFT_PX / focal_px) ** 2
    return out
