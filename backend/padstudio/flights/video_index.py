"""Where every frame of a video is, found from its packets without decoding them."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from padstudio.errors import LimitError
from padstudio.flights.video import MAX_PIXELS, VideoError, main_stream, open_container

if TYPE_CHECKING:
    from av.container import InputContainer
    from av.video.stream import VideoStream

#: Frames of one video, unless the caller sets another limit.
MAX_FRAMES = 2_000_000
# Intervals between frames that differ by more than this share are a variable rate.
_RATE_TOLERANCE = 0.02


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
    """

    info: VideoInfo
    pts: NDArray[np.int64]
    keyframes: NDArray[np.int64]
    time_base: Fraction

    def times_s(self) -> NDArray[np.float64]:
        """(N,) seconds since the first frame."""
        return np.asarray((self.pts - self.pts[0]) * float(self.time_base))


def read_index(
    source: str, *, max_pixels: int = MAX_PIXELS, max_frames: int = MAX_FRAMES
) -> VideoIndex:
    """Find every frame of a video from its packets.

    Parameters
    ----------
    source : str
        A path or a URL that fsspec knows.
    max_pixels, max_frames : int

    Raises
    ------
    VideoError
        If the file is no video, holds no video stream, or no frame.
    LimitError
        If its frames are too large or too many.
    """
    with open_container(source, max_pixels) as container:
        stream = main_stream(container, max_pixels)
        packets = _Packets(container, stream, max_frames)
        rotation = _rotation_deg(container, stream)
        declared = stream.frames
        time_base = stream.time_base or Fraction(1, 1000)
        if packets.has_gaps:
            packets.from_decoder(source, max_pixels)
        pts, keyframes = packets.ordered()
        damage = list(packets.damage)
        if declared > len(pts):
            damage.append(f"{declared - len(pts)} of {declared} frames are missing")
        intervals = np.diff(pts)
        usual = float(np.median(intervals)) if len(intervals) else 0.0
        duration = (float(pts[-1] - pts[0]) + usual) * float(time_base)
        context = stream.codec_context
        info = VideoInfo(
            container=container.format.name,
            codec=context.name,
            pixel_format=context.pix_fmt or "",
            width=context.width,
            height=context.height,
            rotation_deg=rotation,
            frames=len(pts),
            frames_declared=declared,
            duration_s=duration,
            fps=len(pts) / duration if duration > 0 else 0.0,
            variable_rate=_varies(intervals, usual),
            damage=tuple(damage),
        )
    return VideoIndex(info, pts, keyframes, time_base)


class _Packets:
    """Timestamps of a stream's frames, in decoding order."""

    def __init__(self, container: InputContainer, stream: VideoStream, max_frames: int) -> None:
        self.pts: list[int | None] = []
        self.is_key: list[bool] = []
        self.damage: list[str] = []
        self._read(container, stream, max_frames)
        if not self.pts:
            raise VideoError(
                "the video holds no frame; the recording was cut short before the first one",
                code="no_frames",
            )

    @property
    def has_gaps(self) -> bool:
        """True where the container does not time each frame on its own, as AVI."""
        return None in self.pts or len(set(self.pts)) < len(self.pts)

    def _read(self, container: InputContainer, stream: VideoStream, max_frames: int) -> None:
        import av

        corrupt = 0
        try:
            for packet in container.demux(stream):
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

    def from_decoder(self, source: str, max_pixels: int) -> None:
        """Take the timestamps from the decoded frames instead."""
        import av

        self.pts, self.is_key = [], []
        with open_container(source, max_pixels) as container:
            stream = main_stream(container, max_pixels)
            for packet in container.demux(stream):
                with contextlib.suppress(av.error.FFmpegError):
                    for frame in packet.decode():
                        self.pts.append(frame.pts)
                        self.is_key.append(bool(frame.key_frame))

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


def _varies(intervals: NDArray[np.int64], usual: float) -> bool:
    if not len(intervals) or usual <= 0:
        return False
    # Coarse time bases round intervals to one unit.
    return bool(np.abs(intervals - usual).max() > max(1.0, _RATE_TOLERANCE * usual))


def _rotation_deg(container: InputContainer, stream: VideoStream) -> int:
    """The display matrix's turn, which PyAV gives counter-clockwise with the first frame."""
    import av

    with contextlib.suppress(av.error.FFmpegError):
        container.seek(0)
        for packet in container.demux(stream):
            with contextlib.suppress(av.error.InvalidDataError):
                for frame in packet.decode():
                    return round(-frame.rotation / 90) * 90 % 360
    return 0
