"""The server as a process of its own."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from web_server import settings_for

from padstudio.errors import StudioError
from padstudio.web.serve import _listen, serve

_PROGRAM = """
import sys
from pathlib import Path
from padstudio.web.serve import serve
if __name__ == "__main__":
    serve(sys.argv[1], 0, Path(sys.argv[2]), announce=lambda url: print(url, flush=True))
"""


@contextlib.contextmanager
def _serving(tmp_path: Path, host: str) -> Iterator[tuple[subprocess.Popen[str], str]]:
    program = tmp_path / "program.py"
    program.write_text(_PROGRAM)
    environment = {k: v for k, v in os.environ.items() if not k.startswith("PADSTUDIO_")}
    process = subprocess.Popen(
        [sys.executable, str(program), host, str(tmp_path / "data")],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=environment,
    )
    with process:
        try:
            assert process.stdout is not None
            yield process, process.stdout.readline().strip()
        finally:
            process.kill()


def test_it_prints_its_address_serves_and_ends_in_order(tmp_path: Path) -> None:
    with _serving(tmp_path, "127.0.0.1") as (process, url):
        with httpx.Client(base_url=url, trust_env=False, timeout=60) as client:
            spec = {"rows": 8, "cols": 8, "ratio": 1}
            made = client.post("/api/v1/pads", json=spec).raise_for_status().json()
            second = subprocess.run(
                [sys.executable, tmp_path / "program.py", "127.0.0.1", tmp_path / "data"],
                capture_output=True,
                text=True,
                check=False,
            )
            assert "another Pad Studio" in second.stderr
            # Ended with a worker process alive and a connection open.
            process.send_signal(signal.SIGTERM)
            process.wait(30)
        assert process.stderr is not None
        assert process.stderr.read() == ""
    with (
        _serving(tmp_path, "127.0.0.1") as (_, url),
        httpx.Client(base_url=url, trust_env=False, timeout=60) as client,
    ):
        assert client.get(f"/api/v1/pads/{made['id']}").status_code == 200


def test_on_the_network_it_makes_up_a_token(tmp_path: Path) -> None:
    with _serving(tmp_path, "0.0.0.0") as (_, url):
        address, token = url.split("/?token=")
        assert len(token) >= 40
        with httpx.Client(base_url=address, trust_env=False, timeout=60) as client:
            assert client.get("/api/v1/pads").status_code == 401
            assert client.get("/", params={"token": token}).status_code == 200
            assert client.get("/api/v1/pads").status_code == 200


def test_a_port_in_use_is_named(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(StudioError, match=f"port {port} is in use") as caught:
            serve("127.0.0.1", port, tmp_path)
    assert caught.value.error_code == "port_in_use"
    assert not list(tmp_path.iterdir())


def test_connections_send_at_once(tmp_path: Path) -> None:
    with _listen(settings_for(tmp_path, port=0)) as listener:
        # Else asyncio leaves TCP_NODELAY off.
        assert listener.proto == socket.IPPROTO_TCP


def test_an_address_of_another_machine(tmp_path: Path) -> None:
    with pytest.raises(StudioError, match="cannot listen on"):
        serve("192.0.2.1", 0, tmp_path)
