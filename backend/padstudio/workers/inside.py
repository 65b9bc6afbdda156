"""A worker process from within: it answers requests, does tasks, and lets requests go first.

A process does one thing at a time. Somebody waits for the answer to a *request*; a *task* may take
minutes, and calls `checkpoint` between its steps, where a request that waits is answered before
the task goes on. Two pipes lead to the pool, one for each.
"""

from __future__ import annotations

import ctypes
import multiprocessing
import os
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.reduction import ForkingPickler
from typing import Any

from padstudio.errors import LimitError, StudioError, full_disk

#: What the process says on the pipe of requests: it is between two steps, and takes one.
READY = "ready"
# A look at the pipes takes 20 us; a step of a task may be shorter than that.
_LOOK_EVERY_S = 0.005
# After so long without work, memory that is free goes back to the system.
_IDLE_S = 1.0
# From glibc's malloc.h. Large frames come and go; giving their memory back each time costs a
# sixth of a video's time (57 against 67 frames of 12 MB a second). Threads take from one heap: were
# each to keep memory of its own, one that decodes would keep 60 MB of it.
_TRIM_THRESHOLD, _MMAP_THRESHOLD, _KEEP_BYTES = -1, -3, 1 << 28
_ARENA_MAX, _ARENAS = -8, 1

_here: _Here | None = None


@dataclass(frozen=True)
class Limits:
    """What a worker process may take.

    Attributes
    ----------
    memory_bytes : int
        Data that it may allocate; enforced on Linux.
    niceness : int
        Its priority: 0 is that of other programs, 19 the least.
    """

    memory_bytes: int
    niceness: int = 0


def checkpoint() -> bool:
    """Answer a request that waits; for tasks, between two steps.

    Returns
    -------
    bool
        True where the task is told to stop. Outside of worker processes always False.
    """
    return _here is not None and _here.checkpoint()


def serve(requests: Connection, tasks: Connection, limits: Limits) -> None:
    """The process: answers and works until its pipes close."""
    global _here
    # Ctrl-C reaches the whole group; the server ends its workers itself.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _limit(limits)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    _here = _Here(requests, tasks)
    _here.serve()


def _end_with_parent() -> None:
    """Also in the middle of a step, whose result nobody waits for any more."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)


class _Here:
    """The pipes of this process, and what it is at."""

    def __init__(self, requests: Connection, tasks: Connection) -> None:
        self._requests, self._tasks = requests, tasks
        self._task: int | None = None
        self._is_stopped = self._is_answering = False
        self._looked_s = 0.0

    def serve(self) -> None:
        is_idle = True
        while True:
            ready = wait([self._requests, self._tasks], None if is_idle else _IDLE_S)
            is_idle = not ready
            if is_idle:
                _give_memory_back()
            try:
                if self._requests in ready:
                    self._answer_request()
                if self._tasks in ready:
                    self._do_task()
            except (EOFError, OSError):
                return

    def checkpoint(self) -> bool:
        now_s = time.monotonic()
        if self._task is None or self._is_answering or now_s - self._looked_s < _LOOK_EVERY_S:
            return self._is_stopped
        try:
            while self._tasks.poll():
                self._is_stopped |= self._tasks.recv()[0] == self._task
            while self._requests.poll():
                self._answer_request()
        except (EOFError, OSError):
            # Nobody is left to work for.
            raise SystemExit from None
        self._looked_s = time.monotonic()
        return self._is_stopped

    def _answer_request(self) -> None:
        """Say that this process takes a request; it may be gone by then."""
        self._requests.recv()
        self._requests.send(READY)
        call = self._requests.recv()
        if call is not None:
            self._is_answering = True
            try:
                self._requests.send_bytes(_outcome(*call))
            finally:
                self._is_answering = False

    def _do_task(self) -> None:
        number, *call = self._tasks.recv()
        if not call:
            return  # told to stop when it was over already
        self._task, self._is_stopped = number, False
        self._tasks.send_bytes(_outcome(*call))
        self._task = None


def _outcome(function: Callable[..., Any], args: tuple[Any, ...]) -> bytes:
    """What comes of a call, pickled; a value that cannot be is a defect like others."""
    try:
        return bytes(ForkingPickler.dumps(_called(function, args)))
    except Exception:
        return bytes(ForkingPickler.dumps(("defect", traceback.format_exc())))


def _called(function: Callable[..., Any], args: tuple[Any, ...]) -> tuple[str, Any]:
    try:
        return "value", function(*args)
    except StudioError as error:
        return "error", _portable(error)
    except Exception as error:
        known = known_fault(error)
        return ("error", known) if known else ("defect", traceback.format_exc())


def known_fault(error: Exception) -> StudioError | None:
    """What went wrong by name, where it is the machine's fault: no memory, or no disk."""
    # OpenCV has an exception of its own, with this text and code.
    if isinstance(error, MemoryError) or "Insufficient memory" in str(error):
        return LimitError(
            "the work needs more memory than a worker may take; try something smaller"
        )
    return full_disk(error)


def _portable(error: StudioError) -> StudioError:
    """The error as its nearest class of `padstudio.errors`; others need not survive pickling."""
    for base in type(error).__mro__:
        if issubclass(base, StudioError) and base.__module__ == StudioError.__module__:
            found = base(error.message, code=error.error_code, detail=error.detail)
            # What its own class says goes with it.
            vars(found).update(status=error.status, exit_code=error.exit_code)
            return found
    raise AssertionError("every StudioError descends from padstudio.errors")


def _limit(limits: Limits) -> None:
    # Where every core has a worker, threads of linear algebra wait for each other, ten times as
    # long as they compute. NumPy reads this when it is first imported.
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    if hasattr(os, "nice"):
        os.nice(max(0, limits.niceness - os.nice(0)))
    if sys.platform == "linux":
        import resource

        # Data rather than address space: threads and allocators reserve far more than they use.
        resource.setrlimit(resource.RLIMIT_DATA, (limits.memory_bytes, limits.memory_bytes))
        _libc("mallopt", _TRIM_THRESHOLD, _KEEP_BYTES)
        _libc("mallopt", _MMAP_THRESHOLD, _KEEP_BYTES)
        _libc("mallopt", _ARENA_MAX, _ARENAS)


def _give_memory_back() -> None:
    if sys.platform == "linux":
        _libc("malloc_trim", 0)


def _libc(name: str, *args: int) -> None:
    """Call a function of glibc, which other C libraries lack."""
    function = getattr(ctypes.CDLL(None), name, None)
    if function is not None:
        function(*args)
