"""What is done to a server while it works; each harm can be done again and again."""

from __future__ import annotations

import contextlib
import os
import random
import signal
import subprocess
import time
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

import psutil
from postgres_server import Cluster
from soak_server import SoakServer

_LIBRARIES = ("faketime/libfaketimeMT.so.1", "faketime/libfaketime.so.1")
_FOLDERS = (*Path("/usr/lib").glob("*-linux-gnu"), Path("/usr/lib"), Path("/usr/local/lib"))
_FULL_S = 6.0
# A server that was told to end by SIGTERM, as shells have it.
_ENDED = 128 + signal.SIGTERM
_STEPS_H = (-5, -1, 0, 1, 5)


class Harms:
    """Harms that can be done here, and how often each was.

    Parameters
    ----------
    server : SoakServer
    chance : random.Random
    disk : Path or None
        A small file system with the data folder, which may be filled.
    clock : Path or None
        The file by which the server's clock is set.
    database : Cluster or None
    """

    def __init__(
        self,
        server: SoakServer,
        chance: random.Random,
        *,
        disk: Path | None,
        clock: Path | None,
        database: Cluster | None,
    ) -> None:
        self._server, self._chance = server, chance
        self._disk, self._clock, self._database = disk, clock, database
        self._full_until = 0.0
        self.done: Counter[str] = Counter()
        self.faults: list[str] = []
        self._kinds: dict[str, Callable[[], None]] = {
            "worker killed": self._kill_worker,
            "server killed": server.kill,
            "group killed": server.kill_group,
            "server ended": self._end,
            "second server": self._second,
        }
        if disk:
            self._kinds["disk full"] = self._fill
        if clock:
            self._kinds["clock set"] = self._set_clock
        if database:
            self._kinds["database restarted"] = self._restart_database

    def one(self) -> None:
        """Do the one that was done least often, by chance among several."""
        least = min(self.done[kind] for kind in self._kinds)
        kind = self._chance.choice([k for k in self._kinds if self.done[k] == least])
        self._kinds[kind]()
        self.done[kind] += 1

    def tend(self, *, over: bool = False) -> None:
        """End what lasts a while when its time is over, or now."""
        if self._disk and self._full_until and (over or time.monotonic() > self._full_until):
            (self._disk / "ballast").unlink()
            self._full_until = 0.0

    def _kill_worker(self) -> None:
        workers = self._server.workers()
        if workers:
            with contextlib.suppress(psutil.Error):
                self._chance.choice(workers).kill()

    def _end(self) -> None:
        code = self._server.end()
        if code != _ENDED:
            self.faults.append(f"a server that was told to end did so with {code}")

    def _second(self) -> None:
        code, said = self._server.second()
        if code != 2 or len(said.splitlines()) != 1:
            self.faults.append(f"a second server on the folder ended with {code}: {said[-300:]}")

    def _fill(self) -> None:
        assert self._disk is not None
        with (self._disk / "ballast").open("wb", buffering=0) as ballast:
            size = 1 << 20
            while size:
                try:
                    ballast.write(b"\0" * size)
                except OSError:
                    size //= 2
        self._full_until = time.monotonic() + self._chance.uniform(1, _FULL_S)

    def _set_clock(self) -> None:
        assert self._clock is not None
        self._clock.write_text(f"{self._chance.choice(_STEPS_H):+d}h\n", encoding="utf-8")

    def _restart_database(self) -> None:
        assert self._database is not None
        self._database.stop(self._chance.choice((signal.SIGINT, signal.SIGQUIT)))
        time.sleep(self._chance.uniform(0, 3))
        self._database.start()


@contextlib.contextmanager
def small_disk(folder: Path, megabytes: int) -> Iterator[Path | None]:
    """A file system of its own at a folder; None where this user may mount none."""
    folder.mkdir()
    options = ["-t", "tmpfs", "-o", f"size={megabytes}m", "tmpfs", str(folder)]
    with contextlib.suppress(OSError):
        if os.geteuid() == 0 and not subprocess.run(["mount", *options], check=False).returncode:
            try:
                yield folder
            finally:
                subprocess.run(["umount", "--lazy", str(folder)], check=False)
            return
    yield None


def faked_time(clock: Path) -> dict[str, str] | None:
    """An environment in which a file sets the clock; None where there is no libfaketime."""
    for name in _LIBRARIES:
        for folder in _FOLDERS:
            if (folder / name).exists():
                clock.write_text("+0\n", encoding="utf-8")
                return {
                    "LD_PRELOAD": str(folder / name),
                    "FAKETIME_TIMESTAMP_FILE": str(clock),
                    "FAKETIME_CACHE_DURATION": "1",
                    "FAKETIME_DONT_FAKE_MONOTONIC": "1",
                    "DONT_FAKE_MONOTONIC": "1",
                }
    return None
