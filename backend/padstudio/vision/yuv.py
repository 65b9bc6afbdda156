"""A video frame as its decoder leaves it: brightness, and colours at half its scale.

A frame that is followed needs two channels at the scale of its cells, and few of their pixels at
that. Making all of BGR first, and halving that, touches six times the bytes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import cv2
import numpy as np

from padstudio.pad.spec import Channel
from padstudio.vision.planes import Plane, Pyramid, halved
from padstudio.vision.types import Image

Standard = Literal["bt601", "bt709"]

#: Shares of red and blue in brightness.
_SHARES: dict[Standard, tuple[float, float]] = {"bt601": (0.299, 0.114), "bt709": (0.2126, 0.0722)}


@dataclass(frozen=True, eq=False)
class YuvFrame:
    """A frame in planes, 4:2:0.

    Attributes
    ----------
    y : (H, W) uint8
    u, v : (H/2, W/2) uint8
        Half of an odd side is rounded up.
    standard : {"bt601", "bt709"}
    full_range : bool
        Brightness is 0 … 255 rather than 16 … 235.
    make_bgr : callable
        Gives the frame as (H, W, 3) uint8, BGR.
    """

    y: Image
    u: Image
    v: Image
    standard: Standard
    full_range: bool
    make_bgr: Callable[[], Image]

    @property
    def shape(self) -> tuple[int, int, int]:
        """Of `bgr`."""
        return int(self.y.shape[0]), int(self.y.shape[1]), 3

    @cached_property
    def bgr(self) -> Image:
        """(H, W, 3) uint8."""
        return self.make_bgr()

    @property
    def gain(self) -> tuple[float, float]:
        """Grey values per unit of brightness, and the brightness of black."""
        return (1.0, 0.0) if self.full_range else (255 / 219, 16.0)

    def grey(self, y0: int, x0: int, size: int) -> Image:
        """Brightness of a square of the frame, 0 … 255, (size, size) uint8."""
        scale, black = self.gain
        part = self.y[y0 : y0 + size, x0 : x0 + size]
        return np.asarray(cv2.addWeighted(part, scale, part, 0, -scale * black), np.uint8)


class YuvPyramid(Pyramid):
    """Halved copies of a frame in planes, each channel made where somebody asks for it.

    Parameters
    ----------
    frame : YuvFrame
    """

    def __init__(self, frame: YuvFrame) -> None:
        super().__init__(None)
        self._frame = frame
        self._halves: dict[str, list[Image]] = {"y": [frame.y]}
        self._made: dict[tuple[Channel, int], Plane] = {}

    @property
    def width(self) -> int:
        """Width of the frame, pixels."""
        return self._frame.shape[1]

    @property
    def height(self) -> int:
        """Height of the frame, pixels."""
        return self._frame.shape[0]

    def level(self, number: int) -> Image:
        """As of `Pyramid`, from all colours."""
        if not self._levels:
            self._levels.append(self._frame.bgr)
        return super().level(number)

    def window(self, channel: Channel, level: int) -> Plane:
        """As of `Pyramid`."""
        # Colours must be doubled for the frame's own scale: the decoder's library does it faster.
        if level == 0 or channel == "green":
            return super().window(channel, level)
        if (channel, level) not in self._made:
            self._made[channel, level] = Plane(self._channel(channel, level), channel, level, 0, 0)
        return self._made[channel, level]

    def _channel(self, channel: Channel, level: int) -> Image:
        """Red = Y + 2 (1 − K_red) V, and blue likewise with U (ITU-R BT.601, BT.709)."""
        frame = self._frame
        share = _SHARES[frame.standard][0 if channel == "red" else 1]
        colour = "v" if channel == "red" else "u"
        scale, black = frame.gain
        weight = 2 * (1 - share) * (1.0 if frame.full_range else 255 / 224)
        bright = self._half("y", level)
        if colour not in self._halves:
            # Colours come at half scale, an odd side rounded up where this pyramid rounds down.
            plane = frame.v if channel == "red" else frame.u
            first = self._half("y", 1).shape
            self._halves[colour] = [plane[: first[0], : first[1]]]
        shown = cv2.addWeighted(
            bright, scale, self._half(colour, level - 1), weight, -scale * black - 128 * weight
        )
        return np.asarray(shown, np.uint8)

    def _half(self, name: str, times: int) -> Image:
        made = self._halves[name]
        while len(made) <= times:
            made.append(halved(made[-1]))
        return made[times]
