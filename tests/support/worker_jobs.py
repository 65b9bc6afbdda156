"""What the workers of the tests do; importable by their processes."""

from __future__ import annotations

import errno
import os
import signal
import time
from pathlib import Path

import numpy as np

from padstudio.errors import SearchExhaustedError
from padstudio.workers.inside import checkpoint


class OddError(SearchExhaustedError):
    """Cannot be made from its message alone, so it does not survive pickling."""

    status = 418
    exit_code = 5

    def __init__(self, message: str, field: int) -> None:
        super().__init__(message, detail={"field": field})


def identify(value: int) -> tuple[int, int]:
    return value, os.getpid()


def refuse() -> None:
    raise OddError("no way on", 3)


def divide() -> float:
    return 1 / 0


def fill_the_disk() -> None:
    raise OSError(errno.ENOSPC, "No space left on device")


def die() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def wait(seconds: float) -> None:
    time.sleep(seconds)


def wait_for(path: Path) -> str:
    while not path.exists():
        time.sleep(0.01)
    return "done"


def step_until(path: Path) -> tuple[str, int]:
    """A task of many steps; tells by a file that it runs."""
    path.with_suffix(".running").touch()
    while not path.exists():
        if checkpoint():
            return "stopped", os.getpid()
        time.sleep(0.01)
    return "done", os.getpid()


def allocate(size_bytes: int) -> int:
    return int(np.ones(size_bytes, np.uint8).sum())


def give_what_cannot_be_sent() -> object:
    return lambda: None


def call_a_new_loop() -> int:
    """The value of a loop that no process has compiled before."""
    from padstudio.compiled import jit

    def total(end: int) -> int:
        found = 0
        for k in range(end):
            found += k
        return found

    return int(jit(total)(10))
