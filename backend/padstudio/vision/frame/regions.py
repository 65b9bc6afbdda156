"""Where in the frame the pad can be: the dense method's part of the `clean` stage.

A pad leaves one colour channel dark, ground does not: averaged over a few cells, the share of the
unused channel in the light tells them apart whatever the brightness.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.pad.spec import CHANNELS, Pad
from padstudio.vision.frame.pyramid import BGR_INDEX, Box, Pyramid

# The mask is made at about this width: cells blend there, the pad's shape does not. At 170 and at
# 680 one still of the score is lost.
_MASK_WIDTH = 340
# Least difference of either side from the threshold; below it the frame is all of a kind. Half of
# it costs a quarter more time on frames without a pad, and finds no more stills of the score.
_LEAST_SEPARATION = 0.018
# A pad has at least this many pixels of the mask; the ground's share is this percentile. Halfway
# between the two extremes serves a speck of a pad as well as one that fills the frame; the
# percentiles 90 and 99 find the same stills of the score.
_LEAST_AREA = 12
_GROUND = 97
# Added to the sum of channels, a few grey values each, so that noise in the dark is no colour;
# 6 and 24 find the same stills of the score.
_DARK = 12.0
# Regions at the most. With the largest alone one still of the score is lost; 6 find no more.
_MOST_REGIONS = 3
# A region's shape shows where its longer side has so many pixels; 30 and 120 find the same stills.
_SHAPE_WIDTH = 60


@dataclass(frozen=True, eq=False)
class Region:
    """A part of the frame that may hold the pad.

    Attributes
    ----------
    box : Box
        Frame pixels.
    mask : (h, w) bool or None
        True where pad colour is near, at the mask's level; None where all of the frame counts.
    level : int
        The mask's level.
    """

    box: Box
    mask: NDArray[np.bool_] | None
    level: int

    def middle(self, side: int) -> Region:
        """The region cut down to a square of ``side`` frame pixels round the mask's middle."""
        assert self.mask is not None
        y, x = (int(np.median(axis)) << self.level for axis in np.nonzero(self.mask))
        box, half = self.box, side // 2
        cut = Box(
            max(box.x0, x - half), max(box.y0, y - half),
            min(box.x1, x + half), min(box.y1, y + half),
        )  # fmt: skip
        return Region(cut, self.mask, self.level)

    def holds(self, xy: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Which frame pixels (N, 2) lie on the mask."""
        if self.mask is None:
            return np.ones(len(xy), bool)
        cell = ((xy + 0.5) / float(1 << self.level)).astype(np.int64)
        h, w = self.mask.shape
        return np.asarray(self.mask[cell[:, 1].clip(0, h - 1), cell[:, 0].clip(0, w - 1)])


def unused_channels(pad: Pad) -> list[int]:
    """Channels that no layer uses, so that the pad leaves them dark; as of a BGR picture."""
    used = {layer.channel for layer in pad.layers}
    return [BGR_INDEX[channel] for channel in CHANNELS if channel not in used]


def find_regions(pyramid: Pyramid, pad: Pad) -> list[Region]:
    """Parts of the frame that may hold the pad, the likeliest first, the whole frame last.

    Parameters
    ----------
    pyramid : Pyramid
    pad : Pad
        Its unused channels are what is looked for; a pad that uses all three has no such mark.

    Returns
    -------
    list of Region
        Never empty.
    """
    level = max(0, round(np.log2(pyramid.width / _MASK_WIDTH)))
    whole = Region(pyramid.box, None, level)
    unused = unused_channels(pad)
    if not unused:
        return [whole]
    dark = _dark_mask(pyramid.level(level), unused)
    if dark is None:
        return [whole]
    largest = itertools.islice(_components(dark, 7), _MOST_REGIONS)
    found = itertools.takewhile(lambda item: item[0][-1] >= _LEAST_AREA, largest)
    return [*(_region(*item, level, pyramid) for item in found), whole]


def _dark_mask(image: NDArray[np.uint8], unused: list[int]) -> NDArray[np.uint8] | None:
    """(h, w) uint8 of 0 and 1, or None where the picture is all of one kind."""
    blurred = cv2.blur(image.astype(np.float32), (3, 3))
    weights = np.zeros((2, 3))
    weights[0, unused], weights[1] = 1 / len(unused), 1
    part, total = cv2.split(cv2.transform(blurred, weights))
    share = np.asarray((part + _DARK / 3) / (total + _DARK))
    low = float(np.partition(share, _LEAST_AREA, axis=None)[_LEAST_AREA])
    high = float(np.percentile(share, _GROUND))
    if high - low < 2 * _LEAST_SEPARATION:
        return None
    return np.asarray(share < (low + high) / 2, np.uint8)


def _components(
    dark: NDArray[np.uint8], closing: int
) -> Iterator[tuple[list[int], NDArray[np.bool_]]]:
    """Connected parts of a mask without small holes, the largest first.

    Yields
    ------
    x, y, width, height, area : list of int
    part : (h, w) bool
    """
    closed = cv2.morphologyEx(dark, cv2.MORPH_CLOSE, np.ones((closing, closing), np.uint8))
    count, labels, stats, _ = cv2.connectedComponentsWithStats(closed, connectivity=8)
    for k in sorted(range(1, count), key=lambda k: -int(stats[k, cv2.CC_STAT_AREA])):
        yield [int(value) for value in stats[k]], np.asarray(labels == k)


def _region(stats: list[int], part: NDArray[np.bool_], level: int, pyramid: Pyramid) -> Region:
    """A part of the mask with some room about it."""
    x, y, w, h, _ = stats
    edge = 2 + max(w, h) // 12
    box = Box(
        max(0, (x - edge) << level),
        max(0, (y - edge) << level),
        min(pyramid.width, (x + w + edge) << level),
        min(pyramid.height, (y + h + edge) << level),
    )
    return Region(box, cv2.dilate(part.astype(np.uint8), np.ones((5, 5), np.uint8)) > 0, level)


def sharper(pyramid: Pyramid, pad: Pad, region: Region) -> Region:
    """A small region with a mask fine enough to show its shape, or the region itself.

    Parameters
    ----------
    pyramid : Pyramid
    pad : Pad
    region : Region
        As of `find_regions`, with a mask.
    """
    level = max(0, int(np.log2(max(region.box.side / _SHAPE_WIDTH, 1))))
    if region.mask is None or level >= region.level:
        return region
    image = pyramid.level(level)
    x0, y0 = region.box.x0 >> level, region.box.y0 >> level
    x1, y1 = -(-region.box.x1 >> level), -(-region.box.y1 >> level)
    dark = _dark_mask(image[y0:y1, x0:x1], unused_channels(pad))
    if dark is None:
        return region
    largest = next(_components(dark, 5), None)
    if largest is None:
        return region
    mask = np.zeros(image.shape[:2], bool)
    mask[y0:y1, x0:x1] = largest[1]
    return Region(region.box, mask, level)
