#!/usr/bin/env python3
"""What a server costs that has nothing to do: processor time and memory, of it and its workers.

    bench_idle.py [--seconds S] [--scheduler]

A flight is read first, so that all that is started for one has been; then figures are taken over so
many seconds, of which a server may take 0.5 % of a core. With --scheduler the flight is read by a
cluster of one worker process, and `padstudio worker`, which holds it, is measured like the server;
both let go after 5 s without work.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from contextlib import ExitStack, suppress
from pathlib import Path

import psutil
import studio_server

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import cluster_processes

_MOST_SHARE = 0.005
_MOST_GROWTH_BYTES = 2_000_000
_IDLE_S = "5"
# After so long without work there is none to come.
_SETTLE_S = 10.0


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--scheduler", action="store_true")
    given = parser.parse_args()
    with ExitStack() as opened:
        folder = Path(opened.enter_context(tempfile.TemporaryDirectory()))
        environment: dict[str, str] = {}
        watched: dict[str, psutil.Process] = {}
        if given.scheduler:
            environment, watched["padstudio worker"] = _cluster(opened, folder)
        client, server = opened.enter_context(studio_server.serving(folder / "data", environment))
        (flight,) = studio_server.order(client, studio_server.LANDING, stride=20)
        while client.get(flight).json()["state"] in studio_server.OPEN:
            time.sleep(0.5)
        watched["server"] = server
        for process in watched.values():
            _settled(process)
        return _told(watched, given.seconds)


def _cluster(opened: ExitStack, folder: Path) -> tuple[dict[str, str], psutil.Process]:
    """Settings of a server with a scheduler, and the process that holds its one worker."""
    tls = cluster_processes.certificates(folder)
    _, address = opened.enter_context(cluster_processes.scheduler(tls, folder))
    lent = cluster_processes.worker(tls, address, ("--idle-s", _IDLE_S))
    holder = psutil.Process(opened.enter_context(lent).pid)
    settings = {
        "PADSTUDIO_SCHEDULER": address,
        "PADSTUDIO_SCHEDULER_CA": tls["ca"],
        "PADSTUDIO_SCHEDULER_CERT": tls["cert"],
        "PADSTUDIO_SCHEDULER_KEY": tls["key"],
        "PADSTUDIO_WORKER_IDLE_SECONDS": _IDLE_S,
    }
    return settings, holder


def _settled(server: psutil.Process) -> None:
    """Wait until workers have warmed up, and have given back what they do not need."""
    quiet_s = 0.0
    while quiet_s < _SETTLE_S:
        before = _taken(server)
        time.sleep(1.0)
        quiet_s = quiet_s + 1.0 if _seconds_between(before, _taken(server)) < 0.05 else 0.0


def _told(watched: dict[str, psutil.Process], seconds: float) -> int:
    """Print what each took; 1 where one took too much."""
    before = {name: _taken(process) for name, process in watched.items()}
    time.sleep(seconds)
    is_too_much = False
    for name, process in watched.items():
        after = _taken(process)
        share = _seconds_between(before[name], after) / seconds
        size = sum(size for _, size in after.values())
        growth = size - sum(size for _, size in before[name].values())
        print(
            f"{name}: {100 * share:.2f} % of a core over {seconds:g} s by {len(after)} processes, "
            f"{size / 1e6:.0f} MB, {growth / 1e6:+.1f} MB",
            flush=True,
        )
        is_too_much |= share > _MOST_SHARE or growth > _MOST_GROWTH_BYTES
    return int(is_too_much)


def _taken(process: psutil.Process) -> dict[int, tuple[float, int]]:
    """Processor time, s, and memory, bytes, of a process and of all that it started."""
    found = {}
    for each in (process, *process.children(recursive=True)):
        with suppress(psutil.NoSuchProcess), each.oneshot():
            times = each.cpu_times()
            found[each.pid] = (times.user + times.system, each.memory_info().rss)
    return found


def _seconds_between(
    before: dict[int, tuple[float, int]], after: dict[int, tuple[float, int]]
) -> float:
    return sum(seconds - before.get(pid, (0.0, 0))[0] for pid, (seconds, _) in after.items())


if __name__ == "__main__":
    sys.exit(main())
