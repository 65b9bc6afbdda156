"""A photo of the printed test strip, as a camera sees it whose colours mix."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from padstudio.pad.sheets import strip

IDENTITY = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
_PX_PER_MM = 6
_LEFT_MM, _TOP_MM = 15.0, 12.0
_LIGHT = 235.0


def strip_photo(mixture: ArrayLike = IDENTITY, *, light: float = _LIGHT) -> bytes:
    """A PNG of the strip on white paper.

    Parameters
    ----------
    mixture : (3, 3)
        Linear light in camera channels, RGB, of nominal channels; white stays white.
    light : float
        Grey value of white paper.
    """
    page = np.ones((80 * _PX_PER_MM, 220 * _PX_PER_MM, 3))
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    side = int(strip.MARKER_MM * _PX_PER_MM)
    for number, (x, y) in enumerate(strip.MARKER_CORNERS_MM):
        left, top = int((x + _LEFT_MM) * _PX_PER_MM), int((y + _TOP_MM) * _PX_PER_MM)
        marker = cv2.aruco.generateImageMarker(dictionary, number, side) / 255
        page[top : top + side, left : left + side] = marker[..., None]
    for patch in strip.PATCHES:
        x0, x1 = (int((x + _LEFT_MM) * _PX_PER_MM) for x in (patch.box.x0, patch.box.x1))
        y0, y1 = (int((y + _TOP_MM) * _PX_PER_MM) for y in (patch.box.y0, patch.box.y1))
        page[y0:y1, x0:x1] = np.array(patch.rgb) / 255
    photo = light * encoded(page @ np.asarray(mixture, float).T)
    return cv2.imencode(".png", np.round(photo).astype(np.uint8)[..., ::-1])[1].tobytes()


def encoded(linear: NDArray[np.float64]) -> NDArray[np.float64]:
    """sRGB values 0 … 1 of linear light (IEC 61966-2-1)."""
    light = np.clip(linear, 0, 1)
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
