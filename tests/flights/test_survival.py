"""Whatever is killed, every frame of every flight is there once in the end."""

from __future__ import annotations

import contextlib
import random
import signal
import sqlite3
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import flight_orders
import psutil
import service_process
import videos

from padstudio.store.store import Store

FLIGHTS, FRAMES = 60, 6
PATIENCE_S = 900


def order_flights(data: Path, video: Path) -> None:
    store = Store(data)
    upload = flight_orders.upload(store, video)
    service = service_process.open_service(store, data, service_process.open_pool())
    for _ in range(FLIGHTS):
        service.order(flight_orders.order(upload))
    store.close()


@contextlib.contextmanager
def server(data: Path, end: signal.Signals) -> Iterator[psutil.Process]:
    script = Path(service_process.__file__)
    process = subprocess.Popen([sys.executable, str(script), str(data)], cwd=script.parent)
    watched = psutil.Process(process.pid)
    try:
        yield watched
    finally:
        workers = worker_processes(watched)
        process.send_signal(end)
        process.wait(60)
        # Nobody is left to work for: workers of a killed server go by themselves.
        assert not psutil.wait_procs(workers, timeout=60)[1]


def worker_processes(process: psutil.Process) -> list[psutil.Process]:
    """The workers among a server's children."""
    found = []
    for child in process.children(recursive=True):
        with contextlib.suppress(psutil.Error):
            if "spawn_main" in " ".join(child.cmdline()):
                found.append(child)
    return found


def done(data: Path) -> tuple[int, int]:
    """Flights that are over, and frames that are there."""
    with contextlib.closing(sqlite3.connect(data / "padstudio.db", timeout=30)) as database:
        over = "SELECT count(*) FROM flights WHERE state NOT IN ('queued', 'running')"
        frames = "SELECT count(*) FROM frames"
        return database.execute(over).fetchone()[0], database.execute(frames).fetchone()[0]


def work_until(data: Path, server: psutil.Process, flights: int, *, kill: random.Random) -> int:
    """Wait until some flights are over, and kill a worker now and then; how many were killed."""
    killed, next_kill = 0, done(data)[0] + kill.randint(5, 12)
    give_up = time.monotonic() + PATIENCE_S
    while (over := done(data)[0]) < flights:
        assert server.is_running()
        assert time.monotonic() < give_up
        if over >= next_kill and (workers := worker_processes(server)):
            with contextlib.suppress(psutil.Error):
                kill.choice(workers).kill()
                killed += 1
            next_kill = over + kill.randint(5, 12)
        time.sleep(0.05)
    return killed


def test_every_frame_is_there_once(tmp_path: Path) -> None:
    data = tmp_path / "data"
    video = videos.write(tmp_path / "a.mp4", FRAMES, keyframe_every=3, paint=videos.blank)
    order_flights(data, video)
    kill = random.Random(7)
    killed = 0
    lives = ((FLIGHTS // 3, signal.SIGKILL), (2 * FLIGHTS // 3, signal.SIGTERM))
    for flights, end in (*lives, (FLIGHTS, signal.SIGTERM)):
        with server(data, end) as process:
            killed += work_until(data, process, flights, kill=kill)
    assert killed >= 3
    with contextlib.closing(sqlite3.connect(data / "padstudio.db")) as database:
        states = database.execute(
            "SELECT state, frames_total, frames_done, count(*) FROM flights GROUP BY 1, 2, 3"
        ).fetchall()
        assert states == [("done", FRAMES, FRAMES, FLIGHTS)]
        for table in ("frames", "frame_details"):
            numbers = database.execute(
                f"SELECT flight, group_concat(number) FROM "
                f"(SELECT flight, number FROM {table} ORDER BY flight, number) GROUP BY flight"
            ).fetchall()
            assert len(numbers) == FLIGHTS
            assert {found for _, found in numbers} == {"0,1,2,3,4,5"}
        open_chunks = "SELECT count(*) FROM chunks WHERE state != 'done'"
        assert database.execute(open_chunks).fetchone() == (0,)
