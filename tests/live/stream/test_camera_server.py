"""The network cameras that tests stream from send what they are given."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import av
import pytest
import videos
from camera_server import StartServer
from udp_relay import RtspRelay


def numbers(url: str, transport: str, most: int) -> list[int]:
    """Numbers of the first frames that FFmpeg receives."""
    found: list[int] = []
    options = {"rtsp_transport": transport, "fpsprobesize": "0"}
    with av.open(url, options=options, timeout=20.0) as container:
        for frame in container.decode(video=0):
            found.append(videos.number_of(frame.to_ndarray(format="bgr24")))
            if len(found) == most:
                break
    return found


@pytest.mark.parametrize("transport", ["tcp", "udp"])
def test_rtsp_streams_every_frame_in_a_loop(
    tmp_path: Path, rtsp_server: StartServer, transport: str
) -> None:
    path = videos.write(tmp_path / "a.mp4", 12, b_frames=0)
    server = rtsp_server(path, speed=4.0)
    assert numbers(server.url, transport, 20) == [*range(12), *range(8)]


def test_a_password_is_asked_for(tmp_path: Path, rtsp_server: StartServer) -> None:
    path = videos.write(tmp_path / "a.mp4", 12, b_frames=0)
    server = rtsp_server(path, password="secret")
    assert numbers(server.url_for("secret"), "tcp", 3) == [0, 1, 2]
    with pytest.raises(av.error.HTTPUnauthorizedError):
        numbers(server.url, "tcp", 3)


def test_a_relay_loses_packets(
    tmp_path: Path, rtsp_server: StartServer, rtsp_relay: Callable[..., RtspRelay]
) -> None:
    path = videos.write(tmp_path / "a.mp4", 40, b_frames=0)
    relay = rtsp_relay(rtsp_server(path, speed=4.0), drop=0.1)
    assert len(numbers(relay.url, "udp", 60)) == 60
    assert relay.lost > 0
