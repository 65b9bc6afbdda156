"""A frame at halved scales, and windows of one channel of it.

Working at the scale that the cells need is what keeps the detector fast: a level is made when
first asked for, and only from the level below it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array, Image
from padstudio.pad.spec import Channel

#: Where a channel lies in OpenCV's pixel order.
BGR_INDEX: dict[Channel, int] = {"blue": 0, "green": 1, "red": 2}


@dataclass(frozen=True)
class Box:
    """A rectangle of frame pixels: x0 ≤ x < x1, y0 ≤ y < y1."""

    x0: int
    y0: int
    x1: int
    y1: int

    @property
    def side(self) -> int:
        """The longer side, pixels."""
        return max(self.x1 - self.x0, self.y1 - self.y0)


@dataclass(frozen=True, eq=False)
class Plane:
    """One channel of a part of a frame at one scale.

    Attributes
    ----------
    values : (h, w) float32 or uint8
    channel : {"red", "green", "blue"}
    level : int
        Each level halves the frame; 0 is the frame's own scale.
    x0, y0 : int
        Where the part begins, pixels of that level.
    """

    values: NDArray[Any]
    channel: Channel
    level: int
    x0: int
    y0: int

    @property
    def pixel(self) -> int:
        """Side of this plane's pixels in frame pixels."""
        return 1 << self.level

    @property
    def _corner(self) -> Array:
        return np.array([self.x0 + 0.5, self.y0 + 0.5])

    def to_frame(self, xy: Array) -> Array:
        """Frame pixels of plane pixels, (N, 2) float64 each; (0, 0) is a pixel's centre."""
        return (xy + self._corner) * float(self.pixel) - 0.5

    def from_frame(self, xy: Array) -> Array:
        """Plane pixels of frame pixels, (N, 2) float64 each."""
        return (xy + 0.5) / float(self.pixel) - self._corner


class Window(NamedTuple):
    """One channel of a whole frame at one scale as it lies in memory, for compiled loops.

    The grey value of column c and row r is ``gain · values[r, first + step · c] + black``, and
    where there are colours, which may lie at half the scale, ``weight`` times theirs at column
    ``scale · c + shift`` and row ``scale · r + shift`` besides.

    Attributes
    ----------
    values : (h, n) uint8
        C-contiguous, whatever the channel, so that one compiled form of a loop serves all. Rows may
        hold more than the picture, of which nothing must be read.
    colours : (k, m) uint8
        Likewise, of ``scale`` times as many rows and columns, half of an odd number rounded up;
        empty where there are none.
    width : int
        Columns of the picture.
    pixel : float
        Side of a column in frame pixels.
    step, first : int
    gain, black, weight, scale, shift : float
    """

    values: Image
    colours: Image
    width: int
    pixel: float
    step: int = 1
    first: int = 0
    gain: float = 1.0
    black: float = 0.0
    weight: float = 0.0
    scale: float = 1.0
    shift: float = 0.0

    def to_frame(self, xy: Array) -> Array:
        """Frame pixels (N, 2) of columns and rows (N, 2)."""
        return (xy + 0.5) * self.pixel - 0.5

    def from_frame(self, xy: Array) -> Array:
        """Columns and rows (N, 2) of frame pixels (N, 2)."""
        return (xy + 0.5) / self.pixel - 0.5


NO_COLOURS: Image = np.empty((0, 0), np.uint8)


class Pyramid:
    """A frame and its halved copies.

    Parameters
    ----------
    bgr : (H, W, 3) uint8 or None
        None where a subclass makes it.
    """

    def __init__(self, bgr: Image | None) -> None:
        self._levels: list[Image] = [] if bgr is None else [np.ascontiguousarray(bgr)]

    @property
    def width(self) -> int:
        """Width of the frame, pixels."""
        return int(self._levels[0].shape[1])

    @property
    def height(self) -> int:
        """Height of the frame, pixels."""
        return int(self._levels[0].shape[0])

    @property
    def box(self) -> Box:
        """The whole frame."""
        return Box(0, 0, self.width, self.height)

    def level(self, number: int) -> Image:
        """The frame halved ``number`` times by area averaging, (h, w, 3) uint8."""
        while len(self._levels) <= number:
            self._levels.append(halved(self._levels[-1]))
        return self._levels[number]

    def plane(self, channel: Channel, level: int, box: Box | None = None) -> Plane:
        """One channel of a part of the frame at one scale, (h, w) float32."""
        part, x0, y0 = self._part(level, box or self.box)
        values = cv2.extractChannel(part, BGR_INDEX[channel]).astype(np.float32)
        return Plane(values, channel, level, x0, y0)

    def window(self, channel: Channel, level: int) -> Window:
        """One channel of the whole frame at one scale.

        Costs nothing but the scale, so it is for those who look at few of the pixels.
        """
        image = self.level(level)
        height, width = image.shape[:2]
        rows = image.reshape(height, 3 * width)
        return Window(rows, NO_COLOURS, width, 2.0**level, 3, BGR_INDEX[channel])

    @property
    def brightness(self) -> Window:
        """Brightness at the frame's own scale, or the channel that is nearest to it."""
        return self.window("green", 0)

    def _part(self, level: int, box: Box) -> tuple[Image, int, int]:
        x0, y0 = box.x0 >> level, box.y0 >> level
        x1, y1 = -(-box.x1 >> level), -(-box.y1 >> level)
        return self.level(level)[y0:y1, x0:x1], x0, y0


def halved(image: Image) -> Image:
    """A picture of half the size by area averaging, (h // 2, w // 2[, C]) uint8."""
    # An odd last row or column is left out, unless it is all there is.
    even = image[: max(image.shape[0] & ~1, 1), : max(image.shape[1] & ~1, 1)]
    size = (max(even.shape[1] // 2, 1), max(even.shape[0] // 2, 1))
    return np.asarray(cv2.resize(even, size, interpolation=cv2.INTER_AREA))
