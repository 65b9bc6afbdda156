"""Stage `unmix`: takes the pad's colours apart by the crosstalk of its printer and camera."""

from __future__ import annotations

import cv2
import numpy as np

from padstudio.arrays import Array, Image
from padstudio.color import linear_from_srgb, picture_from_linear
from padstudio.pad.crosstalk import Matrix


def unmix(bgr: Image, matrix: Matrix | Array) -> Image:
    """A frame with its channels taken apart again.

    White stays as it is; the exposure need not be known.

    Parameters
    ----------
    bgr : (H, W, 3) uint8
    matrix : (3, 3)
        As `Crosstalk.matrix`.

    Returns
    -------
    (H, W, 3) uint8
        BGR, sRGB encoded as the frame was.
    """
    inverse = np.linalg.inv(np.array(matrix, float))
    # Rows that sum to 1 keep white; what black reflects is spread over the channels alike.
    inverse /= inverse.sum(axis=1, keepdims=True)
    table = linear_from_srgb(np.arange(256) / 255).astype(np.float32)
    linear = cv2.LUT(bgr, table)
    apart = cv2.transform(linear, inverse[::-1, ::-1].astype(np.float32))
    return picture_from_linear(np.asarray(apart, np.float32))
