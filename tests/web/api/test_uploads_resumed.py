"""Uploads by the reference client, over connections that break and servers that end."""

from __future__ import annotations

import hashlib
import io
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import httpx
import pytest
from tus_words import MP4, announce, offset_of, send
from tusclient.client import TusClient
from tusclient.exceptions import TusUploadFailed
from web_server import running, settings_for, wait_until

MAX_BYTES = 3_000_000


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    values = settings_for(tmp_path_factory.mktemp("data"), max_flight_bytes=MAX_BYTES)
    with running(values) as client:
        yield client


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
    address = announce(server)
    host, port = server.base_url.host, server.base_url.port
    assert port is not None
    with socket.create_connection((host, port)) as half_open:
        half_open.sendall(_head(server, address).encode() + MP4[:500_000])
        wait_until(lambda: server.get(address).json()["offset"] > 0)
        there = offset_of(server, address)
        assert b"upload_taken_over" in half_open.recv(65536)
    assert send(server, address, there, MP4[there:]).status_code == 204
    assert server.get(address).json()["sha256"] == hashlib.sha256(MP4).hexdigest()


def test_an_upload_goes_on_after_a_restart(tmp_path: Path) -> None:
    values = settings_for(tmp_path)
    with running(values) as server:
        address = announce(server)
        send(server, address, 0, MP4[:100_000])
    with running(values) as server:
        assert offset_of(server, address) == 100_000
        assert send(server, address, 100_000, MP4[100_000:]).status_code == 204
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
        address = announce(server)
        with socket.create_connection((server.base_url.host, server.base_url.port)) as sender:
            sender.sendall(_head(server, address).encode() + MP4[:700_000])
            wait_until(lambda: server.get(address).json()["offset"] > 0)
            process.kill()
    finally:
        end(process, server)
    process, server = serve()
    try:
        there = offset_of(server, address)
        assert 0 < there <= 700_000
        assert send(server, address, there, MP4[there:]).status_code == 204
        assert server.get(address).json()["sha256"] == hashlib.sha256(MP4).hexdigest()
    finally:
        end(process, server)
