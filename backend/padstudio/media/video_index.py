"""Where every frame of a video is, found from its packets without decoding them."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from padstudio.errors import LimitError
from padstudio.media.video import (
    MAX_PIXELS,
    VideoError,
    decode,
    main_stream,
    open_container,
)

if TYPE_CHECKING:
    from av.container import InputContainer
    from av.video.stream import VideoStream

#: Frames of one video, unless the caller sets another limit.
MAX_FRAMES = 2_000_000
# Intervals between frames that differ by more than this share are a variable rate.
_RATE_TOLERANCE = 0.02
# Containers round their length; less than this is no loss.
_SECONDS_TOLERANCE = 1.0
# Share of equal intervals from which longer ones are gaps rather than a variable rate.
_STEADY_SHARE = 0.9
# FFmpeg's AV_TIME_BASE.
_CONTAINER_UNITS = 1_000_000


@dataclass(frozen=True)
class VideoInfo:
    """What a video holds.

    Attributes
    ----------
    container, codec, pixel_format : str
        As FFmpeg names them: ``mov,mp4,m4a,3gp,3g2,mj2``, ``hevc``, ``yuv420p10le``.
    width, height : int
        Pixels, as stored: before `rotation_deg` is applied.
    rotation_deg : int
        By which a player turns the picture, clockwise: 0, 90, 180 or 270.
    frames : int
        Frames that the file still holds.
    frames_declared : int
        Frames that its header promises; 0 where it does not say.
    duration_s : float
        From the first frame to the end of the last.
    fps : float
        Frames a second, mean.
    variable_rate : bool
    damage : tuple of str
        A sentence for each loss that the container shows.
    """

    container: str
    codec: str
    pixel_format: str
    width: int
    height: int
    rotation_deg: int
    frames: int
    frames_declared: int
    duration_s: float
    fps: float
    variable_rate: bool
    damage: tuple[str, ...] = ()

    @property
    def shown_size(self) -> tuple[int, int]:
        """Width and height after rotation."""
        turned = self.rotation_deg in (90, 270)
        return (self.height, self.width) if turned else (self.width, self.height)


@dataclass(frozen=True, eq=False)
class VideoIndex:
    """Where every frame of a video is.

    Attributes
    ----------
    info : VideoInfo
    pts : (N,) int64
        Presentation timestamps in ascending order, units of `time_base`.
    keyframes : (K,) int64
        Frame numbers from which decoding can start, ascending; the first is 0.
    time_base : Fraction
        Seconds.
    is_counted : bool
        The file does not time each frame, as AVI with B-frames: the timestamps are the frames'
        numbers, and frames are found by counting from the start.
    """

    info: VideoInfo
    pts: NDArray[np.int64]
    keyframes: NDArray[np.int64]
    time_base: Fraction
    is_counted: bool = False

    def times_s(self) -> NDArray[np.float64]:
        """(N,) seconds since the first frame."""
        return np.asarray((self.pts - self.pts[0]) * float(self.time_base))


def read_index(
    source: str,
    *,
    max_pixels: int = MAX_PIXELS,
    max_frames: int = MAX_FRAMES,
    pause: Callable[[], object] = lambda: None,
) -> VideoIndex:
    """Find every frame of a video from its packets.

    Parameters
    ----------
    source : str
        A path or a URL that fsspec knows.
    max_pixels, max_frames : int
    pause : callable
        Called with every packet.

    Raises
    ------
    VideoError
        If the file is no video, holds no video stream, or no frame.
    LimitError
        If its frames are too large or too many.
    """
    with open_container(source, max_pixels) as container:
        stream = main_stream(container, max_pixels)
        packets = _Packets(container, stream, max_frames, pause)
        time_base = stream.time_base or Fraction(1, 1000)
        # AVI times packets in the order of decoding, which is not the frames' own.
        reordered = container.format.name == "avi" and stream.codec_context.has_b_frames
        is_counted = packets.is_untimed or bool(reordered)
        if is_counted:
            time_base = 1 / (stream.average_rate or Fraction(25))
            packets.pts = list(range(_count_frames(source, max_pixels, pause)))
            packets.is_key = [number == 0 for number in packets.pts]
        pts, keyframes = packets.ordered()
        info = _describe(container, stream, pts, time_base, packets.damage)
    return VideoIndex(info, pts, keyframes, time_base, is_counted)


def _describe(
    container: InputContainer,
    stream: VideoStream,
    pts: NDArray[np.int64],
    time_base: Fraction,
    damage: list[str],
) -> VideoInfo:
    intervals = np.diff(pts)
    usual = float(np.median(intervals)) if len(intervals) else 0.0
    duration_s = (float(pts[-1] - pts[0]) + usual) * float(time_base)
    # Others count what they call frames in units of time.
    declared = stream.frames if "mp4" in container.format.name else 0
    if declared > len(pts):
        damage = [*damage, f"{declared - len(pts)} of {declared} frames are missing"]
    damage = [*damage, *gaps(intervals, usual)]
    declared_s = _declared_s(container, stream, float(pts[0] * time_base) + duration_s)
    missing_s = declared_s - duration_s
    if missing_s > max(_SECONDS_TOLERANCE, _RATE_TOLERANCE * declared_s):
        damage = [*damage, f"{missing_s:.1f} s of {declared_s:.1f} s are missing"]
    context = stream.codec_context
    return VideoInfo(
        container=container.format.name,
        codec=context.name,
        pixel_format=context.pix_fmt or "",
        width=context.width,
        height=context.height,
        rotation_deg=_rotation_deg(container, stream),
        frames=len(pts),
        frames_declared=declared,
        duration_s=duration_s,
        fps=len(pts) / duration_s if duration_s > 0 else 0.0,
        variable_rate=varies(intervals, usual),
        damage=tuple(damage),
    )


def gaps(intervals: NDArray[np.int64], usual: float) -> list[str]:
    """Frames that a steady camera must have recorded, and that are not there."""
    steady = np.abs(intervals - usual) <= max(1.0, _RATE_TOLERANCE * usual)
    gaps = np.flatnonzero(intervals > 1.5 * usual)
    if not len(gaps) or steady.mean() < _STEADY_SHARE:
        return []
    missing = int(np.round(intervals[gaps] / usual - 1).sum())
    return [f"{missing} frames are missing between others, the first of them after frame {gaps[0]}"]


def _declared_s(container: InputContainer, stream: VideoStream, end_s: float) -> float:
    """The video's length by the file's header; 0 where that does not say.

    Parameters
    ----------
    container : InputContainer
    stream : VideoStream
    end_s : float
        Where the last frame ends, on the clock of the frames.
    """
    if stream.duration is not None and stream.time_base is not None:
        return float(stream.duration * stream.time_base)
    # Sound may go on for longer than the pictures.
    if container.duration is None or container.streams.audio:
        return 0.0
    declared_s = container.duration / _CONTAINER_UNITS
    # Writers of Matroska that let frames begin late count from 0, some from the first frame.
    if "matroska" in container.format.name and end_s <= declared_s + _SECONDS_TOLERANCE:
        declared_s -= (container.start_time or 0) / _CONTAINER_UNITS
    return declared_s


def _count_frames(source: str, max_pixels: int, pause: Callable[[], object]) -> int:
    count = 0
    with open_container(source, max_pixels) as container:
        for _ in decode(container, main_stream(container, max_pixels)):
            count += 1
            pause()
    return count


class _Packets:
    """Timestamps of a stream's frames, in decoding order."""

    def __init__(
        self,
        container: InputContainer,
        stream: VideoStream,
        max_frames: int,
        pause: Callable[[], object],
    ) -> None:
        self.pts: list[int | None] = []
        self.is_key: list[bool] = []
        self.damage: list[str] = []
        self._read(container, stream, max_frames, pause)
        if not self.pts:
            raise VideoError(
                "the video holds no frame; the recording was cut short before the first one",
                code="no_frames",
            )

    @property
    def is_untimed(self) -> bool:
        """True where the container does not time each frame on its own."""
        return None in self.pts or len(set(self.pts)) < len(self.pts)

    def _read(
        self,
        container: InputContainer,
        stream: VideoStream,
        max_frames: int,
        pause: Callable[[], object],
    ) -> None:
        import av

        corrupt = 0
        try:
            for packet in container.demux(stream):
                pause()
                # An edit list may hide frames that others need.
                if not packet.size or packet.is_discard:
                    continue
                if len(self.pts) >= max_frames:
                    raise LimitError(
                        f"the video has more than {max_frames} frames; cut it into parts",
                        code="too_many_frames",
                    )
                corrupt += packet.is_corrupt
                self.pts.append(packet.pts)
                self.is_key.append(packet.is_keyframe)
        except (av.error.FFmpegError, EOFError) as error:
            self.damage.append(f"the file breaks off after {len(self.pts)} frames ({error})")
        if corrupt:
            self.damage.append(f"{corrupt} packets are marked as damaged")

    def ordered(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Timestamps in ascending order, and which of them can be decoded from."""
        timed = [
            (pts, key) for pts, key in zip(self.pts, self.is_key, strict=True) if pts is not None
        ]
        if not timed:
            raise VideoError(
                "no frame of the video can be decoded; copy the file from the camera again",
                code="no_frames",
            )
        found = dict(timed)
        pts = np.array(sorted(found), np.int64)
        keyframes = np.array([i for i, value in enumerate(pts) if found[int(value)]], np.int64)
        # What comes before the first keyframe is reached from the file's start.
        return pts, np.union1d(keyframes, [0])


def varies(intervals: NDArray[np.int64], usual: float) -> bool:
    """True where intervals (N,) differ from their usual length."""
    if not len(intervals) or usual <= 0:
        return False
    # Coarse time bases round intervals to one unit.
    return bool(np.abs(intervals - usual).max() > max(1.0, _RATE_TOLERANCE * usual))


def _rotation_deg(container: InputContainer, stream: VideoStream) -> int:
    """The display matrix's turn, which PyAV gives counter-clockwise with the first frame."""
    import av

    with contextlib.suppress(av.error.FFmpegError):
        container.seek(0)
        for frame in decode(container, stream):
            return round(-frame.rotation / 90) * 90 % 360
    return 0
