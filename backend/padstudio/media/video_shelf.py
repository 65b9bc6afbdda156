"""Decoded frames of a video on disk, bit by bit, so that any of them is there at once.

A frame far behind its keyframe takes seconds to decode. Of the lossless forms that FFmpeg writes
only raw planes cost less than the decoding itself: at 2720 x 1530 7 ms to write and 1.3 ms to read
a frame of 6 MB, against 23 and 15 ms for Ut Video (2.3 MB) and 66 and 62 ms for H.264 at
quantiser 0 (CPU time on a busy machine, whose decoding took 43 ms a frame).
"""

from __future__ import annotations

import contextlib
import json
import os
from collections.abc import Callable, Generator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from padstudio.arrays import Image, YuvFrame
from padstudio.media.video_frames import Keep, VideoPicture, to_frame

if TYPE_CHECKING:
    from av import VideoFrame

_LENGTH_BYTES = 4


class FrameShelf:
    """The folder of one video's frames, a file each, named after its timestamp.

    Parameters
    ----------
    folder : Path
        Made when the first frame is laid there.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._has_bgr: bool | None = None

    def path(self, pts: int) -> Path:
        """Where a frame lies, or would."""
        return self._folder / f"{pts}.raw"

    def missing(self, pts: Sequence[int]) -> list[int]:
        """Timestamps of which nothing is here."""
        try:
            names = set(os.listdir(self._folder))
        except OSError:
            names = set()
        return [value for value in pts if f"{value}.raw" not in names]

    def add(self, pts: int, frame: VideoFrame | None, is_damaged: bool) -> None:
        """Lay a frame here; None where the decoder gave nothing for it."""
        self._folder.mkdir(parents=True, exist_ok=True)
        path = self.path(pts)
        part = path.with_suffix(f".{os.getpid()}")
        part.write_bytes(b"" if frame is None else self._packed(frame, is_damaged))
        part.replace(path)

    def _packed(self, frame: VideoFrame, is_damaged: bool) -> bytes:
        about = _about(frame) | {"is_damaged": is_damaged, "has_bgr": False}
        planes = [bytes(plane) for plane in frame.planes]
        if self._has_bgr is None:
            # What places a frame's colours between its pixels cannot be set anew with PyAV.
            again = _rebuilt(about, b"".join(planes))
            self._has_bgr = not np.array_equal(_bgr(again), _bgr(frame))
        if self._has_bgr:
            about["has_bgr"] = True
            planes.append(_bgr(frame).tobytes())
        head = json.dumps(about).encode()
        return b"".join([len(head).to_bytes(_LENGTH_BYTES, "little"), head, *planes])

    def read(
        self, pts: Sequence[int], rotation_deg: int, max_pixels: int
    ) -> Generator[VideoPicture]:
        """As `padstudio.media.video_frames.read_frames`, of frames that are here.

        Raises
        ------
        FileNotFoundError
            If one is not, or not any more.
        """
        for value in pts:
            path = self.path(value)
            data = path.read_bytes()
            # Those looked at stay for longest.
            with contextlib.suppress(OSError):
                os.utime(path)
            if not data:
                yield VideoPicture(value, None)
                continue
            start = _LENGTH_BYTES + int.from_bytes(data[:_LENGTH_BYTES], "little")
            about = json.loads(data[_LENGTH_BYTES:start])
            picture = to_frame(_rebuilt(about, data[start:]), rotation_deg, max_pixels)
            if about["has_bgr"]:
                picture = _with_bgr(picture, about, data, rotation_deg)
            yield VideoPicture(value, picture, about["is_damaged"])


def shelve(
    shelf: FrameShelf, pts: Sequence[int], read: Callable[[Keep], Generator[VideoPicture]]
) -> Generator[int]:
    """Decode frames and lay those on a shelf that it lacks.

    Parameters
    ----------
    shelf : FrameShelf
    pts : sequence of int
    read : callable
        Reads these frames as `padstudio.media.video_frames.read_frames`, which also says what it
        raises; given what takes each.

    Yields
    ------
    int
        The timestamp of each frame, also of those that were there.
    """
    lacking = set(shelf.missing(pts))

    def keep(value: int, frame: VideoFrame | None, is_damaged: bool) -> None:
        if value in lacking:
            shelf.add(value, frame, is_damaged)

    with contextlib.closing(read(keep)) as pictures:
        for picture in pictures:
            yield picture.pts


def _about(frame: VideoFrame) -> dict[str, Any]:
    return {
        "width": frame.width,
        "height": frame.height,
        "format": frame.format.name,
        "colorspace": int(frame.colorspace),
        "color_range": int(frame.color_range),
        "lines": [plane.line_size for plane in frame.planes],
    }


def _bgr(frame: VideoFrame) -> Image:
    return np.asarray(frame.to_ndarray(format="bgr24"), np.uint8)


def _with_bgr(
    picture: Image | YuvFrame, about: dict[str, Any], data: bytes, rotation_deg: int
) -> Image | YuvFrame:
    """A picture with the colours that were laid beside its planes."""
    size = about["height"], about["width"], 3
    bgr = np.frombuffer(data[-int(np.prod(size)) :], np.uint8).reshape(size)
    if isinstance(picture, YuvFrame):
        return replace(picture, make_bgr=lambda: bgr)
    return np.ascontiguousarray(np.rot90(bgr, -rotation_deg // 90))


def _rebuilt(about: dict[str, Any], planes: bytes) -> VideoFrame:
    from av import VideoFrame

    frame = VideoFrame(about["width"], about["height"], about["format"])
    frame.colorspace, frame.color_range = about["colorspace"], about["color_range"]
    start = 0
    for plane, line in zip(frame.planes, about["lines"], strict=True):
        rows = np.frombuffer(planes, np.uint8, plane.height * line, start).reshape(-1, line)
        start += rows.size
        # Rows end in as much padding as a frame's memory happens to have.
        into = np.frombuffer(memoryview(plane), np.uint8).reshape(plane.height, plane.line_size)
        shared = min(line, plane.line_size)
        into[:, :shared] = rows[:, :shared]
    return frame
