"""A video frame as its decoder leaves it: brightness, and colours at half its scale.

A frame that is followed needs two channels at the scale of its cells, and few of their pixels at
that. Making all of BGR first, and halving that, touches six times the bytes.
"""

from __future__ import annotations

import numpy as np

from padstudio.arrays import Image, Standard, YuvFrame
from padstudio.pad.spec import Channel
from padstudio.vision.frame import pixels_kernel
from padstudio.vision.frame.pyramid import NO_COLOURS, Pyramid, Window

#: Shares of red and blue in brightness.
_SHARES: dict[Standard, tuple[float, float]] = {"bt601": (0.299, 0.114), "bt709": (0.2126, 0.0722)}
_COLOURS: dict[Channel, str] = {"red": "v", "blue": "u"}


class YuvPyramid(Pyramid):
    """Halved copies of a frame in planes, each made where somebody asks for it.

    Red = Y + 2 (1 − K_red) V, and blue likewise with U (ITU-R BT.601, BT.709); those who read the
    pixels take the sum.

    Parameters
    ----------
    frame : YuvFrame
    """

    def __init__(self, frame: YuvFrame) -> None:
        super().__init__(None)
        self._frame = frame
        self._halves = {"y": [frame.y], "u": [frame.u], "v": [frame.v]}

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
            self._levels.append(np.ascontiguousarray(self._frame.bgr))
        return super().level(number)

    def window(self, channel: Channel, level: int) -> Window:
        """As of `Pyramid`."""
        if channel == "green":
            return super().window(channel, level)
        bright, colours = self._half("y", level), self._half(_COLOURS[channel], max(level - 1, 0))
        gain, black, weight = self._mixture(channel)
        return Window(
            values=bright,
            colours=colours,
            width=bright.shape[1] if level else self.width,
            pixel=2.0**level,
            gain=gain,
            black=black,
            weight=weight,
            scale=1.0 if level else 0.5,
            shift=0.0 if level else -0.25,
        )

    @property
    def brightness(self) -> Window:
        """As of `Pyramid`."""
        gain, black = self._frame.gain
        values = self._frame.y
        return Window(values, NO_COLOURS, self.width, 1.0, gain=gain, black=-gain * black)

    def _mixture(self, channel: Channel) -> tuple[float, float, float]:
        """Grey values of a channel per unit of brightness, at black, and per unit of its colour."""
        frame = self._frame
        gain, black = frame.gain
        share = _SHARES[frame.standard][0 if channel == "red" else 1]
        weight = 2 * (1 - share) * (1.0 if frame.full_range else 255 / 224)
        return gain, -gain * black - 128 * weight, weight

    def _half(self, name: str, times: int) -> Image:
        made = self._halves[name]
        # Halving streams through a plane, so that those who look here and there find it in the
        # cache; and what is halved once more is asked for later.
        while len(made) <= times + 1:
            first = self.width if name == "y" else -(-self.width // 2)
            width = first if len(made) == 1 else made[-1].shape[1]
            if min(len(made[-1]), width) < 2:
                break
            made.append(pixels_kernel.halved(made[-1], width))
        return made[times]
