#!/usr/bin/env python3
"""Harms a server in every way while it works on 200 flights, and counts what was lost or doubled.

    run.py [--minutes N] [--jobs N] [--seed N] [--databases NAME …]

Half of the flights are worked on with SQLite on a small disk, half with a PostgreSQL of the
script's own. What cannot be done on this machine (a small disk needs root, clocks libfaketime) is
said, and left out. Ends with 1 where a frame is missing, there twice, or not what an undisturbed
run gives.
"""

from __future__ import annotations

import argparse
import contextlib
import random
import signal
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parents[1] / "support")]

import postgres_server  # noqa: E402
from soak_harms import Harms, faked_time, small_disk  # noqa: E402
from soak_server import SoakServer  # noqa: E402
from soak_work import AwayError, Count, Work  # noqa: E402

_DISK_MB = 200
# Between two harms, s: so long and until a flight has ended, but not longer than the last.
_PEACE_S, _MOST_PEACE_S = (1.0, 5.0), 25.0
# Of the time, at the end, without harms, so that what is open can be done.
_QUIET_SHARE = 0.25
_SETTINGS = {
    "PADSTUDIO_WORKERS": "2",
    "PADSTUDIO_CHUNK_FRAMES": "6",
    "PADSTUDIO_CHUNK_ATTEMPTS": "20",
}


@dataclass
class Trial:
    """What became of the jobs on one database."""

    database: str
    jobs: int
    harms: Harms
    count: Count
    seconds: float


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=20, help="most time, for all")
    parser.add_argument("--jobs", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    names = ("SQLite", "PostgreSQL")
    parser.add_argument("--databases", nargs="+", choices=names, default=names, metavar="NAME")
    given = parser.parse_args()
    # Ends as by Ctrl-C: the server and the small disk go, too.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))
    chance = random.Random(given.seed)
    parts = len(given.databases)
    jobs, most_s = given.jobs // parts, given.minutes * 60 / parts
    trials = [trial(name, jobs, most_s, chance) for name in given.databases]
    _print(trials)
    return any(t.harms.faults or not t.count.is_good for t in trials)


def trial(database: str, jobs: int, most_s: float, chance: random.Random) -> Trial:
    """Work on jobs until they are done, with harms but toward the end."""
    with contextlib.ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="padstudio-soak-")))
        disk = stack.enter_context(small_disk(folder / "disk", _DISK_MB))
        if disk is None:
            print("no disk is filled: mounting a small one needs root")
        clock = folder / "clock"
        faked = faked_time(clock)
        if faked is None:
            print("no clock is set: libfaketime is missing")
        environment = _SETTINGS | (faked or {})
        cluster = None
        if database == "PostgreSQL":
            cluster = stack.enter_context(_cluster())
            environment["PADSTUDIO_DATABASE_URL"] = cluster.url
        data = folder / "disk" / "data"
        log = Path(tempfile.gettempdir()) / f"padstudio-soak-{database}.log"
        log.write_text("", encoding="utf-8")
        server = SoakServer(data, log, environment)
        stack.callback(server.kill_group)
        harms = Harms(server, chance, disk=disk, clock=clock if faked else None, database=cluster)
        begun = time.monotonic()
        count = _work(server, harms, jobs, most_s, chance)
        print(f"{database}: {count}; the server's log is in {log}", flush=True)
        return Trial(database, jobs, harms, count, time.monotonic() - begun)


def _work(
    server: SoakServer, harms: Harms, jobs: int, most_s: float, chance: random.Random
) -> Count:
    assert server.see_that_it_runs()
    work = Work(server.client, jobs)
    end = time.monotonic() + most_s
    next_harm, last_harm, over = 0.0, 0.0, -1
    while work.over < jobs and time.monotonic() < end:
        harms.tend()
        if server.see_that_it_runs():
            with contextlib.suppress(AwayError):
                work.go_on(server.client)
        now = time.monotonic()
        is_due = now > next_harm and (work.over > over or now > last_harm + _MOST_PEACE_S)
        if is_due and now < end - _QUIET_SHARE * most_s:
            harms.one()
            last_harm, over = time.monotonic(), work.over
            next_harm = last_harm + chance.uniform(*_PEACE_S)
            print(f"{work.over} of {jobs} flights are over; {dict(harms.done)}", flush=True)
        time.sleep(0.1)
    harms.tend(over=True)
    while True:
        with contextlib.suppress(AwayError):
            server.see_that_it_runs()
            work.go_on(server.client)
            harms.faults += work.faults
            return work.count()
        time.sleep(1)


@contextlib.contextmanager
def _cluster() -> Iterator[postgres_server.Cluster]:
    # Open to the user that PostgreSQL runs as.
    with tempfile.TemporaryDirectory(prefix="padstudio-pg-") as name:
        cluster = postgres_server.Cluster(Path(name))
        cluster.start()
        try:
            yield cluster
        finally:
            cluster.stop()


def _print(trials: list[Trial]) -> None:
    """The table, as in docs/reliability.md."""
    kinds = sorted({kind for each in trials for kind in each.harms.done})
    rows = [
        ("flights", [str(each.jobs) for each in trials]),
        ("frames", [str(each.count.frames) for each in trials]),
        *((kind, [str(each.harms.done[kind]) for each in trials]) for kind in kinds),
        ("frames lost", [str(each.count.lost) for each in trials]),
        ("frames doubled", [str(each.count.doubled) for each in trials]),
        ("frames other than undisturbed", [str(each.count.different) for each in trials]),
        ("frames taken back", [str(each.count.taken_back) for each in trials]),
        ("flights failed", [str(each.count.failed) for each in trials]),
        ("flights unfinished", [str(each.count.unfinished) for each in trials]),
        ("minutes", [f"{each.seconds / 60:.1f}" for each in trials]),
    ]
    print("\n| | " + " | ".join(each.database for each in trials) + " |")
    print("|---|" + "---|" * len(trials))
    for name, cells in rows:
        print(f"| {name} | {' | '.join(cells)} |")
    for each in trials:
        for fault in [*each.harms.faults, *map(str, each.count.errors)]:
            print(f"{each.database}: {fault}")


if __name__ == "__main__":
    sys.exit(main())
