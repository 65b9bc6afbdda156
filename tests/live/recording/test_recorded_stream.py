"""A camera's stream over the network is recorded as it came, over a break."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import pytest
from camera_server import StartServer, wait_for
from live_sessions import NOTHING, lines_of, packets_of, recorder, session_of, units
from videos import write

from padstudio.live.recording.options import RecordingOptions
from padstudio.live.reports.report import LiveReport
from padstudio.live.stream.addresses import parse_address
from padstudio.live.stream.live_stream import LiveStream
from padstudio.live.stream.options import StreamOptions


class Kept:
    """A tap that keeps what came, by connections."""

    def __init__(self) -> None:
        self.packets: list[list[tuple[bytes, int | None, int | None, bool]]] = []

    def opened(self, stream: Any, connection: int) -> None:
        self.packets.append([])

    def packet(self, packet: Any, arrived_s: float) -> None:
        self.packets[-1].append((bytes(packet), packet.pts, packet.dts, packet.is_keyframe))

    def closed(self) -> None:
        pass


@pytest.mark.parametrize(("codec", "encoder"), [("h264", "libx264"), ("hevc", "libx265")])
def test_what_came_over_rtsp_is_what_is_kept(
    tmp_path: Path, rtsp_server: StartServer, codec: str, encoder: str
) -> None:
    server = rtsp_server(
        write(tmp_path / "a.mp4", 60, codec=encoder, b_frames=0), password="s3cret"
    )
    address = parse_address(server.url_for("s3cret"))
    options = RecordingOptions(segment_s=1.0, least_free_bytes=0)
    into = recorder(tmp_path / "kept", options, source=server.url_for("s3cret"))
    kept = Kept()
    # On a busy machine nothing may be given up.
    stream = LiveStream(address, StreamOptions(late_s=60.0, silent_s=30.0), (into, kept))
    read: list[tuple[int, float]] = []

    def reads(count: int) -> bool:
        frame = stream.newest(0.1)
        if frame is not None:
            read.append((frame.connection, frame.pts_s))
            into.take(LiveReport(frame, NOTHING, time.monotonic()))
        return len(read) >= count

    try:
        wait_for(lambda: reads(40))
        server.stop()
        server.start()
        wait_for(lambda: read[-1][0] > read[0][0] or reads(10**6))
        wait_for(lambda: reads(len(read) + 1))
    finally:
        stream.close()
        into.close()
    session = session_of(tmp_path / "kept")
    assert "s3cret" not in (tmp_path / "kept" / "session.json").read_text()
    came = [packet for packets in kept.packets for packet in packets]
    found, lines = [], []
    for segment in session["segments"]:
        first = segment["first_pts"]
        found += [
            (data, pts + first, dts + first, key)
            for data, pts, dts, key in packets_of(tmp_path / "kept" / segment["video"])
            if pts is not None and dts is not None
        ]
        lines += lines_of(tmp_path / "kept" / segment["poses"])
    assert session["dropped"] == {"packets": 0, "reports": 0}
    assert len(session["segments"]) >= 3
    # Of the first packet of a connection the reader knows no time, and its sender's is 40 ms.
    step = 90_000 // 25
    true = [
        [packets[1][1] - step] + [packet[1] for packet in packets[1:]] for packets in kept.packets
    ]
    assert [packets[0][1] for packets in kept.packets] == [None] * len(kept.packets)
    assert [packet[1] for packet in found] == [pts for times in true for pts in times]
    for ours, theirs in zip(found, came, strict=True):
        assert units(ours[0], codec, True) == units(theirs[0], codec, False)
    # Each frame that was read has its line, each other one says that it was not.
    assert sum("number" in line["live"] for line in lines) == len(read)
    assert len(lines) == len(found)
