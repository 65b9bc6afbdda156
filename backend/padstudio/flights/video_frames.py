"""Decodes chosen frames of a video, exactly, in order."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from padstudio.errors import LimitError
from padstudio.flights.video import MAX_PIXELS, main_stream, open_container

if TYPE_CHECKING:
    from av import VideoFrame
    from av.container import InputContainer
    from av.video.stream import VideoStream


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
        The decoder filled in for missing or wrong data.
    """

    pts: int
    bgr: NDArray[np.uint8] | None
    is_damaged: bool = False


def read_frames(
    source: str, pts: Sequence[int], *, rotation_deg: int = 0, max_pixels: int = MAX_PIXELS
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
    place = 0
    with open_container(source, max_pixels) as container:
        stream = main_stream(container, max_pixels)
        for frame in _decoded_from(container, stream, wanted[0]):
            if frame.pts is None:
                continue
            while place < len(wanted) and wanted[place] < frame.pts:
                yield VideoPicture(wanted[place], None)
                place += 1
            if place == len(wanted):
                return
            if wanted[place] == frame.pts:
                bgr = _to_bgr(frame, rotation_deg, max_pixels)
                yield VideoPicture(wanted[place], bgr, bool(frame.is_corrupt))
                place += 1
                if place == len(wanted):
                    return
    for missing in wanted[place:]:
        yield VideoPicture(missing, None)


def _decoded_from(container: InputContainer, stream: VideoStream, pts: int) -> Iterator[VideoFrame]:
    """Frames in order of presentation, from the keyframe before a timestamp on."""
    import av

    try:
        container.seek(pts, stream=stream, backward=True)
    except av.error.FFmpegError:
        # Files without an index are read from their start.
        container.seek(0)
    packets = container.demux(stream)
    while True:
        try:
            packet = next(packets, None)
            if packet is None:
                return
            frames = packet.decode()
        except av.error.InvalidDataError:
            continue
        except (av.error.FFmpegError, EOFError):
            return
        yield from frames


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
