"""Stage `edges`, paper: Canny on the cleaned picture, then dilation."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.vision.block_mean import Binary
from padstudio.vision.planes import Plane
from padstudio.vision.regions import Region
from padstudio.vision.types import Image, Reason, StageFailure

# Canny's two thresholds on a stretched picture of 0 … 255; a black and white one passes any.
_LOW, _HIGH = 40.0, 110.0
_LEAST_EDGES = 100


@dataclass(frozen=True, eq=False)
class EdgeMap:
    """Edges of a plane as a picture.

    Attributes
    ----------
    thin : (h, w) uint8
        Canny's edges, 0 or 255.
    mask : (h, w) uint8
        The same, dilated.
    plane : Plane
        What they were found in.
    """

    thin: Image
    mask: Image
    plane: Plane


def find_edge_map(binary: Binary, region: Region, levels: int) -> EdgeMap | StageFailure:
    """Canny edges on the pad's colour, dilated so that the Hough transform sees whole lines.

    Parameters
    ----------
    binary : Binary
    region : Region
        Edges off its mask are dropped: grass has more of them than the pad.
    levels : int
        Y; with more than two levels black and white would lose lines, so the grey plane is taken.

    References
    ----------
    Canny, J. (1986). A computational approach to edge detection. doi:10.1109/TPAMI.1986.4767851
    """
    picture = binary.mask if levels == 2 else _gray(binary.plane)
    thin = np.asarray(cv2.Canny(picture, _LOW, _HIGH), np.uint8)
    y, x = np.nonzero(thin)
    off = ~region.holds(binary.plane.to_frame(np.stack([x, y], axis=1).astype(float)))
    thin[y[off], x[off]] = 0
    count = len(x) - int(off.sum())
    if count < _LEAST_EDGES:
        return StageFailure(
            "edges",
            Reason.NO_EDGES,
            f"only {count} edge pixels in {binary.plane.channel}, {_LEAST_EDGES} are needed",
        )
    mask = np.asarray(cv2.dilate(thin, np.ones((3, 3), np.uint8)), np.uint8)
    return EdgeMap(thin, mask, binary.plane)


def _gray(plane: Plane) -> NDArray[np.uint8]:
    smooth = cv2.GaussianBlur(plane.values, (5, 5), 0)
    return np.clip(np.round(smooth), 0, 255).astype(np.uint8)
