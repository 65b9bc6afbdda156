"""Reads chosen frames of a recording's topic, in order, from wherever they lie."""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from typing import Any

from padstudio.arrays import Image
from padstudio.errors import ImageError
from padstudio.media.images import MAX_PIXELS
from padstudio.media.recordings.folders import open_recording
from padstudio.media.recordings.messages import MessageError, RecordedPicture, read_picture
from padstudio.media.recordings.pictures import to_bgr
from padstudio.media.recordings.storage import Storage
from padstudio.media.recordings.times import TopicTimes
from padstudio.media.recordings.topics import picture_channels
from padstudio.media.video_frames import Keep, VideoPicture, to_frame
from padstudio.media.video_packets import codec_of, decode_packets, is_keyframe

# A keyframe is looked for so far before a frame, and then from the start.
_STEPS_BACK_NS = (0, 2 * 10**9, 20 * 10**9)

Packet = tuple[int, RecordedPicture]


def read_frames(
    source: str,
    pts: Sequence[int],
    times: TopicTimes,
    *,
    max_pixels: int = MAX_PIXELS,
    keep: Keep | None = None,
) -> Generator[VideoPicture]:
    """Read frames of a topic by their times; as `padstudio.media.video_frames.read_frames`.

    Parameters
    ----------
    source : str
        As of `padstudio.media.recordings.folders.open_recording`.
    pts : sequence of int
        As in the index, ascending.
    times : TopicTimes
        Of the index.
    max_pixels : int
    keep : callable or None
        Takes frames of a video stream, as there.

    Yields
    ------
    VideoPicture
        One for each timestamp.

    Raises
    ------
    RecordingError, LimitError, StorageError
        If the recording cannot be opened, or a frame is beyond the limit.
    """
    wanted = [int(value) for value in pts]
    if not wanted:
        return
    storage = open_recording(source)
    if times.is_stream:
        yield from _video(storage, wanted, times, max_pixels, keep)
        return
    place = 0
    for at, picture in _pictures(storage, times, wanted[0], wanted[-1]):
        while place < len(wanted) and wanted[place] < at:
            yield VideoPicture(wanted[place], None)
            place += 1
        if place < len(wanted) and wanted[place] == at:
            yield VideoPicture(at, _decoded(picture, max_pixels))
            place += 1
    for missing in wanted[place:]:
        yield VideoPicture(missing, None)


def _pictures(
    storage: Storage, times: TopicTimes, first: int | None, last: int
) -> Iterator[Packet]:
    """Times and pictures from one frame to another; None is the topic's first."""
    channels = {channel.id: channel for channel in picture_channels(storage, times.topic)}
    start_ns = None if first is None else first + times.least_ns
    before, same = None, 0
    for message in storage.messages(channels, start_ns, last + times.most_ns):
        try:
            picture = read_picture(channels[message.channel], message.data)
        except MessageError:
            continue
        # As in the index: those of one nanosecond are told apart.
        same = same + 1 if message.log_ns == before else 0
        before = message.log_ns
        at = picture.stamp_ns if times.clock == "header" else message.log_ns + same
        yield at, picture


def _decoded(picture: RecordedPicture, max_pixels: int) -> Image | None:
    try:
        return to_bgr(picture, max_pixels)
    except ImageError:
        return None


def _video(
    storage: Storage,
    wanted: Sequence[int],
    times: TopicTimes,
    max_pixels: int,
    keep: Keep | None,
) -> Generator[VideoPicture]:
    def made(at: int, frame: Any, is_damaged: bool) -> VideoPicture:
        if keep is not None:
            keep(at, frame, is_damaged)
            return VideoPicture(at, None, is_damaged)
        picture = None if frame is None else to_frame(frame, 0, max_pixels)
        return VideoPicture(at, picture, is_damaged and frame is not None)

    place, is_damaged = 0, False
    for at, frame in _decoded_video(storage, times, wanted[0], wanted[-1], max_pixels):
        is_damaged = bool(frame.is_corrupt or (is_damaged and not frame.key_frame))
        while place < len(wanted) and wanted[place] < at:
            yield made(wanted[place], None, is_damaged)
            # What follows rests on what was lost, up to the next keyframe.
            place, is_damaged = place + 1, is_damaged or not frame.key_frame
        if place < len(wanted) and wanted[place] == at:
            yield made(at, frame, is_damaged)
            place += 1
    for missing in wanted[place:]:
        yield made(missing, None, is_damaged)


def _decoded_video(
    storage: Storage, times: TopicTimes, first: int, last: int, max_pixels: int
) -> Iterator[tuple[int, Any]]:
    """Frames from the keyframe before the first one asked for."""
    packets = _from_keyframe(storage, times, first, last)
    start = next(packets, None)
    if start is None:
        return
    codec = codec_of(start[1].format)

    def raw() -> Iterator[tuple[int, bytes]]:
        yield start[0], bytes(start[1].data)
        for at, picture in packets:
            yield at, bytes(picture.data)

    yield from decode_packets(raw(), codec, max_pixels)


def _from_keyframe(storage: Storage, times: TopicTimes, first: int, last: int) -> Iterator[Packet]:
    for back_ns in (*_STEPS_BACK_NS, None):
        begin = None if back_ns is None else first - back_ns
        packets = _pictures(storage, times, begin, last)
        start = next((packet for packet in packets if _is_key(packet[1])), None)
        if start is not None and (start[0] <= first or back_ns is None):
            yield start
            yield from packets
            return


def _is_key(picture: RecordedPicture) -> bool:
    return is_keyframe(bytes(picture.data), codec_of(picture.format))
