"""Tasks of the engine's tests; importable by its workers."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from padstudio.errors import SpecError, TaskStoppedError


@dataclass(frozen=True)
class Say:
    """Gives a value and the worker's process id."""

    value: int

    def run(self, stopped: Callable[[], bool]) -> tuple[int, int]:
        return self.value, os.getpid()


@dataclass(frozen=True)
class Refuse:
    def run(self, stopped: Callable[[], bool]) -> None:
        raise SpecError("no way on", code="no_way", detail={"place": 3})


@dataclass(frozen=True)
class Break:
    def run(self, stopped: Callable[[], bool]) -> float:
        return 1 / 0


@dataclass(frozen=True)
class Die:
    def run(self, stopped: Callable[[], bool]) -> None:
        os.kill(os.getpid(), signal.SIGKILL)


def unknown_here() -> None:
    """What a worker of another version does with a task."""
    raise ImportError("no such module in this version")


class Foreign:
    """A task that a worker cannot read."""

    def __reduce__(self) -> tuple[Callable[[], None], tuple[()]]:
        return unknown_here, ()

    def run(self, stopped: Callable[[], bool]) -> None:
        raise AssertionError("nobody can read it")


@dataclass(frozen=True)
class WaitForStop:
    """Tells by a file that it runs, and by another that it was stopped."""

    folder: Path

    def run(self, stopped: Callable[[], bool]) -> None:
        (self.folder / "running").touch()
        while not stopped():
            time.sleep(0.01)
        (self.folder / "stopped").touch()
        raise TaskStoppedError
