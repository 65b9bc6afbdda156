"""How long a call has been worked on: neither its process's start nor what waits counts."""

from __future__ import annotations

import os
import time
from typing import Literal

#: A process gets a call's function and its loops ready (`prepares`), is `at_work` on it, or lays
#: it `aside` for another call.
State = Literal["prepares", "at_work", "aside"]
# Importing modules and compiling all loops takes a minute; only what hangs takes longer.
_PREPARE_S = 900.0


class WorkClock:
    """Adds up the time that a process is at work on one call, which begins with `prepares`.

    Parameters
    ----------
    limit_s : float or None
        Time that the work may take; None sets no limit to anything.
    now_s : float
        By `own_s`, as all times.
    """

    def __init__(self, limit_s: float | None, now_s: float) -> None:
        self._limit_s = limit_s
        self._state: State = "prepares"
        self._since_s, self._worked_s = now_s, 0.0

    def turn(self, state: State, now_s: float) -> None:
        """From a time on the process is in another state."""
        if self._state == "at_work":
            self._worked_s += now_s - self._since_s
        self._state, self._since_s = state, now_s

    def left_s(self, now_s: float) -> float | None:
        """Seconds until the time is over, if nothing changes; None where it does not run out."""
        if self._limit_s is None or self._state == "aside":
            return None
        if self._state == "prepares":
            return self._since_s + _PREPARE_S - now_s
        return self._limit_s - self._worked_s - (now_s - self._since_s)


def own_s(pid: int | None = None) -> float:
    """A clock that stands while a process is ready and has no core.

    What a process waits for a core is not its work: a busy machine answers late. Elsewhere than on
    Linux the clock never stands.

    Parameters
    ----------
    pid : int, optional
        This process's unless given; clocks of one process agree wherever they are read.
    """
    return time.monotonic() - _queued_s(os.getpid() if pid is None else pid)


def _queued_s(pid: int) -> float:
    try:
        # proc(5) leaves it out: time on a core, time waiting for one, in ns, and turns.
        with open(f"/proc/{pid}/schedstat", encoding="ascii") as file:
            return int(file.read().split()[1]) / 1e9
    except (OSError, ValueError, IndexError):
        return 0.0
