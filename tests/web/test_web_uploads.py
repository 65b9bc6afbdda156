"""Uploads over HTTP: the protocol's own words, and the reference client."""

from __future__ import annotations

import asyncio
import base64
import hashlib
import io
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from email.utils import parsedate_to_datetime
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import httpx
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tusclient.client import TusClient
from tusclient.exceptions import TusUploadFailed
from web_server import running, settings_for, wait_until

from padstudio.web.turns import Turns

MP4 = b"\0\0\0\x20ftypisom" + bytes(range(256)) * 4000
TUS = {"Tus-Resumable": "1.0.0"}
BYTES = TUS | {"Content-Type": "application/offset+octet-stream"}
MAX_BYTES = 3_000_000
Refused = Callable[..., dict[str, Any]]


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    values = settings_for(tmp_path_factory.mktemp("data"), max_flight_bytes=MAX_BYTES)
    with running(values) as client:
        yield client


def _announce(server: httpx.Client, size_bytes: int = len(MP4), **headers: str) -> str:
    answer = server.post(
        "/api/v1/uploads", headers=TUS | {"Upload-Length": str(size_bytes)} | headers
    )
    assert answer.status_code == 201, answer.text
    return str(answer.headers["location"])


def _send(server: httpx.Client, address: str, offset: int, data: bytes, **more: str) -> Any:
    headers = BYTES | {"Upload-Offset": str(offset)} | more
    return server.patch(address, headers=headers, content=data)


def _offset(server: httpx.Client, address: str) -> int:
    answer = server.head(address, headers=TUS)
    assert answer.headers["cache-control"] == "no-store"
    return int(answer.headers["upload-offset"])


def _checksum(data: bytes, algorithm: str = "sha1") -> str:
    digest = hashlib.new(algorithm, data).digest()
    return f"{algorithm} {base64.b64encode(digest).decode()}"


def test_the_server_says_what_it_can(server: httpx.Client) -> None:
    answer = server.request("OPTIONS", "/api/v1/uploads")
    assert answer.status_code == 204
    assert answer.headers["tus-version"] == answer.headers["tus-resumable"] == "1.0.0"
    assert answer.headers["tus-max-size"] == str(MAX_BYTES)
    assert answer.headers["tus-checksum-algorithm"] == "sha1,sha256"
    said = set(answer.headers["tus-extension"].split(","))
    assert said >= {"creation", "creation-with-upload", "checksum", "expiration", "termination"}


def test_an_upload_in_parts(server: httpx.Client) -> None:
    name = base64.b64encode("Wälder/Flug 1.mp4".encode()).decode()
    metadata = f"filename {name},is_confidential"
    address = _announce(server, len(MP4), **{"Upload-Metadata": metadata})
    first = _send(server, address, 0, MP4[:1000])
    assert (first.status_code, first.headers["upload-offset"]) == (204, "1000")
    assert parsedate_to_datetime(first.headers["upload-expires"])
    assert _offset(server, address) == 1000
    assert server.head(address, headers=TUS).headers["upload-metadata"] == metadata
    assert server.get(address).json()["complete"] is False
    last = _send(server, address, 1000, MP4[1000:])
    assert (last.status_code, last.headers["upload-offset"]) == (204, str(len(MP4)))
    assert "upload-expires" not in last.headers
    upload = server.get(address).json()
    assert (upload["name"], upload["kind"], upload["complete"]) == ("Flug 1.mp4", "video", True)
    assert upload["sha256"] == hashlib.sha256(MP4).hexdigest()
    listed = server.get("/api/v1/uploads", params={"sha256": upload["sha256"]}).json()
    assert upload in listed["items"]
    assert server.delete(address).status_code == 204
    assert server.head(address, headers=TUS).status_code == 404


def test_the_first_bytes_may_come_along(server: httpx.Client) -> None:
    headers = BYTES | {"Upload-Length": str(len(MP4)), "Upload-Checksum": _checksum(MP4)}
    answer = server.post("/api/v1/uploads", headers=headers, content=MP4)
    assert answer.headers["upload-offset"] == str(len(MP4))
    assert answer.json()["complete"] is True


def test_a_checksum_is_compared(server: httpx.Client, refused: Refused) -> None:
    address = _announce(server)
    wrong = {"Upload-Checksum": _checksum(MP4)}
    refused(_send(server, address, 0, MP4[:-1] + b"!", **wrong), 460, "checksum_mismatch")
    assert _offset(server, address) == 0
    right = {"Upload-Checksum": _checksum(MP4, "sha256")}
    assert _send(server, address, 0, MP4, **right).status_code == 204


def test_methods_in_disguise(server: httpx.Client, refused: Refused) -> None:
    address = _announce(server)
    headers = BYTES | {"Upload-Offset": "0"}
    refused(server.post(address, headers=headers, content=MP4), 400, "invalid_tus_header")
    override = {"X-HTTP-Method-Override": "PATCH"}
    assert server.post(address, headers=headers | override, content=MP4).status_code == 204
    assert server.post(address, headers={"X-HTTP-Method-Override": "DELETE"}).status_code == 204
    refused(server.get(address), 404, "not_found")


@pytest.mark.parametrize(
    ("headers", "status", "code"),
    [
        ({"Upload-Length": str(MAX_BYTES + 1)}, 413, "limit_exceeded"),
        ({"Upload-Length": "0"}, 422, "empty_file"),
        ({"Upload-Length": "-1"}, 400, "invalid_tus_header"),
        ({"Upload-Length": "²"}, 400, "invalid_tus_header"),
        ({}, 400, "invalid_tus_header"),
        ({"Upload-Defer-Length": "1"}, 400, "invalid_tus_header"),
        ({"Upload-Length": "9", "Upload-Concat": "partial"}, 400, "invalid_tus_header"),
        ({"Upload-Length": "9", "Upload-Metadata": "a ö"}, 400, "invalid_tus_header"),
        ({"Upload-Length": "9", "Upload-Metadata": "a YQ==,a YQ=="}, 400, "invalid_tus_header"),
        ({"Upload-Length": "9", "Upload-Metadata": "a" * 5000}, 400, "invalid_tus_header"),
        ({"Upload-Length": "9", "Tus-Resumable": "0.2.2"}, 412, "tus_version"),
    ],
)
def test_wrong_announcements(
    server: httpx.Client, refused: Refused, headers: dict[str, str], status: int, code: str
) -> None:
    encoded = [(k.encode(), v.encode("latin-1")) for k, v in (TUS | headers).items()]
    refused(server.post("/api/v1/uploads", headers=encoded), status, code)


@pytest.mark.parametrize(
    ("headers", "status", "code"),
    [
        ({"Upload-Offset": "5"}, 409, "offset_mismatch"),
        ({"Upload-Offset": "x"}, 400, "invalid_tus_header"),
        ({"Content-Type": "text/plain"}, 415, "unsupported_media_type"),
        ({"Upload-Checksum": "crc32 AAAA"}, 400, "unknown_checksum"),
        ({"Upload-Checksum": "sha1 ?"}, 400, "invalid_tus_header"),
        ({"Tus-Resumable": ""}, 412, "tus_version"),
    ],
)
def test_wrong_requests(
    server: httpx.Client, refused: Refused, headers: dict[str, str], status: int, code: str
) -> None:
    address = _announce(server)
    answer = server.patch(
        address, headers=BYTES | {"Upload-Offset": "0"} | headers, content=MP4[:100]
    )
    refused(answer, status, code)
    assert _offset(server, address) == 0


def test_more_than_announced_is_refused(server: httpx.Client, refused: Refused) -> None:
    address = _announce(server, 10)
    refused(_send(server, address, 0, MP4), 409, "too_many_bytes")
    assert _offset(server, address) == 0


@pytest.mark.parametrize("size", [500, 50_000])
def test_a_text_named_mp4_is_refused_and_gone(
    server: httpx.Client, refused: Refused, size: int
) -> None:
    name = base64.b64encode(b"flight.mp4").decode()
    address = _announce(server, size, **{"Upload-Metadata": f"filename {name}"})
    error = refused(_send(server, address, 0, b"x" * size), 422, "unknown_content")
    assert "MP4" in error["message"]
    refused(server.get(address), 404, "not_found")


def test_bytes_go_nowhere_else_in_such_an_amount(server: httpx.Client, refused: Refused) -> None:
    answer = server.post("/api/v1/pads", headers=BYTES, content=bytes(20_000))
    refused(answer, 413, "limit_exceeded")


@pytest.mark.parametrize("path", ["", "/none", "/none/deeper"])
def test_every_answer_names_the_version(server: httpx.Client, path: str) -> None:
    for method in ("GET", "HEAD", "POST", "PATCH", "DELETE", "OPTIONS"):
        answer = server.request(method, f"/api/v1/uploads{path}")
        assert answer.headers["tus-resumable"] == answer.headers["tus-version"] == "1.0.0"


@settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow], database=None
)
@given(
    headers=st.dictionaries(
        st.sampled_from(
            [
                "Upload-Length",
                "Upload-Offset",
                "Upload-Metadata",
                "Upload-Checksum",
                "X-HTTP-Method-Override",
                "Content-Type",
            ]
        ),
        st.one_of(
            st.integers(-5, 10**20).map(str),
            st.text(st.characters(codec="latin-1", categories=["L", "N", "P", "S"]), max_size=30),
            st.sampled_from(["sha1", "sha256 AAAA", "sha1 é", "filename ////", "PATCH"]),
        ),
        max_size=4,
    ),
    body=st.binary(max_size=40),
)
def test_odd_headers_get_an_answer(
    server: httpx.Client, headers: dict[str, str], body: bytes
) -> None:
    raw = [(k.encode(), v.encode("latin-1")) for k, v in (TUS | headers).items()]
    for method, path in (("POST", ""), ("POST", "/a"), ("PATCH", "/a")):
        answer = server.request(method, f"/api/v1/uploads{path}", headers=raw, content=body)
        assert answer.status_code < 500, answer.text
        if answer.status_code == 201:
            assert server.head(answer.headers["location"], headers=TUS).status_code == 200
            server.delete(answer.headers["location"])


def _client(server: httpx.Client, **options: Any) -> Any:
    client = TusClient(f"{server.base_url}/api/v1/uploads")
    return client.uploader(file_stream=io.BytesIO(MP4), metadata={"filename": "a.mp4"}, **options)


def test_the_reference_client_uploads(server: httpx.Client) -> None:
    uploader = _client(server, chunk_size=300_000, upload_checksum=True)
    uploader.upload()
    upload = server.get(urlsplit(uploader.url).path).json()
    assert upload["sha256"] == hashlib.sha256(MP4).hexdigest()
    assert upload["name"] == "a.mp4"


def test_the_reference_client_is_told_the_limit(server: httpx.Client) -> None:
    client = TusClient(f"{server.base_url}/api/v1/uploads")
    uploader = client.uploader(file_stream=io.BytesIO(bytes(MAX_BYTES + 1)))
    with pytest.raises(Exception, match="413"):
        uploader.upload()


class CuttingProxy:
    """Passes connections on, and breaks the first one after some bytes."""

    def __init__(self, port: int, cut_after: int) -> None:
        self._target, self._cut_after = port, cut_after
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port = self._listener.getsockname()[1]
        self._thread = threading.Thread(target=self._serve)
        self._thread.start()

    def _serve(self) -> None:
        while True:
            try:
                connection, _ = self._listener.accept()
            except OSError:
                return
            with connection, socket.create_connection(("127.0.0.1", self._target)) as server:
                answers = threading.Thread(target=_pump, args=(server, connection, None))
                answers.start()
                if _pump(connection, server, self._cut_after):
                    self._cut_after = 1 << 60
                for end in (server, connection):
                    end.shutdown(socket.SHUT_RDWR) if end.fileno() >= 0 else None
                answers.join()

    def close(self) -> None:
        self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()
        self._thread.join()


def _pump(source: socket.socket, target: socket.socket, most: int | None) -> bool:
    """Pass bytes on until the source ends, or until there were enough: then True."""
    passed = 0
    try:
        while data := source.recv(65536):
            target.sendall(data)
            passed += len(data)
            if most is not None and passed >= most:
                return True
    except OSError:
        pass
    return False


def test_the_reference_client_goes_on_after_a_broken_connection(server: httpx.Client) -> None:
    uploader = _client(server)
    uploader.set_url(uploader.create_url())
    address = urlsplit(uploader.url)
    assert address.port is not None
    proxy = CuttingProxy(address.port, cut_after=600_000)
    try:
        uploader.set_url(f"http://127.0.0.1:{proxy.port}{address.path}")
        with pytest.raises(TusUploadFailed):
            uploader.upload()
        there = uploader.get_offset()
        assert 300_000 < there < len(MP4)
        uploader.offset = there
        uploader.upload()
    finally:
        proxy.close()
    assert server.get(address.path).json()["sha256"] == hashlib.sha256(MP4).hexdigest()


def _head(server: httpx.Client, address: str) -> str:
    """The head of a request that promises the whole file."""
    return (
        f"PATCH {address} HTTP/1.1\r\nHost: {server.base_url.host}\r\nTus-Resumable: 1.0.0\r\n"
        "Upload-Offset: 0\r\nContent-Type: application/offset+octet-stream\r\n"
        f"Content-Length: {len(MP4)}\r\n\r\n"
    )


def test_a_newcomer_takes_over_from_a_dead_connection(server: httpx.Client) -> None:
    address = _announce(server)
    host, port = server.base_url.host, server.base_url.port
    assert port is not None
    with socket.create_connection((host, port)) as half_open:
        half_open.sendall(_head(server, address).encode() + MP4[:500_000])
        wait_until(lambda: server.get(address).json()["offset"] > 0)
        there = _offset(server, address)
        assert b"upload_taken_over" in half_open.recv(65536)
    assert _send(server, address, there, MP4[there:]).status_code == 204
    assert server.get(address).json()["sha256"] == hashlib.sha256(MP4).hexdigest()


def test_an_upload_goes_on_after_a_restart(tmp_path: Path) -> None:
    values = settings_for(tmp_path)
    with running(values) as server:
        address = _announce(server)
        _send(server, address, 0, MP4[:100_000])
    with running(values) as server:
        assert _offset(server, address) == 100_000
        assert _send(server, address, 100_000, MP4[100_000:]).status_code == 204
        assert server.get(address).json()["sha256"] == hashlib.sha256(MP4).hexdigest()


def test_an_upload_goes_on_after_the_server_was_killed(tmp_path: Path) -> None:
    def serve() -> tuple[subprocess.Popen[str], httpx.Client]:
        program = Path(sys.executable).with_name("padstudio")
        command = [program, "serve", "--port", "0", "--data", tmp_path]
        process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        assert process.stderr is not None
        address = process.stderr.readline().split()[2]
        return process, httpx.Client(base_url=address, timeout=30, trust_env=False)

    def end(process: subprocess.Popen[str], client: httpx.Client) -> None:
        process.kill()
        process.communicate()
        client.close()

    process, server = serve()
    try:
        address = _announce(server)
        with socket.create_connection((server.base_url.host, server.base_url.port)) as sender:
            sender.sendall(_head(server, address).encode() + MP4[:700_000])
            wait_until(lambda: server.get(address).json()["offset"] > 0)
            process.kill()
    finally:
        end(process, server)
    process, server = serve()
    try:
        there = _offset(server, address)
        assert 0 < there <= 700_000
        assert _send(server, address, there, MP4[there:]).status_code == 204
        assert server.get(address).json()["sha256"] == hashlib.sha256(MP4).hexdigest()
    finally:
        end(process, server)


def test_uploads_expire_by_themselves(tmp_path: Path) -> None:
    with running(settings_for(tmp_path, upload_expires_seconds=0.1)) as server:
        address = _announce(server)
        _send(server, address, 0, MP4[:100])
        partial = tmp_path / "uploads" / "partial" / address.rsplit("/", 1)[-1]
        wait_until(lambda: not partial.exists())
        assert server.get(address).status_code == 404


def test_other_sites_may_not_upload(server: httpx.Client, refused: Refused) -> None:
    headers = TUS | {"Upload-Length": "9", "Origin": "https://evil.example"}
    refused(server.post("/api/v1/uploads", headers=headers), 403, "foreign_origin")


def test_turns_are_taken_one_after_the_other() -> None:
    async def run() -> list[str]:
        turns, said = Turns(), []

        async def work(name: str) -> None:
            async with turns.take("a") as stop:
                said.append(f"{name} begins")
                await stop.wait()
                said.append(f"{name} ends")

        first = asyncio.create_task(work("first"))
        await asyncio.sleep(0)
        second = asyncio.create_task(work("second"))
        await first
        async with turns.take("b"), turns.take("a"):
            await second
        return said

    assert asyncio.run(run()) == ["first begins", "first ends", "second begins", "second ends"]
