"""Decodes chosen frames of a video, exactly, in order."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from padstudio.arrays import Image, Standard, YuvFrame
from padstudio.errors import LimitError
from padstudio.media.video import MAX_PIXELS, decode, main_stream, open_container

if TYPE_CHECKING:
    from av import VideoFrame
    from av.container import InputContainer
    from av.video.stream import VideoStream

# More than most cameras leave between keyframes.
_STEP_BACK_S = 10.0
# FFmpeg's numbers: BT.709; unspecified, BT.470BG and SMPTE 170M are read as BT.601.
_STANDARDS: dict[int, Standard] = {1: "bt709", 2: "bt601", 5: "bt601", 6: "bt601"}
_PLANAR = ("yuv420p", "yuvj420p")
#: Takes a decoded frame, or None for one that was lost: timestamp, frame, whether it is damaged.
Keep: TypeAlias = "Callable[[int, VideoFrame | None, bool], None]"
_FULL_RANGE = 2


@dataclass(frozen=True, eq=False)
class VideoPicture:
    """One frame asked for.

    Attributes
    ----------
    pts : int
        Its presentation timestamp.
    frame : (H, W, 3) uint8, BGR, or YuvFrame, or None
        None where the decoder gave nothing for it.
    is_damaged : bool
        The decoder filled in for missing or wrong data, here or in a frame since the last keyframe,
        on which this one rests.
    """

    pts: int
    frame: Image | YuvFrame | None
    is_damaged: bool = False

    @property
    def bgr(self) -> Image | None:
        """The picture as (H, W, 3) uint8."""
        return self.frame.bgr if isinstance(self.frame, YuvFrame) else self.frame


def read_frames(
    source: str,
    pts: Sequence[int],
    *,
    rotation_deg: int = 0,
    is_counted: bool = False,
    max_pixels: int = MAX_PIXELS,
    keep: Keep | None = None,
) -> Generator[VideoPicture]:
    """Decode frames of a video by their timestamps.

    Decoding starts at the keyframe at or before the first of them, so that frames are the same to
    the bit as in a linear decode of the file.

    Parameters
    ----------
    source : str
        A path or a URL that fsspec knows.
    pts : sequence of int
        Presentation timestamps of the stream, ascending, as in `VideoIndex.pts`.
    rotation_deg : {0, 90, 180, 270}
        Turn the pictures clockwise.
    is_counted : bool
        As of `VideoIndex`.
    max_pixels : int
    keep : callable or None
        Takes each frame as it was decoded, with its timestamp and whether it is damaged; pictures
        are not made then.

    Yields
    ------
    VideoPicture
        One for each timestamp.

    Raises
    ------
    VideoError, LimitError, StorageError
        If the file cannot be opened, or a frame is beyond the limit.
    """
    wanted = [int(value) for value in pts]
    if not wanted:
        return
    place, is_damaged = 0, False
    numbered = _counted if is_counted else _timed
    for at, frame in numbered(source, wanted[0], max_pixels):
        is_damaged = bool(frame.is_corrupt or (is_damaged and not frame.key_frame))
        while place < len(wanted) and wanted[place] < at:
            if keep is not None:
                keep(wanted[place], None, is_damaged)
            yield VideoPicture(wanted[place], None)
            place, is_damaged = place + 1, is_damaged or not frame.key_frame
        if place < len(wanted) and wanted[place] == at:
            picture = None
            if keep is not None:
                keep(at, frame, is_damaged)
            else:
                picture = to_frame(frame, rotation_deg, max_pixels)
            yield VideoPicture(at, picture, is_damaged)
            place += 1
        if place == len(wanted):
            return
    for missing in wanted[place:]:
        if keep is not None:
            keep(missing, None, is_damaged)
        yield VideoPicture(missing, None)


def _counted(source: str, first: int, max_pixels: int) -> Iterator[tuple[int, VideoFrame]]:
    """Frames with their numbers, from the start."""
    with open_container(source, max_pixels) as container:
        stream = main_stream(container, max_pixels)
        yield from enumerate(decode(container, stream))


def _timed(source: str, first: int, max_pixels: int) -> Iterator[tuple[int, VideoFrame]]:
    """Frames with their timestamps, from the keyframe before the first one asked for."""
    # Where the index is coarse or missing, a seek may come down behind the frame.
    for back_s in (0.0, _STEP_BACK_S, None):
        with open_container(source, max_pixels) as container:
            stream = main_stream(container, max_pixels)
            if back_s is not None:
                _seek(container, stream, first, back_s)
            frames = ((f.pts, f) for f in decode(container, stream) if f.pts is not None)
            start = next(frames, None)
            if start is None or (start[0] > first and back_s is not None):
                continue
            yield start
            yield from frames
            return


def _seek(container: InputContainer, stream: VideoStream, pts: int, back_s: float) -> None:
    import av

    back = round(back_s / (stream.time_base or 1))
    # A file without an index stays at its start.
    with contextlib.suppress(av.error.FFmpegError):
        container.seek(pts - back, stream=stream, backward=True)


def to_frame(frame: VideoFrame, rotation_deg: int, max_pixels: int) -> Image | YuvFrame:
    """A decoded frame in planes where they are of a known kind, else as BGR, turned clockwise.

    Raises
    ------
    LimitError
        If it has too many pixels.
    """
    # A stream may change its size on the way.
    if frame.width * frame.height > max_pixels:
        raise LimitError(
            f"a frame is {frame.width} x {frame.height}, more than {max_pixels / 1e6:g} megapixels",
            code="too_many_pixels",
        )

    def to_bgr() -> Image:
        return np.asarray(frame.to_ndarray(format="bgr24"), np.uint8)

    if rotation_deg:
        return np.ascontiguousarray(np.rot90(to_bgr(), -rotation_deg // 90))
    standard = _STANDARDS.get(int(frame.colorspace))
    if frame.format.name not in _PLANAR or standard is None:
        return to_bgr()
    y, u, v = (_rows(plane) for plane in frame.planes)
    full_range = frame.format.name == "yuvj420p" or int(frame.color_range) == _FULL_RANGE
    return YuvFrame(y, u, v, frame.width, standard, full_range, to_bgr)


def _rows(plane: Any) -> Image:
    """A plane as it lies in the decoder's memory, which it keeps from being used again."""
    return np.frombuffer(plane, np.uint8).reshape(plane.height, plane.line_size)
