"""A worker process as the pool sees it: what is asked of it, and what comes of that."""

from __future__ import annotations

import contextlib
import multiprocessing
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from dataclasses import dataclass, field
from functools import partial
from multiprocessing.connection import Connection
from multiprocessing.reduction import ForkingPickler
from typing import Any

from padstudio.errors import TimeLimitError, WorkerCrashError
from padstudio.workers import inside
from padstudio.workers.inside import Limits
from padstudio.workers.work_clock import WorkClock, own_s

# A fork of a threaded server may inherit locks that nobody will release.
_context = multiprocessing.get_context("spawn")


#: What the system may answer to who asks for a process or a thread.
NO_ROOM = (OSError, MemoryError, RuntimeError)


class TaskLostError(WorkerCrashError):
    """The process died of a request that it answered between two steps of the task."""


class NoWorkerError(TaskLostError):
    """The system has no room for a process, or for the threads that drive it, at present."""

    code = "no_worker"
    status = 503

    @classmethod
    def of(cls, why: Exception | str) -> NoWorkerError:
        """With the system's reason, as told to whoever waits."""
        why = getattr(why, "strerror", None) or str(why) or "no memory is left"
        return cls(
            f"no worker process can be started ({why}); free some memory, or close other "
            "programs, and try again"
        )


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

    def __init__(self, limits: Limits, warming: Sequence[str] = ()) -> None:
        self._requests, requests = _context.Pipe()
        self._tasks, tasks = _context.Pipe()
        self._process = _context.Process(
            target=inside.serve, args=(requests, tasks, limits, warming), daemon=True
        )
        self._process.start()
        requests.close()
        tasks.close()
        self._ending, self._telling = threading.Lock(), threading.Lock()
        self._is_over = self._is_answering = self._is_up = False

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
            self._is_up = bool(self._requests.recv() == inside.READY)
            return self._is_up
        except (EOFError, OSError):
            self.end()
            return False

    def withdraw_request(self) -> None:
        """Say that there is none after all."""
        with contextlib.suppress(OSError):
            self._requests.send_bytes(inside.NOTHING)

    def answer(self, call: Call) -> Any:
        """What comes of a request that it is ready to take."""
        try:
            data = _packed(call)
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
        message = (id(call), _packed(call))
        try:
            kind, value = self._reply(self._tasks, lambda: self._tell(message, call), call)
        except NoWorkerError:
            raise
        except WorkerCrashError as error:
            raise TaskLostError(error.message) if self._is_answering else error from error
        return _value(kind, value, call)

    def tell_to_stop(self, call: Call) -> None:
        """Tell it to end a task at its next step; one that is over already does not mind."""
        with contextlib.suppress(OSError), self._telling:
            self._tasks.send((id(call), None))

    def _tell(self, message: tuple[Any, ...], call: Call) -> None:
        with self._telling:
            self._tasks.send(message)
        if call.is_stopped:
            self.tell_to_stop(call)

    def _reply(self, pipe: Connection, send: Callable[[], None], call: Call) -> tuple[str, Any]:
        try:
            clock = WorkClock(call.timeout_s, self._own_s())
            send()
            while True:
                if not self._wait(pipe, clock):
                    self.end()
                    raise TimeLimitError(
                        f"the work took longer than {call.timeout_s:g} s and was ended; try "
                        "something smaller, or raise the limit in the settings"
                    )
                kind, value = pipe.recv()
                self._is_up = True
                if kind in ("value", "error", "defect"):
                    return kind, value
                clock.turn(kind, value)
        except (EOFError, OSError) as error:
            self.end()
            if not self._is_up:
                raise NoWorkerError.of("it ended before it was ready") from error
            raise WorkerCrashError(
                "the process that worked on this died, most likely for lack of memory or of a "
                "damaged file; try a smaller or repaired one"
            ) from error

    def _wait(self, pipe: Connection, clock: WorkClock) -> bool:
        """Wait until the process says something; False where its time is over before."""
        while (left_s := clock.left_s(self._own_s())) is not None and left_s > 0:
            if pipe.poll(left_s):
                return True
        return pipe.poll(None if left_s is None else 0)

    def _own_s(self) -> float:
        return own_s(self._process.pid)


def _packed(call: Call) -> bytes:
    return bytes(ForkingPickler.dumps((call.function, call.args)))


def _value(kind: str, value: Any, call: Call) -> Any:
    if kind == "defect":
        defect = RuntimeError(f"{call.function.__qualname__} failed in a worker")
        defect.add_note(value)
        raise defect
    if kind == "error":
        raise value
    return value
