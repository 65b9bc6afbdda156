"""What an export needs beside records: the camera in the frames' size, and the pictures."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import cv2

from padstudio.arrays import Image
from padstudio.errors import StudioError
from padstudio.flights.exports.options import Record
from padstudio.flights.results.frames import Results
from padstudio.flights.tasks.frames import BYTES_OF_TIMESTAMP, StillPart, VideoPart, read_still
from padstudio.flights.tasks.from_rows import numbers_of, still_part, video_part
from padstudio.geometry.camera import Camera
from padstudio.media import images
from padstudio.media.video_frames import read_frames
from padstudio.media.video_index import read_index
from padstudio.store.database.flight_tables import FlightRow

#: Calls a function in a worker process and waits for it.
Run = Callable[..., Any]

# Enough that seeking costs little, few enough to hold.
_BLOCK_FRAMES = 48
# For people and feature finders, of frames that a camera has compressed before.
_JPEG_QUALITY = 90


def frame_camera(flight: FlightRow, run: Run, max_pixels: int) -> Camera:
    """The camera in the size of a flight's frames; of stills, in that of the first.

    Parameters
    ----------
    flight : FlightRow
        With its camera.
    run : callable
    max_pixels : int
    """
    camera = Camera.loads(flight.camera)
    if not flight.sources:
        return camera
    first = flight.sources[0]
    try:
        if "video" in first:
            width, height = first["video"]["width"], first["video"]["height"]
            turned = first["rotation_deg"] in (90, 270)
            return camera.for_frame(*((height, width) if turned else (width, height)))
        part = still_part(flight.sources, first["first_frame"])
        return camera.for_frame(*run(still_size, part, max_pixels))
    except StudioError:
        # No such frame has a pose then, so nothing is placed in a picture of the wrong size.
        return camera


class FlightPictures:
    """The frames of a flight as JPEG files, for records in the order of their numbers.

    Parameters
    ----------
    flight : FlightRow
    results : Results
    run : callable
        Frames are decoded in worker processes.
    max_pixels : int
    """

    def __init__(self, flight: FlightRow, results: Results, run: Run, max_pixels: int) -> None:
        self._flight, self._results, self._run = flight, results, run
        self._max_pixels = max_pixels
        self._held: dict[int, bytes | None] = {}

    def __call__(self, record: Record) -> bytes | None:
        number = int(record["frame"])
        if number not in self._held:
            try:
                self._held = self._fetch(number)
            except StudioError:
                # A frame that cannot be read has a record and no picture.
                self._held = {number: None}
        return self._held[number]

    def _fetch(self, number: int) -> dict[int, bytes | None]:
        chunk = self._results.chunk_of(self._flight, number)
        if not chunk.pts:
            part: StillPart | VideoPart = still_part(self._flight.sources, number)
            return {number: self._run(jpegs, part, self._max_pixels)[0]}
        numbers = numbers_of(self._flight, chunk)
        place = numbers.index(number)
        start = place * BYTES_OF_TIMESTAMP
        pts = chunk.pts[start : start + _BLOCK_FRAMES * BYTES_OF_TIMESTAMP]
        part = video_part(self._flight.sources[chunk.source], pts)
        found = self._run(jpegs, part, self._max_pixels)
        return dict(zip(numbers[place:], found, strict=False))


def still_size(part: StillPart, max_pixels: int) -> tuple[int, int]:
    """Width and height of a still; raises as `padstudio.flights.tasks.frames.read_still`."""
    height, width = read_still(part, max_pixels).shape[:2]
    return width, height


def jpegs(part: StillPart | VideoPart, max_pixels: int) -> list[bytes | None]:
    """Frames as JPEG files; None for each that the decoder does not give.

    Raises
    ------
    StudioError
        If their file cannot be read.
    """
    if isinstance(part, StillPart):
        return [to_jpeg(read_still(part, max_pixels))]
    pictures = read_frames(
        part.url, part.timestamps, rotation_deg=part.rotation_deg, max_pixels=max_pixels
    )
    return [None if picture.bgr is None else to_jpeg(picture.bgr) for picture in pictures]


def to_jpeg(bgr: Image) -> bytes:
    """A picture as a JPEG file."""
    return bytes(cv2.imencode(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, _JPEG_QUALITY])[1])


class FilePictures:
    """Frames as JPEG files, for records of a poses file in its order.

    Parameters
    ----------
    folder : Path
        To which sources are relative.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._video: tuple[str, Iterator[tuple[int, bytes | None]]] | None = None

    def __call__(self, record: Record) -> bytes | None:
        source, frame = record["source"], record["frame"]
        try:
            if record.get("time_s") is None:
                return to_jpeg(images.read(self._folder / source))
            if self._video is None or self._video[0] != source:
                self._video = source, _frames(self._folder / source)
            # Videos are decoded once, forward; frames that were left out are passed over.
            found = (data for number, data in self._video[1] if number >= frame)
            return next(found, None)
        except StudioError:
            return None


def _frames(path: Path) -> Iterator[tuple[int, bytes | None]]:
    index = read_index(str(path))
    for number, picture in enumerate(read_frames(str(path), index.pts.tolist())):
        yield number, None if picture.bgr is None else to_jpeg(picture.bgr)
