"""Where every frame of a recording's topic is, and when it was taken."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from padstudio.errors import ImageError, LimitError
from padstudio.media.images import MAX_PIXELS
from padstudio.media.recordings.folders import open_recording
from padstudio.media.recordings.messages import (
    MessageError,
    RecordedPicture,
    picture_kind,
    read_message,
    read_picture,
)
from padstudio.media.recordings.pictures import check_format, size_of
from padstudio.media.recordings.storage import Channel, RecordingError, Storage
from padstudio.media.recordings.times import Clock, TopicTimes
from padstudio.media.recordings.topics import calibration_channels, lens_of, picture_channels
from padstudio.media.video_index import MAX_FRAMES, VideoIndex, VideoInfo, gaps, varies
from padstudio.media.video_packets import codec_of, decode_packets, is_keyframe

# Sentences on losses of one kind that are told one by one.
_TOLD = 3


@dataclass(frozen=True, eq=False)
class RecordingIndex:
    """The frames of a topic as those of a video.

    Attributes
    ----------
    video : VideoIndex
        Timestamps are ns of Unix time.
    times : TopicTimes
    """

    video: VideoIndex
    times: TopicTimes


def read_index(
    source: str,
    topic: str | None = None,
    *,
    max_pixels: int = MAX_PIXELS,
    max_frames: int = MAX_FRAMES,
    pause: Callable[[], object] = lambda: None,
) -> RecordingIndex:
    """Find every frame of a topic.

    Frames have the times of their headers where each has one that is later than the one before;
    where one is zero or goes back, all have the times at which the recorder took them, and
    `VideoInfo.damage` says so.

    Parameters
    ----------
    source : str
        As of `padstudio.media.recordings.folders.open_recording`.
    topic : str or None
        None where only one has pictures.
    max_pixels, max_frames : int
    pause : callable
        Called with every message.

    Raises
    ------
    RecordingError
        If there is no such topic, none of its pictures can be read, or they are in a form that is
        not read, by its name.
    LimitError
        If pictures are too large or too many, or a message is.
    """
    storage = open_recording(source)
    channels = picture_channels(storage, topic)
    scan = _Scan(storage, channels, max_pixels, max_frames, pause)
    pts, times, notes = _timed(scan, channels[0].topic)
    info = _describe(storage, scan, pts, notes, _first_size(scan, max_pixels))
    keyframes = np.flatnonzero(scan.is_key).astype(np.int64)
    # What comes before the first keyframe is read from the start.
    keyframes = np.union1d(keyframes, [0])
    return RecordingIndex(VideoIndex(info, pts, keyframes, Fraction(1, 10**9)), times)


class _Scan:
    """All messages of a topic, gone through once."""

    def __init__(
        self,
        storage: Storage,
        channels: list[Channel],
        max_pixels: int,
        max_frames: int,
        pause: Callable[[], object],
    ) -> None:
        self._max_pixels, self._max_frames = max_pixels, max_frames
        self.kind = picture_kind(channels[0])
        self.log_ns: list[int] = []
        self.stamps_ns: list[int] = []
        self.is_key: list[bool] = []
        self.first: RecordedPicture | None = None
        self.size: tuple[int, int] | None = None
        self.fault = ""
        self._has_key = False
        self.damage = list(storage.damage)
        self.unread = 0
        self.declared = _declared(channels)
        lenses: set[tuple[Any, ...]] = set()
        told: list[str] = []
        beside = calibration_channels(storage, channels[0].topic)
        every = {channel.id: channel for channel in (*channels, *beside)}
        mine = {channel.id for channel in channels}
        for message in storage.messages(every, tell=told.append):
            pause()
            channel = every[message.channel]
            if message.channel in mine:
                self._take(channel, message.log_ns, message.data)
            else:
                lenses.add(_lens(channel, message.data))
        self.damage += told[:_TOLD]
        if len(told) > _TOLD:
            self.damage.append(f"and {len(told) - _TOLD} more parts cannot be read")
        if len(lenses - {()}) > 1:
            self.damage.append(
                f"the camera's calibration beside {channels[0].topic} changes on the way; the "
                "first one counts where no camera is given"
            )

    def _take(self, channel: Channel, log_ns: int, data: bytes) -> None:
        try:
            picture = read_picture(channel, data)
        except MessageError:
            self.unread += 1
            return
        if len(self.log_ns) >= self._max_frames:
            raise LimitError(
                f"the topic has more than {self._max_frames} frames; cut the recording into parts",
                code="too_many_frames",
            )
        if picture.kind == "video":
            is_key = is_keyframe(bytes(picture.data), codec_of(picture.format))
            if is_key and not self._has_key:
                self.first, self._has_key = picture, True
            self.is_key.append(is_key)
        else:
            self._measure(picture)
            self.is_key.append(True)
        self.first = self.first or picture
        self.log_ns.append(log_ns)
        self.stamps_ns.append(picture.stamp_ns)

    def _measure(self, picture: RecordedPicture) -> None:
        """Keep the size of the first picture that can be read."""
        if self.size is None:
            check_format(picture)
            try:
                self.size, self.first = size_of(picture, self._max_pixels), picture
            except ImageError as error:
                self.fault = self.fault or error.message


def _lens(channel: Channel, data: bytes) -> tuple[Any, ...]:
    try:
        return lens_of(read_message(channel, data))
    except (MessageError, AttributeError, TypeError, ValueError):
        return ()


def _declared(channels: list[Channel]) -> int:
    """Messages that the recording promises; 0 where it does not say."""
    counts = [channel.count for channel in channels]
    return 0 if None in counts else sum(count or 0 for count in counts)


def _timed(scan: _Scan, topic: str) -> tuple[NDArray[np.int64], TopicTimes, list[str]]:
    """Timestamps, whose they are, and what is to be said of them."""
    if not scan.log_ns:
        unread = f": none of its {scan.unread} messages can be read" if scan.unread else ""
        raise RecordingError(f"{topic} holds no picture{unread}", code="no_frames")
    stamps, logs = np.array(scan.stamps_ns, np.int64), np.array(scan.log_ns, np.int64)
    notes = []
    if (stamps > 0).all() and (np.diff(stamps) > 0).all():
        clock: Clock = "header"
        pts = stamps
    else:
        clock, pts = "recorder", distinct(logs)
        notes.append(_why_recorder(stamps))
    late = logs - pts
    is_stream = scan.kind == "video"
    return pts, TopicTimes(topic, clock, int(late.min()), int(late.max()), is_stream), notes


def _why_recorder(stamps: NDArray[np.int64]) -> str:
    back = np.flatnonzero(np.diff(stamps) <= 0)
    zero = int((stamps <= 0).sum())
    if zero:
        fault = f"{zero} of {len(stamps)} headers have no stamp"
    else:
        fault = f"the headers' stamps do not rise {len(back)} times, first after frame {back[0]}"
    return f"{fault}: all frames have the times at which the recorder took them"


def distinct(logs: NDArray[np.int64]) -> NDArray[np.int64]:
    """The recorder's times (N,), ns, those of one nanosecond told apart by one more each.

    Raises
    ------
    RecordingError
        If so many share one that they reach into the next.
    """
    runs = np.flatnonzero(np.r_[True, np.diff(logs) != 0])
    place = np.arange(len(logs)) - np.repeat(runs, np.diff(np.r_[runs, len(logs)]))
    pts = logs + place
    if (np.diff(pts) <= 0).any():
        raise RecordingError("the recorder's times do not tell the frames apart")
    return np.asarray(pts, np.int64)


def _first_size(scan: _Scan, max_pixels: int) -> tuple[int, int]:
    """The size of the first picture that can be read."""
    first = scan.first
    assert first is not None
    if first.kind == "video":
        packets = [(0, bytes(first.data))]
        for _, frame in decode_packets(packets, codec_of(first.format), max_pixels):
            return frame.width, frame.height
        raise RecordingError(
            "no picture of the video can be decoded: its keyframes are missing or damaged",
            code="no_frames",
        )
    if scan.size is None:
        raise RecordingError(
            f"none of the pictures can be read; of the first: {scan.fault}", code="no_frames"
        )
    return scan.size


def _describe(
    storage: Storage,
    scan: _Scan,
    pts: NDArray[np.int64],
    notes: list[str],
    size: tuple[int, int],
) -> VideoInfo:
    intervals = np.diff(pts)
    usual = float(np.median(intervals)) if len(intervals) else 0.0
    duration_s = (float(pts[-1] - pts[0]) + usual) / 1e9
    damage = [*scan.damage, *notes]
    if scan.unread:
        damage.append(f"{scan.unread} messages are no pictures and are left out")
    found = len(pts) + scan.unread
    if scan.declared > found:
        damage.append(f"{scan.declared - found} of {scan.declared} messages are missing")
    first = scan.first
    assert first is not None
    return VideoInfo(
        container=storage.container,
        codec=codec_of(first.format) if first.kind == "video" else first.kind,
        pixel_format=first.format,
        width=size[0],
        height=size[1],
        rotation_deg=0,
        frames=len(pts),
        frames_declared=scan.declared,
        duration_s=duration_s,
        fps=len(pts) / duration_s if duration_s > 0 else 0.0,
        variable_rate=varies(intervals, usual),
        damage=tuple(Counter([*damage, *gaps(intervals, usual)])),
    )
