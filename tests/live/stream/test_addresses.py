"""Addresses of sources are of known kinds, and their passwords are never shown."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from padstudio.errors import SpecError
from padstudio.live.stream.addresses import StreamAddress, parse_address


@pytest.mark.parametrize(
    ("text", "kind", "host", "port"),
    [
        ("rtsp://10.0.0.2/live", "rtsp", "10.0.0.2", 554),
        ("rtsps://cam.local:7441/x", "rtsp", "cam.local", 7441),
        ("RTSP://cam/x", "rtsp", "cam", 554),
        ("udp://@:5600", "udp", "0.0.0.0", 5600),
        ("udp://239.1.1.1:1234?localaddr=10.0.0.1", "udp", "239.1.1.1", 1234),
        ("rtp://0.0.0.0:5600?codec=h264&payload=97", "rtp", "0.0.0.0", 5600),
        ("udp://[::]:5600", "udp", "::", 5600),
        ("http://cam:8080/video", "http", "cam", 8080),
        ("https://cam/video", "http", "cam", 443),
        ("/dev/video0", "device", "", 0),
        ("v4l2:/dev/video2", "device", "", 0),
        ("avfoundation:FaceTime HD Camera", "device", "", 0),
        ("flight/landing.mp4", "file", "", 0),
        ("C:\\flights\\landing.mp4", "file", "", 0),
        ("sender.sdp", "sdp", "", 0),
    ],
)
def test_an_address_is_of_a_known_kind(text: str, kind: str, host: str, port: int) -> None:
    address = parse_address(text)
    assert (address.kind, address.host, address.port) == (kind, host, port)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "concat:a.mp4|b.mp4",
        "file:/etc/passwd",
        "file:///etc/passwd",
        "pipe:0",
        "data:text/plain,x",
        "subfile,,start,0,end,9,,:a.mp4",
        "async:http://cam/x",
        "tcp://cam:80",
        "srt://cam:80",
        "hls+http://cam/x",
        "rtsp://",
        "rtsp://cam:port/x",
        "rtsp://cam:99999/x",
        "rtsp://cam/a b",
        "rtsp://cam/a#b",
        "rtsp://cam\\@evil/x",
        "rtsp://cam/\n",
        "udp://0.0.0.0",
        "udp://0.0.0.0:5600?pkt_size=9",
        "udp://0.0.0.0:5600?localaddr=a%26b",
        "rtp://0.0.0.0:5600?codec=vp8",
        "rtp://0.0.0.0:5600?codec=h264&payload=300",
        "rtp://0.0.0.0:5600?codec=h264&payload=" + "9" * 5000,
        "rtp://u:p@0.0.0.0:5600",
        "udp://0.0.0.0:5600/path",
        "x" * 2001,
    ],
)
def test_what_is_of_no_known_kind_is_refused(text: str) -> None:
    if text.startswith("subfile"):
        # A comma ends no scheme: it is a file's name, and opened as such.
        assert parse_address(text).kind == "file"
        return
    with pytest.raises(SpecError) as caught:
        parse_address(text)
    assert caught.value.error_code == "bad_address"


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("rtsp://u:secret@cam/x", "rtsp://u:***@cam/x"),
        ("rtsp://u:se:cr@et@cam/x", "rtsp://u:***@cam/x"),
        ("rtsp://u@cam/x", "rtsp://u@cam/x"),
        ("rtsp://cam/x?channel=1&token=secret", "rtsp://cam/x?channel=1&token=***"),
        ("rtsp://cam/user=a&password=secret&channel=1.sdp", None),
        ("http://cam/x?12345", "http://cam/x?12345"),
    ],
)
def test_passwords_are_not_shown(text: str, shown: str | None) -> None:
    address = parse_address(text)
    assert address.url == text
    assert shown is None or address.shown == shown
    assert "secret" not in address.shown
    assert "secret" not in repr(address)


_NAME = st.text("abcdefghijklmnopqrstuvwxyz0123456789", min_size=1, max_size=8)
_SECRET = st.text("ABCDEFGHIJKLMNOP:@!$%*()-_=+.,", min_size=8, max_size=12)


@given(_NAME, _SECRET, _NAME)
def test_no_password_is_shown_whatever_it_holds(user: str, password: str, path: str) -> None:
    try:
        address = parse_address(f"rtsp://{user}:{password}@cam/{path}?pwd={password}")
    except SpecError as error:
        shown = error.message
    else:
        shown = address.shown + repr(address)
    assert password not in shown


@given(st.text(max_size=60))
def test_any_text_is_an_address_or_refused(text: str) -> None:
    try:
        address = parse_address(text)
    except SpecError:
        return
    assert isinstance(address, StreamAddress)
