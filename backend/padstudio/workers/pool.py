"""Processes that do what must not harm or hold up the server.

Each takes one call at a time. A call that exceeds its time is ended with its process; a process
that dies costs its caller an error; the next call gets a new process.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import sys
import threading
import traceback
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from multiprocessing.connection import Connection
from typing import Any, TypeVar

from padstudio.errors import (
    BusyError,
    LimitError,
    StudioError,
    TimeLimitError,
    WorkerCrashError,
    full_disk,
)

ResultT = TypeVar("ResultT")
# A fork of a threaded server may inherit locks that nobody will release.
_context = multiprocessing.get_context("spawn")


class WorkerPool:
    """A few worker processes, started when first needed.

    Parameters
    ----------
    size : int
        Number of processes.
    memory_bytes : int
        Data that each may allocate; enforced on Linux.
    max_waiting : int
        Calls that may wait for a process.
    """

    def __init__(self, size: int, memory_bytes: int, max_waiting: int) -> None:
        self._room = threading.BoundedSemaphore(size + max_waiting)
        self._memory_bytes = memory_bytes
        self._mine = threading.local()
        self._workers: list[_Worker] = []
        # One thread drives one process, so that neither needs a queue of its own.
        self._threads = ThreadPoolExecutor(size, thread_name_prefix="worker")

    def submit(
        self, function: Callable[..., ResultT], *args: Any, timeout_s: float
    ) -> Future[ResultT]:
        """Call a function in a worker process.

        Parameters
        ----------
        function : callable
            Importable by name.
        *args : object
            Picklable.
        timeout_s : float
            Time for the call itself, without the wait for a process.

        Returns
        -------
        Future
            Of the function's value; or of its own `StudioError`, `TimeLimitError`,
            `WorkerCrashError`, or `LimitError` where it ran out of memory.

        Raises
        ------
        BusyError
            If too many calls wait.
        """
        if not self._room.acquire(blocking=False):
            raise BusyError(
                "the server is busy with as many pictures and pads as it takes at a time; try "
                "again in a moment"
            )
        try:
            future = self._threads.submit(self._call, function, args, timeout_s)
        except BaseException:
            self._room.release()
            raise
        future.add_done_callback(lambda _: self._room.release())
        return future

    def close(self) -> None:
        """End the processes; calls at work fail."""
        self._threads.shutdown(wait=False, cancel_futures=True)
        for worker in self._workers:
            worker.kill()
        self._threads.shutdown(wait=True)
        for worker in self._workers:
            worker.stop()

    def _call(
        self, function: Callable[..., ResultT], args: tuple[Any, ...], timeout_s: float
    ) -> ResultT:
        worker = getattr(self._mine, "worker", None)
        if worker is None:
            worker = self._mine.worker = _Worker(self._memory_bytes)
            self._workers.append(worker)
        value: ResultT = worker.call(function, args, timeout_s)
        return value


class _Worker:
    """One process and the pipe to it."""

    def __init__(self, memory_bytes: int) -> None:
        self._memory_bytes = memory_bytes
        self._process: multiprocessing.process.BaseProcess | None = None
        self._pipe: Connection | None = None

    def call(self, function: Callable[..., Any], args: tuple[Any, ...], timeout_s: float) -> Any:
        pipe = self._started()
        try:
            pipe.send((function, args))
            if not pipe.poll(timeout_s):
                self.stop()
                raise TimeLimitError(
                    f"the work took longer than {timeout_s:g} s and was ended; try something "
                    "smaller, or raise the limit in the settings"
                )
            kind, value = pipe.recv()
        except (EOFError, OSError) as error:
            self.stop()
            raise WorkerCrashError(
                "the process that worked on this died, most likely for lack of memory or of a "
                "damaged file; try a smaller or repaired one"
            ) from error
        if kind == "defect":
            defect = RuntimeError(f"{function.__qualname__} failed in a worker")
            defect.add_note(value)
            raise defect
        if kind == "error":
            raise value
        return value

    def kill(self) -> None:
        """End the process at once; safe while another thread waits in `call`."""
        process = self._process
        if process is not None:
            with contextlib.suppress(ValueError):  # closed in between
                process.kill()

    def stop(self) -> None:
        """End the process and let go of it."""
        process, self._process = self._process, None
        if process is not None:
            process.kill()
            process.join()
            process.close()
        if self._pipe is not None:
            self._pipe.close()

    def _started(self) -> Connection:
        if self._process is None or self._pipe is None or not self._process.is_alive():
            self.stop()
            self._pipe, theirs = _context.Pipe()
            self._process = _context.Process(
                target=_serve, args=(theirs, self._memory_bytes), daemon=True
            )
            self._process.start()
            theirs.close()
        return self._pipe


def _serve(pipe: Connection, memory_bytes: int) -> None:
    """The worker process: answers calls until its pipe closes."""
    # Ctrl-C reaches the whole group; the server ends its workers itself.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _limit_memory(memory_bytes)
    # Where every core has a worker, threads of linear algebra wait for each other, ten times as
    # long as they compute. NumPy reads this when it is first imported.
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    while True:
        try:
            function, args = pipe.recv()
        except EOFError:
            return
        pipe.send(_answer(function, args))


def _answer(function: Callable[..., Any], args: tuple[Any, ...]) -> tuple[str, Any]:
    try:
        return "value", function(*args)
    except StudioError as error:
        return "error", _portable(error)
    except Exception as error:
        if _out_of_memory(error):
            return "error", LimitError(
                "the work needs more memory than a worker may take; try something smaller"
            )
        full = full_disk(error)
        return ("error", full) if full else ("defect", traceback.format_exc())


def _portable(error: StudioError) -> StudioError:
    """The error as its nearest class of `padstudio.errors`; others need not survive pickling."""
    for base in type(error).__mro__:
        if issubclass(base, StudioError) and base.__module__ == StudioError.__module__:
            return base(error.message, code=error.error_code, detail=error.detail)
    raise AssertionError("every StudioError descends from padstudio.errors")


def _out_of_memory(error: Exception) -> bool:
    # OpenCV has an exception of its own, with this text and code.
    return isinstance(error, MemoryError) or "Insufficient memory" in str(error)


def _limit_memory(memory_bytes: int) -> None:
    if sys.platform != "linux":
        return
    import resource

    # Data rather than address space: threads and allocators reserve far more than they use.
    resource.setrlimit(resource.RLIMIT_DATA, (memory_bytes, memory_bytes))
