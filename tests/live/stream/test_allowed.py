"""A server opens the hosts that its settings list, and connects to the address it checked."""

from __future__ import annotations

import socket
from typing import Any

import pytest

from padstudio.errors import AccessError
from padstudio.live.stream.addresses import parse_address
from padstudio.live.stream.allowed import AllowedSources

_NAMES = {
    "camera": ["10.0.0.7"],
    "elsewhere": ["203.0.113.5"],
    "secrets": ["169.254.169.254"],
    "six": ["fd00::7"],
}


@pytest.fixture(autouse=True)
def names(monkeypatch: pytest.MonkeyPatch) -> None:
    """A resolver of our own."""

    def getaddrinfo(host: str, port: int, **_options: Any) -> list[Any]:
        if host not in _NAMES and not host[0].isdigit():
            raise socket.gaierror(-2, "unknown")
        found = _NAMES.get(host, [host])
        return [(socket.AF_INET, socket.SOCK_STREAM, 6, "", (each, port)) for each in found]

    monkeypatch.setattr(socket, "getaddrinfo", getaddrinfo)


@pytest.mark.parametrize(
    ("hosts", "text", "url"),
    [
        (["camera"], "rtsp://u:p@camera/x?y=1", "rtsp://u:p@10.0.0.7:554/x?y=1"),
        (["camera"], "rtsp://CAMERA:8554/x", "rtsp://10.0.0.7:8554/x"),
        (["camera:554"], "rtsp://camera/x", "rtsp://10.0.0.7:554/x"),
        (["six"], "http://six/x", "http://[fd00::7]:80/x"),
        (["10.0.0.0/8"], "rtsp://camera/x", "rtsp://10.0.0.7:554/x"),
        (["10.0.0.0/8"], "rtsp://10.1.2.3/x", "rtsp://10.1.2.3:554/x"),
        (["169.254.169.254"], "http://169.254.169.254/x", "http://169.254.169.254:80/x"),
        (["camera"], "rtsps://camera/x", "rtsps://camera/x"),
        (["0.0.0.0:5600"], "udp://@:5600", "udp://0.0.0.0:5600"),
    ],
)
def test_what_is_listed_is_opened_at_the_checked_address(
    hosts: list[str], text: str, url: str
) -> None:
    address = AllowedSources(hosts).check(parse_address(text))
    assert address.url == url
    assert address.host == parse_address(text).host


@pytest.mark.parametrize(
    ("hosts", "text"),
    [
        ([], "rtsp://camera/x"),
        (["camera:8554"], "rtsp://camera/x"),
        (["cam"], "rtsp://camera/x"),
        (["10.0.0.0/8"], "rtsp://elsewhere/x"),
        (["10.0.0.0/8"], "rtsps://camera/x"),
        (["secrets"], "http://secrets/x"),
        (["0.0.0.0:5600"], "udp://@:5601"),
        (["10.0.0.0/8"], "udp://10.0.0.1:5600"),
        (["camera"], "rtsp://camera@elsewhere/x"),
        (["camera"], "/dev/video0"),
        (["camera"], "landing.mp4"),
        (["camera"], "sender.sdp"),
    ],
)
def test_nothing_else_is_opened(hosts: list[str], text: str) -> None:
    with pytest.raises(AccessError) as caught:
        AllowedSources(hosts).check(parse_address(text))
    assert caught.value.error_code == "source_refused"


def test_devices_and_files_are_opened_where_that_is_allowed() -> None:
    allowed = AllowedSources(devices=True, files=True)
    for text in ("/dev/video0", "landing.mp4", "sender.sdp"):
        assert allowed.check(parse_address(text)) == parse_address(text)


@pytest.mark.parametrize("entry", ["http://camera", "camera/path", "a b", "camera:", "10.0.0.0/99"])
def test_an_entry_of_no_known_form_is_refused(entry: str) -> None:
    with pytest.raises(ValueError, match=r"\S"):
        AllowedSources([entry])
