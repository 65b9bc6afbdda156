"""Every kind of source gives the frames that were sent, the newest alone, and comes back."""

from __future__ import annotations

import contextlib
import itertools
import socket
import ssl
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import tls_certificate
import videos
from camera_server import StartServer, wait_for
from http_camera import HttpCamera, transport_stream
from udp_relay import RtspRelay, UdpRelay

from padstudio.live.reports.frame import LiveFrame
from padstudio.live.reports.source import PacketTap, StreamState
from padstudio.live.stream.addresses import parse_address
from padstudio.live.stream.live_stream import LiveStream
from padstudio.live.stream.options import StreamOptions

_FRAMES = 60
#: On a busy machine nothing may be passed over where each frame is looked at.
_PATIENT: dict[str, Any] = {"late_s": 60.0, "silent_s": 30.0}

Open = Callable[..., LiveStream]


@pytest.fixture
def open_stream() -> Iterator[Open]:
    """Opens streams by their addresses; closed with the test."""
    streams: list[LiveStream] = []

    def open_it(url: str, taps: tuple[PacketTap, ...] = (), **options: Any) -> LiveStream:
        streams.append(LiveStream(parse_address(url), StreamOptions(**options), taps))
        return streams[-1]

    yield open_it
    for stream in streams:
        stream.close()


@pytest.fixture(scope="module")
def video(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return videos.write(tmp_path_factory.mktemp("video") / "a.mp4", _FRAMES, b_frames=0)


def number_of(frame: LiveFrame) -> int:
    picture = frame.picture
    return int(videos.number_of(picture if not hasattr(picture, "bgr") else picture.bgr))


def take(stream: LiveStream, count: int, most_s: float = 60.0) -> list[LiveFrame]:
    """The next frames of a stream."""
    frames: list[LiveFrame] = []

    def has_all() -> bool:
        frame = stream.newest(0.1)
        frames.extend([] if frame is None else [frame])
        return len(frames) >= count

    wait_for(has_all, most_s)
    return frames


def check(frames: list[LiveFrame], step_s: float | None = 0.04) -> None:
    """What was sent is there, in order, each at its time."""
    for before, after in itertools.pairwise(frames):
        assert after.number > before.number
        assert after.pts_s > before.pts_s
        assert after.arrived_s <= after.decoded_s
        if step_s is not None and after.connection == before.connection:
            steps = (number_of(after) - number_of(before)) % _FRAMES
            assert round((after.pts_s - before.pts_s) / step_s) % _FRAMES == steps


@pytest.mark.parametrize("transport", ["tcp", "udp"])
def test_rtsp(video: Path, rtsp_server: StartServer, open_stream: Open, transport: str) -> None:
    stream = open_stream(rtsp_server(video).url, transport=transport, **_PATIENT)
    check(take(stream, 20))
    state = stream.state
    assert (state.phase, state.size_px, state.codec) == ("open", (192, 128), "h264")
    assert (state.damaged, state.skipped, state.connections) == (0, 0, 1)


def test_rtsp_of_h265(tmp_path: Path, rtsp_server: StartServer, open_stream: Open) -> None:
    path = videos.write(tmp_path / "a.mp4", _FRAMES, codec="libx265", b_frames=0)
    stream = open_stream(rtsp_server(path).url, **_PATIENT)
    check(take(stream, 10))
    assert stream.state.codec == "hevc"


@pytest.mark.parametrize(
    ("way", "address"),
    [
        ("ts", "udp://@:{port}"),
        ("rtp-ts", "rtp://127.0.0.1:{port}"),
        ("rtp", "rtp://127.0.0.1:{port}?codec=h264"),
    ],
)
def test_udp(
    video: Path,
    udp_sender: StartServer,
    free_udp_port: int,
    open_stream: Open,
    way: str,
    address: str,
) -> None:
    udp_sender(video, way=way, port=free_udp_port)
    stream = open_stream(address.format(port=free_udp_port), **_PATIENT)
    check(take(stream, 10))


def test_rtp_by_an_sdp_file(
    tmp_path: Path, video: Path, udp_sender: StartServer, free_udp_port: int, open_stream: Open
) -> None:
    udp_sender(video, way="rtp", port=free_udp_port)
    sdp = tmp_path / "sender.sdp"
    sdp.write_text(
        "v=0\r\no=- 0 0 IN IP4 127.0.0.1\r\ns=x\r\nc=IN IP4 127.0.0.1\r\nt=0 0\r\n"
        f"m=video {free_udp_port} RTP/AVP 96\r\na=rtpmap:96 H264/90000\r\n"
    )
    check(take(open_stream(str(sdp), **_PATIENT), 10))


def test_rtp_that_nobody_tells_of_needs_an_sdp_file(
    video: Path, udp_sender: StartServer, free_udp_port: int, open_stream: Open
) -> None:
    udp_sender(video, way="rtp", port=free_udp_port)
    stream = open_stream(f"rtp://127.0.0.1:{free_udp_port}", connect_s=30.0)
    wait_for(lambda: stream.state.phase == "refused")
    assert stream.state.code == "sdp_needed"
    assert "?codec=h264" in stream.state.detail


def test_mjpeg_over_http(http_camera: HttpCamera, open_stream: Open) -> None:
    stream = open_stream(http_camera.url("/mjpeg"), **_PATIENT)
    frames = take(stream, 10)
    check(frames, step_s=None)
    numbers = [number_of(frame) for frame in frames]
    assert numbers == sorted(set(numbers))
    # Pictures have no times of their own: they are placed by their arrival.
    assert all(frame.pts_s == frame.arrived_s for frame in frames)
    assert http_camera.hosts == [f"127.0.0.1:{http_camera.server_port}"]


def test_transport_stream_over_http(
    video: Path, http_camera: HttpCamera, open_stream: Open
) -> None:
    http_camera.transport_stream = transport_stream(video)
    stream = open_stream(http_camera.url("/ts"), attempts=1, **_PATIENT)
    wait_for(lambda: stream.state.frames == _FRAMES)
    check(take(stream, 1))


def test_a_certificate_is_checked(
    tmp_path: Path, open_stream: Open, monkeypatch: pytest.MonkeyPatch
) -> None:
    certificate = tls_certificate.write(tmp_path, "localhost")
    camera = HttpCamera(certificate=certificate)
    try:
        stream = open_stream(camera.url("/mjpeg"))
        wait_for(lambda: stream.state.phase == "refused")
        assert stream.state.code == "bad_certificate"
        assert take(open_stream(camera.url("/mjpeg"), verify_tls=False), 1)
        monkeypatch.setenv("SSL_CERT_FILE", str(certificate))
        assert take(open_stream(camera.url("/mjpeg")), 1)
        elsewhere = camera.url("/mjpeg").replace("localhost", "127.0.0.1")
        stream = open_stream(elsewhere)
        wait_for(lambda: stream.state.phase == "refused")
        assert stream.state.code == "bad_certificate"
    finally:
        camera.close()


@pytest.mark.parametrize("verify_tls", [True, False])
def test_no_request_goes_to_an_rtsp_camera_that_is_not_trusted(
    tmp_path: Path, open_stream: Open, verify_tls: bool
) -> None:
    heard: list[bytes] = []
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(tls_certificate.write(tmp_path, "localhost"))
    with socket.create_server(("127.0.0.1", 0)) as listener:

        def listen() -> None:
            with contextlib.suppress(OSError):
                while True:
                    plain, _ = listener.accept()
                    with (
                        contextlib.suppress(OSError),
                        plain,
                        context.wrap_socket(plain, server_side=True) as secure,
                    ):
                        heard.append(secure.recv(1000))

        thread = threading.Thread(target=listen)
        thread.start()
        url = f"rtsps://u:pass@localhost:{listener.getsockname()[1]}/x"
        stream = open_stream(url, verify_tls=verify_tls, attempts=1)
        wait_for(lambda: stream.state.phase == "refused")
        listener.shutdown(socket.SHUT_RDWR)
        thread.join(60.0)
    assert (stream.state.code == "bad_certificate") == verify_tls
    assert any(each.startswith(b"OPTIONS") for each in heard) == (not verify_tls)


def test_a_file_is_played_at_its_own_rate_to_its_end(video: Path, open_stream: Open) -> None:
    began = time.monotonic()
    stream = open_stream(str(video), **_PATIENT)
    wait_for(lambda: stream.state.phase == "ended")
    assert time.monotonic() - began >= 0.04 * (_FRAMES - 1)
    # At its end the last frame has been given.
    assert stream.state.frames == _FRAMES
    assert number_of(take(stream, 1)[0]) == _FRAMES - 1
    assert stream.state.code == ""


def test_a_file_begins_again_where_that_is_asked_for(tmp_path: Path, open_stream: Open) -> None:
    path = videos.write(tmp_path / "a.mp4", 5)
    stream = open_stream(str(path), loop=True)
    wait_for(lambda: stream.state.connections >= 3)
    assert stream.state.phase == "open"


def test_a_slow_reader_gets_the_newest_frame(video: Path, open_stream: Open) -> None:
    stream = open_stream(str(video), loop=True, **_PATIENT)
    for _ in range(3):
        count = stream.state.frames + 10
        wait_for(lambda count=count: stream.state.frames >= count)
        frame = stream.newest(0.0)
        assert frame is not None
        # Never an old one: at most those are newer that came while it was taken.
        assert count - 1 <= frame.number < stream.state.frames
    state = stream.state
    assert state.frames - state.dropped <= 4
    assert state.dropped >= 27


def test_what_came_before_anybody_could_read_is_not_counted(video: Path, open_stream: Open) -> None:
    stream = open_stream(str(video), loop=True, **_PATIENT)
    wait_for(lambda: stream.state.dropped >= 10)
    stream.begin()
    newest = stream.newest(60.0)
    assert newest is not None
    assert newest.number >= 10
    state = stream.state
    assert 1 <= state.frames <= 8
    assert state.dropped < state.frames


class _Notes:
    """A tap that notes what it is told."""

    def __init__(self) -> None:
        self.told: list[str] = []
        self.packets = 0

    def opened(self, stream: Any, connection: int) -> None:
        self.told.append(f"opened {connection} {stream.codec_context.width}")

    def packet(self, packet: Any, arrived_s: float) -> None:
        assert packet.size
        assert arrived_s <= time.monotonic()
        self.packets += 1

    def closed(self) -> None:
        self.told.append("closed")


def test_taps_get_every_packet(video: Path, open_stream: Open) -> None:
    notes = _Notes()
    stream = open_stream(str(video), (notes,), **_PATIENT)
    wait_for(lambda: stream.state.phase == "ended")
    assert (notes.told, notes.packets) == (["opened 1 192", "closed"], _FRAMES)


def test_another_size_is_followed(
    tmp_path: Path, video: Path, rtsp_server: StartServer, open_stream: Open
) -> None:
    wide = videos.write(tmp_path / "b.mp4", _FRAMES, size=(320, 240), b_frames=0)
    server = rtsp_server(video, wide)
    notes = _Notes()
    stream = open_stream(server.url, (notes,), **_PATIENT)
    assert take(stream, 3)[-1].picture.shape == (128, 192, 3)
    server.show(1)
    wait_for(lambda: take(stream, 1)[0].picture.shape == (240, 320, 3))
    # What records the stream is told with a connection of that size.
    wait_for(lambda: "opened 2 320" in notes.told)
    assert notes.told == ["opened 1 192", "closed", "opened 2 320"]
    assert stream.state.size_px == (320, 240)


def test_a_stream_that_was_pulled_comes_back(
    video: Path, rtsp_server: StartServer, open_stream: Open
) -> None:
    server = rtsp_server(video)
    stream = open_stream(server.url, most_retry_s=0.5)
    before = take(stream, 3)
    server.stop()
    wait_for(lambda: stream.state.code == "connection_refused")
    assert stream.state.phase == "lost"
    server.start()
    wait_for(lambda: stream.state.phase == "open")
    stream.newest(0.0)
    after = take(stream, 3)
    assert after[0].connection > before[-1].connection
    assert after[0].number > before[-1].number
    check(after)


def test_a_silent_stream_is_lost_and_comes_back(
    video: Path, rtsp_server: StartServer, open_stream: Open
) -> None:
    server = rtsp_server(video)
    stream = open_stream(server.url, silent_s=0.5, most_retry_s=0.25)
    take(stream, 3)
    server.silence()
    wait_for(lambda: stream.state.phase == "lost")
    assert stream.state.code in ("silent", "no_answer")
    server.speak()
    connections = stream.state.connections
    wait_for(lambda: stream.state.connections > connections)
    assert take(stream, 1)


def test_lost_packets_are_told(
    tmp_path: Path,
    rtsp_server: StartServer,
    rtsp_relay: Callable[..., RtspRelay],
    open_stream: Open,
) -> None:
    path = videos.write(tmp_path / "a.mp4", 240, b_frames=0, size=(640, 480), keyframe_every=12)
    relay = rtsp_relay(rtsp_server(path, speed=2.0), drop=0.05, seed=4)
    stream = open_stream(relay.url, transport="udp", **_PATIENT)
    frames: list[LiveFrame] = []

    def has_some() -> bool:
        frames.extend(take(stream, 1))
        return any(frame.is_damaged for frame in frames) and len(frames) > 60

    wait_for(has_some)
    assert relay.lost > 0
    assert stream.state.damaged >= sum(frame.is_damaged for frame in frames)
    # What is told to be whole shows its number as it was sent.
    whole = [frame for frame in frames if not frame.is_damaged]
    assert whole
    for before, after in itertools.pairwise(whole):
        steps = (number_of(after) - number_of(before)) % 240
        assert round((after.pts_s - before.pts_s) / 0.02) % 240 == steps


def test_packets_in_another_order_do_no_harm(
    video: Path,
    udp_sender: StartServer,
    free_udp_port: int,
    open_stream: Open,
) -> None:
    relay = UdpRelay(free_udp_port, reorder=0.1)
    try:
        udp_sender(video, way="rtp", port=relay.port)
        stream = open_stream(f"rtp://127.0.0.1:{free_udp_port}?codec=h264", **_PATIENT)
        check(take(stream, 20))
        assert stream.state.damaged == 0
    finally:
        relay.close()


def test_a_password(video: Path, rtsp_server: StartServer, open_stream: Open) -> None:
    server = rtsp_server(video, password="open-sesame")
    for given in ("wr0ng-w0rd", ""):
        stream = open_stream(server.url_for(given))
        wait_for(lambda stream=stream: stream.state.phase == "refused")
        assert stream.state.code == "unauthorized"
        assert "wr0ng" not in str(stream.state)
    assert take(open_stream(server.url_for("open-sesame")), 1)


@pytest.mark.parametrize(
    ("url", "phase", "code"),
    [
        ("rtsp://127.0.0.1:9/x", "lost", "connection_refused"),
        ("http://127.0.0.1:9/x", "lost", "connection_refused"),
        ("rtsp://nowhere.invalid/x", "lost", "unknown_host"),
        ("/dev/video99", "lost", "device_absent"),
        ("v4l2:/dev/null", "refused", "no_camera_device"),
        ("dshow:Camera", "refused", "not_available"),
        ("missing.mp4", "refused", "stream_not_found"),
    ],
)
def test_what_cannot_be_opened_is_told_by_name(
    open_stream: Open, url: str, phase: str, code: str
) -> None:
    stream = open_stream(url)
    wait_for(lambda: stream.state.code)
    state = stream.state
    assert (state.phase, state.code) == (phase, code)
    assert state.detail.startswith(url)


@pytest.mark.parametrize(
    ("path", "phase", "code"),
    [
        ("/page", "lost", "not_a_stream"),
        ("/elsewhere", "lost", "not_a_stream"),
        ("/secret", "refused", "unauthorized"),
        ("/missing", "lost", "stream_not_found"),
    ],
)
def test_what_an_http_camera_refuses_is_told_by_name(
    http_camera: HttpCamera, open_stream: Open, path: str, phase: str, code: str
) -> None:
    stream = open_stream(http_camera.url(path))
    wait_for(lambda: stream.state.code)
    assert (stream.state.phase, stream.state.code) == (phase, code)


def test_no_path_of_a_missing_stream(
    video: Path, rtsp_server: StartServer, open_stream: Open
) -> None:
    stream = open_stream(rtsp_server(video).url + "/other", attempts=2, retry_s=0.01)
    wait_for(lambda: stream.state.phase == "refused")
    assert stream.state.code == "stream_not_found"


def test_garbage_is_no_stream(tmp_path: Path, open_stream: Open) -> None:
    path = tmp_path / "a.mp4"
    path.write_bytes(bytes(range(256)) * 400)
    stream = open_stream(str(path))
    wait_for(lambda: stream.state.phase == "refused")
    assert stream.state.code == "not_a_video"


def test_too_large_frames_are_refused(
    video: Path, rtsp_server: StartServer, open_stream: Open
) -> None:
    stream = open_stream(rtsp_server(video).url, max_pixels=192 * 128 - 1)
    wait_for(lambda: stream.state.phase == "refused")
    assert stream.state.code == "too_many_pixels"


@pytest.mark.parametrize("is_listening", [True, False])
def test_closing_does_not_wait_for_what_does_not_come(
    free_udp_port: int, open_stream: Open, is_listening: bool
) -> None:
    url = f"udp://127.0.0.1:{free_udp_port}" if is_listening else "rtsp://127.0.0.1:9/x"
    stream = open_stream(url, connect_s=30.0, retry_s=60.0, most_retry_s=60.0)
    if not is_listening:
        wait_for(lambda: stream.state.phase == "lost")
    reader = threading.Thread(target=stream.newest, args=(600.0,))
    reader.start()
    stream.close()
    reader.join(60.0)
    assert not reader.is_alive()


def test_pauses_double_up_to_the_longest() -> None:
    options = StreamOptions()
    pauses = [options.pause_s(failures) for failures in range(9)]
    assert pauses == [0.25, 0.25, 0.5, 1.0, 2.0, 4.0, 4.0, 4.0, 4.0]
    assert options.pause_s(10**6) == 4.0


def test_a_state_is_as_of_now(open_stream: Open) -> None:
    assert StreamState().phase == "connecting"
