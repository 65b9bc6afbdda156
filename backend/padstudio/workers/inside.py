"""A worker process from within: it answers requests, does tasks, and lets requests go first.

A process does one thing at a time. Somebody waits for the answer to a *request*; a *task* may take
minutes, and calls `checkpoint` between its steps, where a request that waits is answered before
the task goes on. Two pipes lead to the pool, one for each. On them the process also says when it
gets a call ready, is at work on it or lays it aside (`padstudio.workers.work_clock`), so that
limits count work alone.
"""

from __future__ import annotations

import ctypes
import logging
import multiprocessing
import os
import pickle
import signal
import sys
import threading
import time
import traceback
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from importlib import import_module
from multiprocessing.connection import Connection, wait
from multiprocessing.reduction import ForkingPickler
from typing import Any

from padstudio.compiled import watch_preparing
from padstudio.errors import LimitError, StudioError, full_disk
from padstudio.workers.work_clock import State, own_s

#: What the process says on the pipe of requests: it is between two steps, and takes one.
READY = "ready"
#: What the pool sends in place of a call that is gone.
NOTHING = b""
# A look at the pipes takes 20 us; a step of a task may be shorter than that.
_LOOK_EVERY_S = 0.005
# After so long without work, memory that is free goes back to the system.
_IDLE_S = 1.0
# From glibc's malloc.h. Large frames come and go; giving their memory back each time costs a
# sixth of a video's time (57 against 67 frames of 12 MB a second). Threads take from one heap: were
# each to keep memory of its own, one that decodes would keep 60 MB of it.
_TRIM_THRESHOLD, _MMAP_THRESHOLD, _KEEP_BYTES = -1, -3, 1 << 28
_ARENA_MAX, _ARENAS = -8, 1

logger = logging.getLogger(__name__)
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


def serve(
    requests: Connection, tasks: Connection, limits: Limits, warming: Sequence[str] = ()
) -> None:
    """The process: answers and works until its pipes close.

    Parameters
    ----------
    requests, tasks : Connection
    limits : Limits
    warming : sequence of str
        Modules whose ``steps`` it takes, one at a time, while nobody asks anything of it.
    """
    global _here
    settle(limits)
    _here = _Here(requests, tasks, warming)
    watch_preparing(_here.prepare)
    _here.serve()


def settle(limits: Limits) -> None:
    """Keep this process within its limits, and end it with the one that started it."""
    # Ctrl-C reaches the whole group; the server ends its workers itself.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _limit(limits)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    """Also in the middle of a step, whose result nobody waits for any more."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)


class _Reporter:
    """Says on a call's pipe what becomes of it; from any thread, and nothing once it is over."""

    def __init__(self, pipe: Connection) -> None:
        self._pipe, self._lock = pipe, threading.Lock()
        self._is_over = False

    def tell(self, state: State) -> None:
        with self._lock:
            if not self._is_over:
                self._pipe.send((state, own_s()))

    def end(self, outcome: bytes) -> None:
        with self._lock:
            self._is_over = True
            self._pipe.send_bytes(outcome)


class _Here:
    """The pipes of this process, and what it is at."""

    def __init__(self, requests: Connection, tasks: Connection, warming: Sequence[str]) -> None:
        self._requests, self._tasks = requests, tasks
        self._warming = deque(warming)
        self._steps: Iterator[object] | None = None
        self._calls: list[_Reporter] = []
        self._task: int | None = None
        self._is_stopped = self._is_answering = False
        self._looked_s = 0.0
        self._preparing = 0
        self._counting = threading.Lock()

    def serve(self) -> None:
        is_idle = True
        while True:
            wait_s = 0 if self._warming else None if is_idle else _IDLE_S
            ready = wait([self._requests, self._tasks], wait_s)
            is_idle = not ready
            if self._warming and is_idle:
                self._warm()
            elif is_idle:
                _give_memory_back()
            try:
                if self._requests in ready:
                    self._answer_request()
                if self._tasks in ready:
                    self._do_task()
            except (EOFError, OSError):
                return

    def _warm(self) -> None:
        """One step of what is to be made ready; who needs it later meets its defect, if any."""
        try:
            if self._steps is None:
                self._steps = iter(import_module(self._warming[0]).steps())
            next(self._steps)
            return
        except StopIteration:
            pass
        except Exception:
            logger.exception("a worker could not be warmed up by %s", self._warming[0])
        self._warming.popleft()
        self._steps = None

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

    def prepare(self, begins: bool) -> None:
        """Loops begin, or cease, to be made ready for the call at hand."""
        with self._counting:
            self._preparing += 1 if begins else -1
            calls = self._calls[-1:] if self._preparing == begins else []
        for call in calls:
            # Where nobody listens any more, the call itself finds out.
            with suppress(OSError):
                call.tell("prepares" if begins else "at_work")

    def _answer_request(self) -> None:
        """Say that this process takes a request; it may be gone by then."""
        self._requests.recv()
        self._requests.send(READY)
        packed = self._requests.recv_bytes()
        if packed != NOTHING:
            self._is_answering = True
            try:
                self._perform(self._requests, packed)
            finally:
                self._is_answering = False

    def _do_task(self) -> None:
        number, packed = self._tasks.recv()
        if packed is None:
            return  # told to stop when it was over already
        self._task, self._is_stopped = number, False
        self._perform(self._tasks, packed)
        self._task = None

    def _perform(self, pipe: Connection, packed: bytes) -> None:
        """Call a function, and say what comes of it; another call at hand is laid aside."""
        call = _Reporter(pipe)
        for other in self._calls:
            other.tell("aside")
        self._calls.append(call)
        call.end(_outcome(packed, lambda: call.tell("at_work")))
        self._calls.remove(call)
        for other in self._calls:
            other.tell("at_work")


def _outcome(packed: bytes, begins: Callable[[], None]) -> bytes:
    """What comes of a call, pickled; a value that cannot be is a defect like others."""
    try:
        # Imports whatever the function needs.
        function, args = pickle.loads(packed)
        begins()
        return bytes(ForkingPickler.dumps(_called(function, args)))
    except Exception:
        return bytes(ForkingPickler.dumps(("defect", traceback.format_exc())))


def _called(function: Callable[..., Any], args: tuple[Any, ...]) -> tuple[str, Any]:
    try:
        return "value", function(*args)
    except StudioError as error:
        return "error", portable(error)
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


def portable(error: StudioError) -> StudioError:
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
