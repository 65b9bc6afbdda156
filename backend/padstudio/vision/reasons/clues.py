"""What a second look at a failed frame measures: sharpness, colours, the pad's parts, its cells.

Each figure is measured when a suspicion asks for it. Nothing here is run where only the first
reason of a failure is wanted.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.vision.frame.diagnosis import FrameEvidence
from padstudio.vision.frame.marks import LEAST_AREA, halfway, share_of
from padstudio.vision.frame.prepare import Stretch
from padstudio.vision.frame.pyramid import BGR_INDEX, Box, Pyramid
from padstudio.vision.frame.regions import unused_channels
from padstudio.vision.search.lattice import Lattice
from padstudio.vision.search.looks import Search
from padstudio.vision.search.search import read_lattice

Plane = NDArray[np.float32]

# Side of the part in which steps are measured, pixels, and how far to either side of each pixel
# the contrast is taken that its slope is compared with.
_SAMPLE, _REACH = 512, 24
# Directions, degrees, and the share of the steepest slopes that are not looked at, percent.
_DIRECTIONS, _STEEPEST = np.arange(0, 180, 15), 99.7
# The pad's parts are looked for at about this width.
_MASK_WIDTH = 340
# The pad's colours: so far below the ground's share, and below this share at all; or this far below
# a third, whatever the ground.
_LEAST_DEPTH, _MOST_LEVEL, _ALL_OVER = 0.04, 0.31, 0.27
#: Share of edges on the lines of a lattice that leaves no doubt of it.
CLEAR_ORDER = 0.9
# So many lattices are read again.
_MOST_LATTICES = 3


@dataclass(frozen=True)
class Sharpness:
    """Width of the steepest steps by direction.

    Attributes
    ----------
    least_px, most_px : float
        Contrast over slope where it is greatest, in the sharpest and in the flattest direction; a
        sharp step takes about 2.
    direction_deg : int
        Of the flattest, counter-clockwise from the picture's right.
    contrast : float
        Between dark and bright, stretched grey values.
    """

    least_px: float
    most_px: float
    direction_deg: int
    contrast: float


@dataclass(frozen=True)
class Parts:
    """Where the frame has the pad's colour.

    Attributes
    ----------
    count : int
        Connected parts.
    share : float
        Of the frame.
    fill : float
        Share of their common hull that they fill; 1 for a pad that nothing hides.
    sides : int
        Of the frame's four sides that they touch.
    longest_px : float
        Longer side of the hull's upright box, frame pixels.
    depth : float
        How far the unused channels' share of the light lies below the ground's: 0.33 for pure inks
        on grey.
    level : float
        That share within the parts.
    """

    count: int
    share: float
    fill: float
    sides: int
    longest_px: float
    depth: float
    level: float


@dataclass(frozen=True)
class Reading:
    """The lattice on whose lines most edges lie, and its cells at their best place on the pad.

    Attributes
    ----------
    order : float
        Share of edges that lie on its lines.
    length_px : float
        Of the borders that these edges make up, frame pixels.
    cells : int
        Cells that were compared.
    kappa : float
        Their agreement beyond chance, of 1.
    log10_false_alarm : float
    """

    order: float
    length_px: float
    cells: int
    kappa: float
    log10_false_alarm: float


class Clues:
    """The figures of one frame.

    Parameters
    ----------
    frame : FrameEvidence
    search : Search or None
        Of the dense method, without a pose; None where there is one, and cells are known.
    """

    def __init__(self, frame: FrameEvidence, search: Search | None = None) -> None:
        self.frame, self.search = frame, search

    @property
    def light(self) -> Stretch:
        """Grey values of the frame as it came, before any veil was taken off."""
        return self.frame.light or self.frame.stretch

    @property
    def came(self) -> Pyramid:
        """The frame as it came: a veil that is taken off takes colours with it."""
        return self.frame.came or self.frame.pyramid

    @cached_property
    def top(self) -> float:
        """The brightest grey values, all but a two-hundredth."""
        return max(self.light.high)

    @cached_property
    def relief(self) -> float:
        """Standard deviation of the picture's smoothed brightness: what is more than noise."""
        image = self.came.level(_level(self.came.width))
        grey = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY).astype(np.float32)
        return float(cv2.blur(grey, (5, 5)).std())

    @cached_property
    def color(self) -> float:
        """Largest mean difference between two channels; 0 of a monochrome picture."""
        pyramid = self.came
        planes = cv2.split(pyramid.level(_level(pyramid.width)).astype(np.float32))
        pairs = ((0, 1), (1, 2), (0, 2))
        return max(float(np.abs(planes[a] - planes[b]).mean()) for a, b in pairs)

    @cached_property
    def parts(self) -> Parts | None:
        """Where the pad's colour is; None where there is none."""
        pyramid, unused = self.came, unused_channels(self.frame.pad)
        level = _level(pyramid.width)
        share = share_of(pyramid.level(level), unused) if unused else None
        mask = None if share is None else halfway(share)
        if mask is None or share is None:
            return None
        clean = cv2.morphologyEx(mask, cv2.MORPH_OPEN, np.ones((3, 3), np.uint8))
        count, labels, stats, _ = cv2.connectedComponentsWithStats(clean, connectivity=8)
        large = [k for k in range(1, count) if stats[k, cv2.CC_STAT_AREA] >= LEAST_AREA]
        if not large:
            return None
        kept = np.isin(labels, large)
        points = cv2.findNonZero(kept.astype(np.uint8))
        hull = float(cv2.contourArea(cv2.convexHull(points)))
        x, y, width, height = cv2.boundingRect(points)
        h, w = kept.shape
        sides = int(x <= 1) + int(y <= 1) + int(x + width >= w - 1) + int(y + height >= h - 1)
        ground = float(np.median(share[~kept])) if (~kept).any() else 1 / 3
        return Parts(
            count=len(large),
            share=float(kept.mean()),
            fill=min(1.0, float(kept.sum()) / max(hull, 1.0)),
            sides=sides,
            longest_px=float(max(width, height) << level),
            depth=ground - float(np.median(share[kept])),
            level=float(np.median(share[kept])),
        )

    @property
    def pad_is_seen(self) -> bool:
        """True where the pad's colours are: apart from the ground, or all over the frame."""
        parts = self.parts
        if parts is None:
            return False
        apart = parts.depth >= _LEAST_DEPTH and parts.level < _MOST_LEVEL
        return apart or parts.level < _ALL_OVER

    @cached_property
    def readings(self) -> list[Reading]:
        """The clearest lattices, each as the layer shows it that it fits best."""
        if self.search is None:
            return []
        best = sorted(self.search.lattices, key=_clearness, reverse=True)[:_MOST_LATTICES]
        found = (_read(self.search, lattice) for lattice in best)
        return [reading for reading in found if reading is not None]

    @cached_property
    def sharpness(self) -> Sharpness:
        """Steps within the likeliest part of the frame."""
        return sharpness_of(self.sample(None))

    @cached_property
    def likeness(self) -> float:
        """Correlation of the two layers' channels within the pad's part; 0 with one layer."""
        channels = [layer.channel for layer in self.frame.pad.layers]
        if len(channels) < 2:
            return 0.0
        first, second = (self.sample(channel) for channel in channels[:2])
        a, b = (plane - cv2.blur(plane, (31, 31)) for plane in (first, second))
        spread = float(a.std() * b.std())
        return float((a * b).mean()) / spread if spread >= 1.0 else 0.0

    def sample(self, channel: str | None) -> Plane:
        """The middle of the likeliest part of the frame, at its own scale, stretched."""
        box, side = self.frame.box, _SAMPLE // 2
        x, y = (box.x0 + box.x1) // 2, (box.y0 + box.y1) // 2
        part = Box(
            max(box.x0, x - side), max(box.y0, y - side),
            min(box.x1, x + side), min(box.y1, y + side),
        )  # fmt: skip
        layer = next(item for item in self.frame.pad.layers if channel in (None, item.channel))
        values = self.frame.pyramid.plane(layer.channel, 0, part).values
        low = self.frame.stretch.low[BGR_INDEX[layer.channel]]
        gain = self.frame.stretch.gain(layer.channel)
        return np.asarray((values - np.float32(low)) * np.float32(gain), np.float32)


def sharpness_of(plane: Plane) -> Sharpness:
    """How wide the steepest steps are, by direction.

    A blur by motion leaves steps along it as steep as they were and flattens all others; one of
    focus flattens all. The steepest slopes alone tell, however few they are, so that a pad of a few
    large cells is not taken for blurred.
    """
    smooth = cv2.GaussianBlur(plane, (0, 0), 0.8)
    gx = cv2.Sobel(smooth, cv2.CV_32F, 1, 0, ksize=3, scale=0.125)
    gy = cv2.Sobel(smooth, cv2.CV_32F, 0, 1, ksize=3, scale=0.125)
    low, high = np.percentile(cv2.GaussianBlur(plane, (0, 0), 1.5), (2, 98))
    contrast = float(high - low)
    slopes = []
    for angle in np.radians(_DIRECTIONS):
        slope = np.abs(gx * np.float32(math.cos(angle)) + gy * np.float32(math.sin(angle)))
        slopes.append(max(float(np.percentile(slope, _STEEPEST)), 1e-3))
    widths = max(contrast, 1.0) / np.array(slopes)
    flattest = int(np.argmax(widths))
    direction = (180 - int(_DIRECTIONS[flattest])) % 180
    return Sharpness(float(widths.min()), float(widths.max()), direction, contrast)


def _level(width: int) -> int:
    return max(0, round(math.log2(max(width / _MASK_WIDTH, 1))))


def _clearness(lattice: Lattice) -> tuple[bool, float]:
    """Clear lattices by their edges, others by the share of edges on their lines."""
    clear = lattice.inlier_share >= CLEAR_ORDER
    return clear, lattice.edge_count if clear else lattice.inlier_share


def _read(search: Search, lattice: Lattice) -> Reading | None:
    """The cells of a lattice in the layer that they fit best."""
    found = []
    for channel in search.channels:
        cells = read_lattice(search.pyramid, search.camera, lattice, channel)
        if cells is None:
            continue
        for _, index in search.at(channel):
            placed = index.locate(cells, 3 * search.attempts)
            if placed is not None:
                found.append(placed.evidence)
    if not found:
        return None
    evidence = min(found, key=lambda item: item.log10_false_alarm)
    edges_px = float(lattice.edge_count << lattice.families.edges.plane.level)
    judged = evidence.read, evidence.kappa, evidence.log10_false_alarm
    return Reading(lattice.inlier_share, edges_px, *judged)
