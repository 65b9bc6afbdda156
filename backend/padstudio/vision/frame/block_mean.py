"""Stages `block_mean` and `clean`: a channel as black and white, without specks."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from padstudio.arrays import Image
from padstudio.vision.frame import pixels_kernel
from padstudio.vision.frame.pyramid import Plane


@dataclass(frozen=True, eq=False)
class Binary:
    """A black and white picture of a plane.

    Attributes
    ----------
    mask : (h, w) uint8
        0 or 255.
    plane : Plane
        What it was made of.
    share : float
        Share of white.
    """

    mask: Image
    plane: Plane
    share: float


def block_mean(plane: Plane, blocks: int) -> Binary:
    """White where a pixel exceeds both the channel's mean and its block's mean.

    A pixel's block is the square round it: blocks at fixed places would leave straight seams in
    uneven light, which the Hough transform takes for lines of the pad.

    Parameters
    ----------
    plane : Plane
    blocks : int
        Blocks along the plane's longer side. A block must hold several cells: within one cell it
        finds nothing but noise.
    """
    values = plane.values
    side = max(3, round(max(values.shape) / blocks)) | 1
    blurred = cv2.blur(values, (side, side), borderType=cv2.BORDER_REFLECT)
    local = np.asarray(blurred, np.float32)
    mask = pixels_kernel.above(values, local, values.mean())
    return Binary(mask, plane, _share(mask))


def clean(binary: Binary, size: int) -> Binary:
    """Remove specks by erosion and dilation, in white and in black.

    Parameters
    ----------
    binary : Binary
    size : int
        Side of the square that a speck cannot hold, pixels of the plane; 1 leaves all as it is.
    """
    kernel = np.ones((size, size), np.uint8)
    opened = cv2.morphologyEx(binary.mask, cv2.MORPH_OPEN, kernel)
    closed = np.asarray(cv2.morphologyEx(opened, cv2.MORPH_CLOSE, kernel), np.uint8)
    return Binary(closed, binary.plane, _share(closed))


def _share(mask: Image) -> float:
    """Share of white."""
    return cv2.countNonZero(mask) / mask.size
