from __future__ import annotations

import json
import socket

import httpx
import pytest

_LINE = b"Host: localhost\r\nContent-Type: "
_JSON = b"POST /api/v1/pads HTTP/1.1\r\n" + _LINE + b"application/json\r\n"
_FORM = b"POST /api/v1/detect HTTP/1.1\r\n" + _LINE + b"multipart/form-data; boundary=x\r\n"
_BLOCK = bytes(1 << 20)


def _chunk(data: bytes) -> bytes:
    return b"%x\r\n%s\r\n" % (len(data), data)


@pytest.mark.parametrize("is_declared", [True, False])
@pytest.mark.parametrize(
    ("head", "begin", "blocks"),
    [
        # The limits are 10 kB and 2 MB.
        (_JSON, b'{"name": "', 16),
        (_FORM, b'--x\r\nContent-Disposition: form-data; name="image"; filename="a"\r\n\r\n', 24),
    ],
)
def test_who_sends_far_too_much_before_reading_is_told(
    studio: httpx.Client, head: bytes, begin: bytes, blocks: int, is_declared: bool
) -> None:
    size = len(begin) + blocks * len(_BLOCK)
    says = b"Content-Length: %d" % size if is_declared else b"Transfer-Encoding: chunked"
    url = studio.base_url
    with socket.create_connection((url.host, url.port or 80), timeout=120) as connection:
        connection.sendall(head + says + b"\r\n\r\n" + (begin if is_declared else _chunk(begin)))
        for _ in range(blocks):
            connection.sendall(_BLOCK if is_declared else _chunk(_BLOCK))
        if not is_declared:
            connection.sendall(b"0\r\n\r\n")
        parts = []
        while part := connection.recv(65536):
            parts.append(part)
    said, _, body = b"".join(parts).decode().partition("\r\n\r\n")
    assert said.startswith("HTTP/1.1 413")
    assert "connection: close" in said.lower()
    assert json.loads(body)["error"]["code"] == "limit_exceeded"
