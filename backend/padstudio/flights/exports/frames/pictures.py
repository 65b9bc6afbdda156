"""The pictures of records, of a server's flight and of files, and how large they are."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import cv2

from padstudio.arrays import Image
from padstudio.errors import StudioError
from padstudio.flights.results.frames import Results
from padstudio.flights.tasks.frames import BYTES_OF_TIMESTAMP, StillPart, VideoPart, read_still
from padstudio.flights.tasks.from_rows import numbers_of, still_part, video_part
from padstudio.store.database.flight_tables import FlightRow

Record = dict[str, Any]
#: Calls a function in a worker process and waits for it.
Run = Callable[..., Any]

# Enough that seeking costs little, few enough to hold.
_BLOCK_FRAMES = 48
# For people and feature finders, of frames that a camera has compressed before.
_JPEG_QUALITY = 90


def flight_frame_px(
    flight: FlightRow, run: Run, max_pixels: int
) -> Callable[[Record], tuple[int, int] | None]:
    """What gives the size of a flight's frames whose records do not say it.

    Parameters
    ----------
    flight : FlightRow
    run : callable
    max_pixels : int
    """

    def size_of(record: Record) -> tuple[int, int] | None:
        number = int(record["frame"])
        for source in flight.sources or ():
            if 0 <= number - source["first_frame"] < source["frames"] and "video" in source:
                width, height = source["video"]["width"], source["video"]["height"]
                return (height, width) if source["rotation_deg"] in (90, 270) else (width, height)
        try:
            found: tuple[int, int] = run(still_size, still_part(flight.sources, number), max_pixels)
        except StudioError:
            return None
        return found

    return size_of


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
    pictures = part.read(max_pixels)
    return [None if picture.bgr is None else to_jpeg(picture.bgr) for picture in pictures]


def to_jpeg(bgr: Image) -> bytes:
    """A picture as a JPEG file."""
    return bytes(cv2.imencode(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, _JPEG_QUALITY])[1])
