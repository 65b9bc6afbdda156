"""The channels of a picture in which a pad is printed: all that a calibration keeps of it."""

from __future__ import annotations

import cv2
import numpy as np

from padstudio.arrays import Image
from padstudio.pad.spec import Channel, Pad
from padstudio.vision.frame.prepare import prepare
from padstudio.vision.frame.pyramid import BGR_INDEX, NO_COLOURS, Pyramid, Window, halved
from padstudio.vision.stage.params import DetectorParams
from padstudio.vision.stage.trace import Recorder


class PadPlanes(Pyramid):
    """Halved copies of a picture's channels, of which the others are let go.

    Parameters
    ----------
    picture : (H, W, 3) uint8
        BGR.
    pad : Pad
    """

    def __init__(self, picture: Image, pad: Pad) -> None:
        super().__init__(None)
        whole = prepare(picture, pad, DetectorParams().prepare, Recorder(keep=False)).level(0)
        self._size = int(picture.shape[1]), int(picture.shape[0])
        self._planes: dict[Channel, list[Image]] = {
            layer.channel: [np.asarray(cv2.extractChannel(whole, BGR_INDEX[layer.channel]))]
            for layer in pad.layers
        }

    @property
    def width(self) -> int:
        """Width of the picture, pixels."""
        return self._size[0]

    @property
    def height(self) -> int:
        """Height of the picture, pixels."""
        return self._size[1]

    def window(self, channel: Channel, level: int) -> Window:
        """As of `Pyramid`; of the pad's channels only."""
        planes = self._planes[channel]
        while len(planes) <= level:
            planes.append(halved(planes[-1]))
        values = planes[level]
        return Window(values, NO_COLOURS, values.shape[1], 2.0**level)
