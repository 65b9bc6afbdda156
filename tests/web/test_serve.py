"""The server as a process of its own."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import sqlite3
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import httpx
import pytest
from flight_api import Api
from places import FOOTAGE
from web_server import settings_for

from padstudio.store.store import Store
from padstudio.web.serve import listen

#: The first bytes of an MP4, and some more.
VIDEO_HEAD = b"\x00\x00\x00\x18ftypmp42\x00\x00\x00\x00mp42isom" + bytes(100_000)

_PROGRAM = """
import sys
from pathlib import Path
from padstudio.web.serve import serve
if __name__ == "__main__":
    serve(sys.argv[1], 0, Path(sys.argv[2]), announce=lambda url: print(url, flush=True))
"""


def _environment(**settings: str) -> dict[str, str]:
    return {k: v for k, v in os.environ.items() if not k.startswith("PADSTUDIO_")} | settings


@contextlib.contextmanager
def _serving(
    tmp_path: Path, host: str, data: Path | None = None
) -> Iterator[tuple[subprocess.Popen[str], str]]:
    program = tmp_path / "program.py"
    program.write_text(_PROGRAM)
    process = subprocess.Popen(
        [sys.executable, str(program), host, str(data or tmp_path / "data")],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=_environment(),
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


def test_connections_send_at_once(tmp_path: Path) -> None:
    with listen(settings_for(tmp_path, port=0)) as listener:
        # Else asyncio leaves TCP_NODELAY off.
        assert listener.proto == socket.IPPROTO_TCP


#: Signs that mean something in addresses of databases, in patterns of names, in formats.
ODD_NAMES = ("what?mode=memory", "part#1", "100%d of 5%20", "it's a folder: naïve [1]*", "-data")


def test_the_data_folder_may_have_any_name(tmp_path: Path) -> None:
    data = tmp_path.joinpath(*ODD_NAMES)
    with (
        _serving(tmp_path, "127.0.0.1", data) as (_, url),
        httpx.Client(base_url=url, trust_env=False, timeout=60) as client,
    ):
        api = Api(client, data)
        found = api.finished(api.order(stride=10).raise_for_status().json()["id"])
        assert (found["state"], found["frames_ok"]) == ("done", found["frames_total"])
        frame = f"/api/v1/flights/{found['id']}/frames/0"
        assert client.get(f"{frame}/stages").raise_for_status().json()
    assert (data / "padstudio.db").stat().st_size > 0
    assert {path.name for path in tmp_path.iterdir()} == {"program.py", ODD_NAMES[0]}


def _padstudio(*words: str, **settings: str) -> subprocess.CompletedProcess[str]:
    code = "from padstudio.cli.program import main; main()"
    return subprocess.run(
        [sys.executable, "-c", code, *words],
        capture_output=True,
        text=True,
        env=_environment(**settings),
        timeout=120,
        check=False,
    )


def _in_use(data: Path) -> Store:
    return Store(data)


def _a_file(data: Path) -> None:
    data.touch()


def _not_writable(data: Path) -> None:
    # Root may write wherever there is a disk.
    data.symlink_to("/proc/self" if Path("/proc/self").exists() else "/dev/fd")


def _other_bytes(data: Path) -> None:
    data.mkdir()
    (data / "padstudio.db").write_bytes(b"no database at all. " * 300)


def _cut(data: Path) -> None:
    Store(data).close()
    database = data / "padstudio.db"
    whole = database.read_bytes()
    database.write_bytes(whole[:100] + b"\xff" * (len(whole) - 100))


def _with_sql(data: Path, statement: str) -> None:
    with contextlib.closing(sqlite3.connect(data / "padstudio.db")) as database:
        database.execute(statement)
        database.commit()


def _newer(data: Path) -> None:
    Store(data).close()
    _with_sql(data, "UPDATE alembic_version SET version_num = '9999'")


def _foreign(data: Path) -> None:
    data.mkdir()
    _with_sql(data, "CREATE TABLE pads (made_by_somebody_else TEXT)")


@pytest.mark.parametrize(
    ("prepare", "code"),
    [
        (_in_use, "data_folder_in_use"),
        (_a_file, "data_folder_unusable"),
        (_not_writable, "data_folder_unusable"),
        (_other_bytes, "database_damaged"),
        (_cut, "database_damaged"),
        (_newer, "newer_database"),
        (_foreign, "foreign_database"),
    ],
)
def test_a_data_folder_that_cannot_be_used_is_one_line(
    prepare: Callable[[Path], Store | None], code: str, tmp_path: Path
) -> None:
    store = prepare(tmp_path / "data")
    ended = _padstudio("serve", "--port", "0", "--data", str(tmp_path / "data"))
    assert ended.returncode == 2
    assert ended.stdout == ""
    assert ended.stderr.startswith("error: ")
    assert ended.stderr.endswith(f"({code})\n")
    assert ended.stderr.count("\n") == 1
    if store is not None:
        store.close()


@pytest.mark.parametrize(
    ("url", "code"),
    [
        ("postgresql://user:hidden-word@127.0.0.1:1/name", "database_unreachable"),
        ("sqlite:////no/such/folder/at.all", "database_unreachable"),
        ("hidden-word", "invalid_database_url"),
        ("oracle9://user:hidden-word@host/name", "invalid_database_url"),
    ],
)
def test_a_database_that_cannot_be_reached_is_one_line(url: str, code: str, tmp_path: Path) -> None:
    ended = _padstudio(
        "serve", "--port", "0", "--data", str(tmp_path / "data"), PADSTUDIO_DATABASE_URL=url
    )
    assert (ended.returncode, ended.stdout) == (2, "")
    assert ended.stderr.endswith(f"({code})\n")
    assert ended.stderr.count("\n") == 1
    assert "hidden-word" not in ended.stderr
    assert "sqlalche.me" not in ended.stderr
    # Whoever mends the address may use the folder.
    Store(tmp_path / "data").close()


@pytest.mark.parametrize(
    ("words", "settings", "code"),
    [
        (("--port", "{taken}"), {}, "port_in_use"),
        (("--host", "192.0.2.1"), {}, "cannot_listen"),
        (("--host", "no.such.host.invalid"), {}, "cannot_listen"),
        ((), {"PADSTUDIO_WORKERS": "none"}, "invalid_setting"),
        ((), {"PADSTUDIO_SCHEDULER": "tcp://127.0.0.1:8786"}, "invalid_setting"),
    ],
)
def test_where_it_cannot_listen_and_settings_that_are_wrong_are_one_line(
    words: tuple[str, ...], settings: dict[str, str], code: str, tmp_path: Path
) -> None:
    data = str(tmp_path / "data")
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        given = [word.format(taken=port) for word in words or ("--port", "0")]
        ended = _padstudio("serve", "--data", data, *given, **settings)
    assert (ended.returncode, ended.stdout) == (2, "")
    assert ended.stderr.startswith("error: ")
    assert ended.stderr.endswith(f"({code})\n")
    assert ended.stderr.count("\n") == 1
    if code == "port_in_use":
        assert f"port {port} is in use" in ended.stderr
    assert not any(tmp_path.iterdir())


#: A server that has much to do is gone within so long, s.
GONE_S = 5.0
STREAMS = 20


def _waited_s(pid: int) -> float:
    """How long a process was ready to run and had no processor, s; where the system tells."""
    with contextlib.suppress(OSError):
        return int(Path(f"/proc/{pid}/schedstat").read_text().split()[1]) / 1e9
    return 0.0


def _told_to_end(process: subprocess.Popen[str]) -> float:
    """End a server; the seconds that it took, without those in which others had the processors."""
    process.send_signal(signal.SIGTERM)
    began_s, before_s = time.monotonic(), _waited_s(process.pid)
    after_s = before_s
    while process.poll() is None:
        after_s = max(after_s, _waited_s(process.pid))
        assert time.monotonic() - began_s < 120
        time.sleep(0.01)
    return time.monotonic() - began_s - (after_s - before_s)


def _is_in_order(answer: httpx.Response) -> bool:
    """Done, or refused because the server ends."""
    if answer.status_code < 300:
        return True
    error = answer.json()["error"]
    assert set(error) == {"code", "message", "detail"}
    return (answer.status_code, error["code"]) == (503, "shutting_down")


def test_a_busy_server_ends_in_order(tmp_path: Path) -> None:
    with (
        _serving(tmp_path, "127.0.0.1") as (process, url),
        httpx.Client(base_url=url, trust_env=False, timeout=120) as client,
        ThreadPoolExecutor(STREAMS + 3) as threads,
    ):
        api = Api(client, tmp_path / "data")
        flight = api.order().raise_for_status().json()["id"]
        announced = client.post(
            "/api/v1/uploads", headers={"Tus-Resumable": "1.0.0", "Upload-Length": "1000000"}
        )
        upload = announced.headers["Location"]
        order = {"pad": api.pad, "camera": api.camera}
        client.post("/api/v1/live", json={**order, "source": "browser"}).raise_for_status()
        client.post("/api/v1/simulations", json={**order, "frames": 300}).raise_for_status()
        arrived, hold, told = threading.Event(), threading.Event(), threading.Semaphore(0)

        def watch() -> list[str]:
            lines = []
            with client.stream("GET", f"/api/v1/flights/{flight}/events") as answer:
                for line in answer.iter_lines():
                    if not lines:
                        told.release()
                    lines.append(line)
            return lines

        def half() -> Iterator[bytes]:
            yield VIDEO_HEAD
            arrived.set()
            hold.wait(120)

        def append() -> httpx.Response:
            headers = {
                "Tus-Resumable": "1.0.0",
                "Upload-Offset": "0",
                "Content-Type": "application/offset+octet-stream",
            }
            return client.patch(upload, content=half(), headers=headers)

        watching = [threads.submit(watch) for _ in range(STREAMS)]
        sending = threads.submit(append)
        # Takes minutes: it is near what there is.
        spec = {"rows": 140, "cols": 140, "ratio": 1, "distance": 3}
        waiting = threads.submit(client.post, "/api/v1/pads", json=spec)
        # Waits for a worker, or is at work in one.
        picture = {"image": (FOOTAGE / "stills" / "a_cast0_1300.jpg").read_bytes()}
        detecting = threads.submit(client.post, "/api/v1/detect", files=picture, data=order)
        assert arrived.wait(60)
        for _ in watching:
            assert told.acquire(timeout=60)
        assert (took_s := _told_to_end(process)) < GONE_S, took_s
        hold.set()
        for watched in watching:
            assert watched.result()[0] == "event: flight"
        assert _is_in_order(detecting.result())
        assert waiting.result().json()["error"]["code"] == "shutting_down"
        assert sending.result().json()["error"]["code"] == "shutting_down"
        assert process.stderr is not None
        assert process.stderr.read() == ""
    with contextlib.closing(Store(tmp_path / "data")) as store:
        assert store.uploads.get(upload.rsplit("/", 1)[-1]).offset == len(VIDEO_HEAD)
