"""The words of the tus protocol, as tests say them."""

from __future__ import annotations

import base64
import hashlib
from typing import Any

import httpx

MP4 = b"\0\0\0\x20ftypisom" + bytes(range(256)) * 4000
TUS = {"Tus-Resumable": "1.0.0"}
BYTES = TUS | {"Content-Type": "application/offset+octet-stream"}


def announce(server: httpx.Client, size_bytes: int = len(MP4), **headers: str) -> str:
    answer = server.post(
        "/api/v1/uploads", headers=TUS | {"Upload-Length": str(size_bytes)} | headers
    )
    assert answer.status_code == 201, answer.text
    return str(answer.headers["location"])


def send(server: httpx.Client, address: str, offset: int, data: bytes, **more: str) -> Any:
    headers = BYTES | {"Upload-Offset": str(offset)} | more
    return server.patch(address, headers=headers, content=data)


def offset_of(server: httpx.Client, address: str) -> int:
    answer = server.head(address, headers=TUS)
    assert answer.headers["cache-control"] == "no-store"
    return int(answer.headers["upload-offset"])


def checksum(data: bytes, algorithm: str = "sha1") -> str:
    digest = hashlib.new(algorithm, data).digest()
    return f"{algorithm} {base64.b64encode(digest).decode()}"
