"""Decodes chosen frames of a video, exactly, in order."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from padstudio.errors import LimitError
from padstudio.flights.video import MAX_PIXELS, decode, main_stream, open_container

if TYPE_CHECKING:
    from av import VideoFrame
    from av.container import InputContainer
    from av.video.stream import VideoStream

# More than most cameras leave between keyframes.
_STEP_BACK_S = 10.0


@dataclass(frozen=True, eq=False)
class VideoPicture:
    """One frame asked for.

    Attributes
    ----------
    pts : int
        Its presentation timestamp.
    bgr : (H, W, 3) uint8 or None
        None where the decoder gave nothing for it.
    is_damaged : bool
        The decoder filled in for missing or wrong data, here or in a frame since the last keyframe,
        on which this one rests.
    """

    pts: int
    bgr: NDArray[np.uint8] | None
    is_damaged: bool = False


def read_frames(
    source: str,
    pts: Sequence[int],
    *,
    rotation_deg: int = 0,
    is_counted: bool = False,
    max_pixels: int = MAX_PIXELS,
) -> Iterator[VideoPicture]:
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
            yield VideoPicture(wanted[place], None)
            place, is_damaged = place + 1, is_damaged or not frame.key_frame
        if place < len(wanted) and wanted[place] == at:
            bgr = _to_bgr(frame, rotation_deg, max_pixels)
            yield VideoPicture(at, bgr, is_damaged)
            place += 1
        if place == len(wanted):
            return
    for missing in wanted[place:]:
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


def _to_bgr(frame: VideoFrame, rotation_deg: int, max_pixels: int) -> NDArray[np.uint8]:
    # A stream may change its size on the way.
    if frame.width * frame.height > max_pixels:
        raise LimitError(
            f"a frame is {frame.width} x {frame.height}, more than {max_pixels / 1e6:g} megapixels",
            code="too_many_pixels",
        )
    bgr = np.asarray(frame.to_ndarray(format="bgr24"), np.uint8)
    if rotation_deg:
        bgr = np.ascontiguousarray(np.rot90(bgr, -rotation_deg // 90))
    return bgr
