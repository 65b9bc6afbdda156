"""Pictures of a calibration: each still with its residuals, and the lens as a whole."""

from __future__ import annotations

import cv2
import numpy as np

from padstudio.arrays import Image
from padstudio.calibration.results import CalibrationView

# Width of a picture, pixels.
_WIDTH = 1280
# Residuals are drawn so many times as long as they are.
MAGNIFIED = 100
_DOT, _LINE = (80, 220, 80), (0, 200, 255)


def residual_picture(image: Image, view: CalibrationView) -> Image:
    """A still with its patches as dots, and their residuals as lines a hundred times as long.

    Returns
    -------
    (h, w, 3) uint8
        BGR, at most 1280 pixels wide.
    """
    scale = min(1.0, _WIDTH / image.shape[1])
    small = cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    # Half as bright, so that what is drawn stands out.
    drawn = np.asarray(small // 2, np.uint8)
    if view.patches is None:
        return drawn
    at = (view.patches.pixels + 0.5) * scale - 0.5
    to = at + view.residuals_px * scale * MAGNIFIED
    for (x, y), (u, v) in zip(at, to, strict=True):
        start = (round(float(x)), round(float(y)))
        cv2.line(drawn, start, (round(float(u)), round(float(v))), _LINE, 1, cv2.LINE_AA)
        cv2.circle(drawn, start, 2, _DOT, -1, cv2.LINE_AA)
    return drawn
