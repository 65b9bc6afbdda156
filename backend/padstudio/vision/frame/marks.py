"""What tells a pad from the ground: maps of a small picture of the frame, and how they are parted.

Two marks, each with a value a pixel that is low on the pad. *Share*: a pad leaves one channel dark,
so its share of the light is small there; fog, faded ink and haze lessen the difference, they do
not undo it. *Likeness*: ground is lighter and darker in all channels alike, a pad's layers are
coded apart, so that its channels differ from cell to cell.
"""

from __future__ import annotations

from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Image

Map = NDArray[np.float32]
Mask = NDArray[np.uint8]

# Least difference of either side from the threshold; below it the frame is all of a kind. Half of
# it costs a quarter more time on frames without a pad, and finds no more stills of the score.
_LEAST_SEPARATION = 0.018
#: A pad has at least this many pixels of a mask.
LEAST_AREA = 12
# The ground's share is this percentile. Halfway between the two extremes serves a speck of a pad as
# well as one that fills the frame; the percentiles 90 and 99 find the same stills of the score.
_GROUND = 97
# Added to the sum of channels, a few grey values each, so that noise in the dark is no colour;
# 6 and 24 find the same stills of the score.
_DARK = 12.0
# Channels are compared over blocks of so many pixels a side, less what is smoother than that.
_BLOCK = 9
# Variance that noise and rounding leave in any block, grey values squared.
_NOISE = 0.5
# Two kinds of pixels are apart where their means are by so many deviations within: halves of one
# bell-shaped kind are by 2.7.
_TWO_KINDS = 3.0


class Parted(NamedTuple):
    """A map parted in two.

    Attributes
    ----------
    mask : (h, w) uint8
        1 where the map is low, else 0.
    apart : float
        Distance of the two kinds' means over the deviation within them.
    """

    mask: Mask
    apart: float


def share_of(image: Image, unused: list[int]) -> Map:
    """The share of the light in channels that the pad leaves dark, (h, w); a third on grey.

    Parameters
    ----------
    image : (h, w, 3) uint8
    unused : list of int
        Those channels, in the picture's order.
    """
    blue, green, red = (cv2.extractChannel(image, k).astype(np.float32) for k in range(3))
    weak = np.sum([(blue, green, red)[k] for k in unused], axis=0)
    part, total = (cv2.blur(item, (3, 3)) for item in (weak, blue + green + red))
    # What is black is of no colour.
    return np.asarray((part / len(unused) + _DARK / 3) / (total + _DARK), np.float32)


def likeness_of(image: Image, a: int, b: int) -> Map:
    """How alike two channels vary in the block round each pixel, (h, w): −1 opposite … 1 alike."""
    planes = [cv2.extractChannel(image, k).astype(np.float32) for k in (a, b)]
    first, second = (plane - cv2.blur(plane, (_BLOCK, _BLOCK)) for plane in planes)
    both = cv2.blur(first * second, (_BLOCK, _BLOCK))
    total = cv2.blur(first * first + second * second, (_BLOCK, _BLOCK))
    return np.asarray(2 * both / (total + _NOISE), np.float32)


def halfway(share: Map) -> Mask | None:
    """Where the share is nearer to its least than to the ground's; None where all is of a kind."""
    ground = _GROUND / 100 * (share.size - 1)
    below = int(ground)
    above = min(below + 1, share.size - 1)
    # Once through for all of them.
    ordered = np.partition(share, (LEAST_AREA, below, above), axis=None)
    low = float(ordered[LEAST_AREA])
    high = float(ordered[below]) + (ground - below) * float(ordered[above] - ordered[below])
    if high - low < 2 * _LEAST_SEPARATION:
        return None
    return np.asarray(share < (low + high) / 2, np.uint8)


def parted(values: Map) -> Parted | None:
    """A map parted where its two kinds of pixels are farthest apart, however little that is.

    Returns
    -------
    Parted or None
        None where all pixels are of one kind.

    References
    ----------
    Otsu, N. (1979). A threshold selection method from gray-level histograms.
    doi:10.1109/TSMC.1979.4310076.
    """
    low, high = np.percentile(values[::2, ::2], (0.5, 99.5))
    if high - low < 1e-6:
        return None
    grey = np.clip((values - low) * (255 / (high - low)), 0, 255).astype(np.uint8)
    threshold, mask = cv2.threshold(grey, 0, 1, cv2.THRESH_BINARY_INV | cv2.THRESH_OTSU)
    del threshold
    (inside, spread_in), (outside, spread_out) = (
        (float(mean[0, 0]), float(deviation[0, 0]))
        for mean, deviation in (
            cv2.meanStdDev(grey, mask=mask),
            cv2.meanStdDev(grey, mask=1 - mask),
        )
    )
    share = float(mask.mean())
    within = np.sqrt(share * spread_in**2 + (1 - share) * spread_out**2)
    apart = (outside - inside) / max(float(within), 1e-6)
    return Parted(np.asarray(mask, np.uint8), apart) if apart > _TWO_KINDS else None
