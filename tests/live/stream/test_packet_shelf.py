"""Any recent frame of a stream is decoded again as it was, and what is older is forgotten."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import av
import numpy as np
import pytest
import videos
from camera_server import wait_for
from http_camera import HttpCamera

from padstudio.arrays import Image, YuvFrame
from padstudio.errors import NotFoundError
from padstudio.live.reports.frame import LiveFrame
from padstudio.live.stream.addresses import parse_address
from padstudio.live.stream.live_stream import LiveStream
from padstudio.live.stream.options import StreamOptions
from padstudio.live.stream.packet_shelf import PacketShelf

_PATIENT = StreamOptions(late_s=60.0, silent_s=30.0)


def bgr(picture: Image | YuvFrame) -> Image:
    return picture.bgr if isinstance(picture, YuvFrame) else picture


def frames_of(stream: LiveStream, count: int) -> list[LiveFrame]:
    frames: list[LiveFrame] = []

    def has_all() -> bool:
        frame = stream.newest(0.1)
        frames.extend([] if frame is None else [frame])
        return len(frames) >= count

    wait_for(has_all)
    return frames


def check_same(shelf: PacketShelf, frame: LiveFrame) -> None:
    again = shelf.picture(frame.connection, frame.pts_s)
    assert np.array_equal(bgr(again), bgr(frame.picture))


@pytest.mark.parametrize(("codec", "b_frames"), [("libx264", 0), ("libx264", 2), ("libx265", 0)])
def test_a_frame_is_decoded_again_to_the_bit(tmp_path: Path, codec: str, b_frames: int) -> None:
    path = videos.write(tmp_path / "a.mp4", 40, codec=codec, b_frames=b_frames)
    shelf = PacketShelf()
    stream = LiveStream(parse_address(str(path)), _PATIENT, (shelf,))
    frames = frames_of(stream, 12)
    for frame in frames:
        check_same(shelf, frame)
    wait_for(lambda: stream.state.phase == "ended")
    stream.close()
    listed = shelf.frames()
    assert [round(frame.pts_s / 0.04) for frame in listed] == list(range(40))
    for number in (0, 9, 10, 39):
        again = shelf.picture(listed[number].connection, listed[number].pts_s)
        assert videos.number_of(bgr(again)) == number


def test_pictures_without_times_are_found_by_their_arrival(http_camera: HttpCamera) -> None:
    shelf = PacketShelf()
    stream = LiveStream(parse_address(http_camera.url("/mjpeg")), _PATIENT, (shelf,))
    for frame in frames_of(stream, 5):
        check_same(shelf, frame)
    stream.close()


class _Packets:
    """Packets of an H.264 stream, a keyframe each tenth, 25 a second."""

    def __init__(self, tmp_path: Path) -> None:
        path = videos.write(tmp_path / "a.mp4", 40, b_frames=0)
        with av.open(str(path)) as container:
            self.packets = [p for p in container.demux(video=0) if p.size]
            stream = container.streams.video[0]
            context = SimpleNamespace(name="h264", extradata=stream.codec_context.extradata)
            unit = stream.time_base or Fraction(1, 1000)
        self.stream: Any = SimpleNamespace(codec_context=context, time_base=unit)

    def feed(self, shelf: PacketShelf, count: int) -> None:
        for number in range(count):
            shelf.packet(self.packets[number], 0.04 * number)


def test_what_is_old_is_forgotten_by_groups(tmp_path: Path) -> None:
    source, shelf = _Packets(tmp_path), PacketShelf(keep_s=0.6)
    shelf.opened(source.stream, 1)
    source.feed(shelf, 40)
    times = [frame.arrived_s for frame in shelf.frames()]
    assert (times[0], times[-1]) == (0.04 * 20, 0.04 * 39)
    with pytest.raises(NotFoundError) as caught:
        shelf.picture(1, 0.04 * 19)
    assert caught.value.error_code == "frame_gone"
    assert videos.number_of(bgr(shelf.picture(1, 0.04 * 20))) == 20


def test_it_holds_no_more_bytes_than_it_may(tmp_path: Path) -> None:
    source = _Packets(tmp_path)
    groups = [sum(p.size for p in source.packets[i : i + 10]) for i in (0, 10, 20, 30)]
    shelf = PacketShelf(max_bytes=max(groups) * 2)
    shelf.opened(source.stream, 1)
    for number, packet in enumerate(source.packets):
        shelf.packet(packet, 0.04 * number)
        assert shelf.size <= max(groups) * 2
    small = PacketShelf(max_bytes=min(groups) - 1)
    small.opened(source.stream, 1)
    source.feed(small, 10)
    assert small.frames() == []
    small.packet(source.packets[10], 1.0)
    assert len(small.frames()) == 1


def test_it_begins_at_a_keyframe_in_each_connection(tmp_path: Path) -> None:
    source, shelf = _Packets(tmp_path), PacketShelf()
    shelf.packet(source.packets[0], 0.0)
    shelf.opened(source.stream, 1)
    for number in range(5, 15):
        shelf.packet(source.packets[number], 0.04 * number)
    shelf.closed()
    shelf.opened(source.stream, 2)
    for number in range(8, 13):
        shelf.packet(source.packets[number], 10 + 0.04 * number)
    listed = shelf.frames()
    assert [frame.connection for frame in listed] == [1] * 5 + [2] * 3
    assert videos.number_of(bgr(shelf.picture(2, listed[-1].pts_s))) == 12
    with pytest.raises(NotFoundError):
        shelf.picture(3, listed[-1].pts_s)
