"""A worker process as the pool sees it: what is asked of it, and what comes of that."""

from __future__ import annotations

import contextlib
import multiprocessing
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass, field
from functools import partial
from multiprocessing.connection import Connection
from multiprocessing.reduction import ForkingPickler
from typing import Any

from padstudio.errors import TimeLimitError, WorkerCrashError
from padstudio.workers import inside
from padstudio.workers.inside import Limits

# A fork of a threaded server may inherit locks that nobody will release.
_context = multiprocessing.get_context("spawn")


class TaskLostError(WorkerCrashError):
    """The process died of a request that it answered between two steps of the task."""


@dataclass(eq=False)
class Call:
    """A function that a worker process is to call; `future` has what comes of it."""

    function: Callable[..., Any]
    args: tuple[Any, ...]
    timeout_s: float | None
    future: Future[Any] = field(default_factory=Future)
    process: Process | None = None
    is_stopped: bool = False
    home: str | None = None

    def stop(self) -> None:
        """Drop a task that waits; tell one that runs to end at its next `checkpoint`."""
        self.is_stopped = True
        if not self.future.cancel() and self.process is not None:
            self.process.tell_to_stop(self)

    def kill(self) -> None:
        """End the process that is at it."""
        if self.process is not None:
            self.process.end()

    def run(self, do: Callable[[Call], Any]) -> Callable[[], None]:
        """Gives what gives the future what `do` gives or raises."""
        try:
            return partial(self.future.set_result, do(self))
        except BaseException as error:
            return partial(self.future.set_exception, error)


class Process:
    """One process and the pipes to it; a thread drives each."""

    def __init__(self, limits: Limits) -> None:
        self._requests, requests = _context.Pipe()
        self._tasks, tasks = _context.Pipe()
        self._process = _context.Process(
            target=inside.serve, args=(requests, tasks, limits), daemon=True
        )
        self._process.start()
        requests.close()
        tasks.close()
        self._ending, self._telling = threading.Lock(), threading.Lock()
        self._is_over = self._is_answering = False

    def is_alive(self) -> bool:
        """False where it died or was ended."""
        with self._ending:
            return not self._is_over and self._process.is_alive()

    def end(self) -> None:
        """End it at once; both threads find its pipes closed."""
        with self._ending:
            if not self._is_over:
                self._is_over = True
                self._process.kill()
                self._process.join()

    def offer_request(self) -> bool:
        """Wait until it can take a request; False where it died before."""
        try:
            self._requests.send(None)
            return bool(self._requests.recv() == inside.READY)
        except (EOFError, OSError):
            self.end()
            return False

    def withdraw_request(self) -> None:
        """Say that there is none after all."""
        with contextlib.suppress(OSError):
            self._requests.send(None)

    def answer(self, call: Call) -> Any:
        """What comes of a request that it is ready to take."""
        try:
            data = ForkingPickler.dumps((call.function, call.args))
        except BaseException:
            self.withdraw_request()
            raise
        # Stays so where it dies of this request.
        self._is_answering = True
        try:
            kind, value = self._reply(self._requests, lambda: self._requests.send_bytes(data), call)
        finally:
            self._is_answering = self._is_over
        return _value(kind, value, call)

    def do_task(self, call: Call) -> Any:
        """What comes of a task."""
        message = (id(call), call.function, call.args)
        try:
            kind, value = self._reply(self._tasks, lambda: self._tell(message, call), call)
        except WorkerCrashError as error:
            raise TaskLostError(error.message) if self._is_answering else error from error
        return _value(kind, value, call)

    def tell_to_stop(self, call: Call) -> None:
        """Tell it to end a task at its next step; one that is over already does not mind."""
        with contextlib.suppress(OSError), self._telling:
            self._tasks.send((id(call),))

    def _tell(self, message: tuple[Any, ...], call: Call) -> None:
        with self._telling:
            self._tasks.send(message)
        if call.is_stopped:
            self.tell_to_stop(call)

    def _reply(self, pipe: Connection, send: Callable[[], None], call: Call) -> tuple[str, Any]:
        try:
            send()
            if not self._wait(pipe, call.timeout_s):
                self.end()
                raise TimeLimitError(
                    f"the work took longer than {call.timeout_s:g} s and was ended; try something "
                    "smaller, or raise the limit in the settings"
                )
            found: tuple[str, Any] = pipe.recv()
        except (EOFError, OSError) as error:
            self.end()
            raise WorkerCrashError(
                "the process that worked on this died, most likely for lack of memory or of a "
                "damaged file; try a smaller or repaired one"
            ) from error
        return found

    def _wait(self, pipe: Connection, timeout_s: float | None) -> bool:
        """Wait for a reply; False where the work took its time.

        What the process waits for a core is not its work: a busy machine answers late.
        """
        if timeout_s is None:
            return pipe.poll(None)
        end_s = time.monotonic() + timeout_s - self._queued_s()
        while (left_s := end_s + self._queued_s() - time.monotonic()) > 0:
            if pipe.poll(left_s):
                return True
        return False

    def _queued_s(self) -> float:
        """Seconds that the process was ready and had no core, on Linux; else 0."""
        try:
            # proc(5) leaves it out: time on a core, time waiting for one, in ns, and turns.
            with open(f"/proc/{self._process.pid}/schedstat", encoding="ascii") as file:
                return int(file.read().split()[1]) / 1e9
        except (OSError, ValueError, IndexError):
            return 0.0


def _value(kind: str, value: Any, call: Call) -> Any:
    if kind == "defect":
        defect = RuntimeError(f"{call.function.__qualname__} failed in a worker")
        defect.add_note(value)
        raise defect
    if kind == "error":
        raise value
    return value
