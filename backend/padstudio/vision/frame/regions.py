"""Where in the frame the pad can be: the dense method's part of the `clean` stage.

By what a pad's picture is made of (`marks`), averaged over a few cells: clear colour first, fainter
marks where that leads nowhere, the whole frame last.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.pad.spec import CHANNELS, Pad
from padstudio.vision.frame.marks import (
    LEAST_AREA,
    Mask,
    halfway,
    likeness_of,
    parted,
    share_of,
)
from padstudio.vision.frame.pyramid import BGR_INDEX, Box, Pyramid

# The mask is made at about this width: cells blend there, the pad's shape does not. At 170 and at
# 680 one still of the score is lost.
_MASK_WIDTH = 340
# Regions at the most. With the largest alone one still of the score is lost; 6 find no more.
_MOST_REGIONS = 3
# Of each faint mark so many; regions that share so much of their area are one.
_MOST_FAINT, _SAME = 2, 0.7
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
        """The region cut down to a square of ``side`` frame pixels round its middle."""
        box, half = self.box, side // 2
        y, x = (box.y0 + box.y1) // 2, (box.x0 + box.x1) // 2
        if self.mask is not None:
            y, x = (int(np.median(axis)) << self.level for axis in np.nonzero(self.mask))
        cut = Box(
            max(box.x0, x - half), max(box.y0, y - half),
            min(box.x1, x + half), min(box.y1, y + half),
        )  # fmt: skip
        return Region(cut, self.mask, self.level)

    def points(self) -> NDArray[np.float64]:
        """Middles of the mask's pixels, frame pixels (N, 2)."""
        assert self.mask is not None
        rows, columns = np.nonzero(self.mask)
        middles = np.column_stack([columns, rows]).astype(np.float64) + 0.5
        return middles * float(1 << self.level) - 0.5

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


def find_regions(pyramid: Pyramid, pad: Pad, pads: int = 1) -> list[Region]:
    """Parts of the frame that have the pad's colour, the largest first, the whole frame last.

    Parameters
    ----------
    pyramid : Pyramid
    pad : Pad
        Its unused channels are what is looked for; a pad that uses all three has no such mark.
    pads : int
        So many of these channels may be in view; each beyond the first may be a region more.

    Returns
    -------
    list of Region
        Never empty.
    """
    level = _mask_level(pyramid)
    unused = unused_channels(pad)
    dark = halfway(share_of(pyramid.level(level), unused)) if unused else None
    found = [] if dark is None else _of_mask(dark, level, pyramid, _MOST_REGIONS + pads - 1)
    return [*found, Region(pyramid.box, None, level)]


def faint_regions(pyramid: Pyramid, pad: Pad, known: Sequence[Region]) -> list[Region]:
    """Parts of the frame that differ from the rest as a pad does, however little.

    For a frame whose regions of clear colour hold no pad: fog and haze, faded ink, odd light.

    Parameters
    ----------
    pyramid : Pyramid
    pad : Pad
    known : sequence of Region
        What was looked at; regions much like one of them are left out.

    Returns
    -------
    list of Region
        At most two by each mark.
    """
    level = _mask_level(pyramid)
    image, unused = pyramid.level(level), unused_channels(pad)
    maps = [share_of(image, unused)] if unused else []
    used = [BGR_INDEX[layer.channel] for layer in pad.layers]
    maps.append(likeness_of(image, *[*used, *unused][:2]))
    found: list[Region] = []
    for values in maps:
        apart = parted(values)
        fresh = [] if apart is None else _of_mask(apart.mask, level, pyramid, _MOST_FAINT)
        found += [item for item in fresh if not any(_alike(item, k) for k in [*known, *found])]
    return found


def parts_of(mask: NDArray[np.bool_], level: int, size: tuple[int, int]) -> list[Region]:
    """Connected parts of a mask as regions, the largest first; slivers are left out.

    Parameters
    ----------
    mask : (h, w) bool
    level : int
        The mask's level.
    size : (width, height)
        The frame's, pixels.
    """
    kernel = np.ones((5, 5), np.uint8)
    opened = np.asarray(cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_OPEN, kernel), np.uint8)
    parts = itertools.takewhile(lambda item: item[0][-1] >= LEAST_AREA, _components(opened, 1))
    return [_region(*item, level, size) for item in parts]


def _mask_level(pyramid: Pyramid) -> int:
    return max(0, round(math.log2(pyramid.width / _MASK_WIDTH)))


def _of_mask(mask: Mask, level: int, pyramid: Pyramid, most: int) -> list[Region]:
    """The largest parts of a mask, so many at the most."""
    largest = itertools.islice(_components(mask, 7), most)
    found = itertools.takewhile(lambda item: item[0][-1] >= LEAST_AREA, largest)
    return [_region(*item, level, (pyramid.width, pyramid.height)) for item in found]


def _alike(a: Region, b: Region) -> bool:
    """True where two regions are mostly one."""
    if a.mask is None or b.mask is None:
        return False
    return bool((a.mask & b.mask).sum() > _SAME * (a.mask | b.mask).sum())


def _components(dark: Mask, closing: int) -> Iterator[tuple[list[int], NDArray[np.bool_]]]:
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


def _region(stats: list[int], part: NDArray[np.bool_], level: int, size: tuple[int, int]) -> Region:
    """A part of the mask with some room about it."""
    x, y, w, h, _ = stats
    edge = 2 + max(w, h) // 12
    box = Box(
        max(0, (x - edge) << level),
        max(0, (y - edge) << level),
        min(size[0], (x + w + edge) << level),
        min(size[1], (y + h + edge) << level),
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
    dark = halfway(share_of(image[y0:y1, x0:x1], unused_channels(pad)))
    if dark is None:
        return region
    largest = next(_components(dark, 5), None)
    if largest is None:
        return region
    mask = np.zeros(image.shape[:2], bool)
    mask[y0:y1, x0:x1] = largest[1]
    return Region(region.box, mask, level)
