"""A frame on the workbench: decoded once, read again and again under other parameters.

A worker process keeps the last few frames with what their stages put out, so that a request costs
only what its parameters change. It holds no more than that: another worker, asked for the same,
answers the same, later.
"""

from __future__ import annotations

import json
from collections import OrderedDict
from dataclasses import dataclass, replace
from pathlib import Path

from padstudio.arrays import Image
from padstudio.errors import ImageError
from padstudio.flights.tasks.detectors import Recipe, detector_for, params_from
from padstudio.flights.tasks.frames import (
    BYTES_OF_TIMESTAMP,
    StillPart,
    VideoPart,
    read_still,
)
from padstudio.geometry.camera import Camera
from padstudio.media import images
from padstudio.pad.spec import Channel
from padstudio.vision.detector import Detector
from padstudio.vision.stage.detection import Detection
from padstudio.vision.stage.memo import Memo

# A frame of 4 megapixels and its stages take some 200 MB.
_FRAMES = 2
_READINGS = 3


@dataclass(frozen=True)
class Subject:
    """A frame that somebody looks at.

    Attributes
    ----------
    name : str
        The same of the same frame, everywhere.
    source : Path, VideoPart or StillPart
        A picture's file, or the frame's place in a flight; a video's last timestamp counts.
    max_pixels : int
    """

    name: str
    source: Path | VideoPart | StillPart
    max_pixels: int

    def read(self) -> Image:
        """Decode it.

        Raises
        ------
        ImageError
            If there is no picture.
        StudioError
            If its file cannot be read.
        """
        if isinstance(self.source, Path):
            return images.decode(self.source.read_bytes(), self.max_pixels)
        if isinstance(self.source, StillPart):
            return read_still(self.source, self.max_pixels)
        wanted = self.source.timestamps[-1]
        last = replace(self.source, pts=self.source.pts[-BYTES_OF_TIMESTAMP:])
        for picture in last.read(self.max_pixels):
            if picture.pts == wanted and picture.bgr is not None:
                return picture.bgr
        raise ImageError(
            "the decoder gives no picture for this frame: its data are missing or damaged",
            code="frame_lost",
        )


class Bench:
    """One frame and what was made of it.

    Parameters
    ----------
    image : (H, W, 3) uint8
        BGR.
    """

    def __init__(self, image: Image) -> None:
        self.image = image
        self._memo = Memo()
        self._read: OrderedDict[tuple[Recipe, Channel | None], Detection] = OrderedDict()

    def detect(self, recipe: Recipe, channel: Channel | None = None) -> Detection:
        """Read the frame as a still, with its trace.

        Parameters
        ----------
        recipe : Recipe
        channel : {"red", "green", "blue"} or None
            Whoever looks at one channel need not wait for the stages of the others that the result
            does not rest on.

        Raises
        ------
        SpecError
            If a parameter is wrong.
        CameraMismatchError
            If the frame's aspect is not the camera's.
        """
        key = (recipe, channel)
        if key not in self._read:
            self._memo.channel = channel
            found = detector_of(recipe).detect(self.image, trace=True, memo=self._memo)
            self._read[key] = found
            while len(self._read) > _READINGS:
                self._read.popitem(last=False)
        self._read.move_to_end(key)
        return self._read[key]

    def camera(self, recipe: Recipe) -> Camera:
        """The camera at the frame's size."""
        height, width = self.image.shape[:2]
        return detector_of(recipe).camera.for_frame(width, height)


def detector_of(recipe: Recipe) -> Detector:
    """The detector of a recipe; those that differ in parameters share what they know of pads."""
    params = params_from(json.loads(recipe.params))
    return detector_for(replace(recipe, params="{}")).with_params(params)


_benches: OrderedDict[str, Bench] = OrderedDict()


def bench_for(subject: Subject) -> Bench:
    """The bench with a frame on it; raises as `Subject.read`."""
    if subject.name not in _benches:
        _benches[subject.name] = Bench(subject.read())
        while len(_benches) > _FRAMES:
            _benches.popitem(last=False)
    _benches.move_to_end(subject.name)
    return _benches[subject.name]
