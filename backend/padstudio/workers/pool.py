"""Processes that do what must not harm or hold up the server.

Requests, for whose answers somebody waits, and tasks, which may take minutes, share them. A process
that works on a task answers requests between two of its steps (`padstudio.workers.inside`), so that
a request waits for a step and not for a task. A call that exceeds its time is ended with its
process; a process that dies costs its caller an error; the next call gets a new process.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any, Literal, TypeVar

from padstudio.errors import BusyError, WorkerCrashError
from padstudio.workers.inside import Limits
from padstudio.workers.process import Call, Process, TaskLostError

ResultT = TypeVar("ResultT")
# Between two tries to start a process for tasks.
_START_AGAIN_S = 1.0
# What a process may still have, of what requests were about.
_HOMES = 2


class WorkerPool:
    """A few worker processes, started when first needed.

    Parameters
    ----------
    size : int
        Number of processes.
    limits : Limits
        What each may take.
    max_waiting : int
        Requests that may wait for a process.
    """

    def __init__(self, size: int, limits: Limits, max_waiting: int) -> None:
        self._room = threading.BoundedSemaphore(size + max_waiting)
        self._changed = threading.Condition()
        self._requests: deque[Call] = deque()
        self._tasks: deque[Call] = deque()
        self._unstarted = [_Worker(limits) for _ in range(size)]
        self._workers: list[_Worker] = []
        self._threads: list[threading.Thread] = []
        self._is_closed = False

    def submit(
        self,
        function: Callable[..., ResultT],
        *args: Any,
        timeout_s: float,
        home: str | None = None,
    ) -> Future[ResultT]:
        """Call a function in a worker process, before tasks.

        Parameters
        ----------
        function : callable
            Importable by name.
        *args : object
            Picklable.
        timeout_s : float
            Time for the call itself, without the wait for a process.
        home : str or None
            What it is about: the process that was last called about it may have kept what it made,
            and is asked again unless it is at another request.

        Returns
        -------
        Future
            Of the function's value; or of its own `StudioError`, `TimeLimitError`,
            `WorkerCrashError`, or `LimitError` where it ran out of memory.

        Raises
        ------
        BusyError
            If too many requests wait.
        """
        if not self._room.acquire(blocking=False):
            raise BusyError(
                "the server is busy with as many pictures and pads as it takes at a time; try "
                "again in a moment"
            )
        call = Call(function, args, timeout_s, home=home)
        call.future.add_done_callback(lambda _: self._room.release())
        self._add(self._requests, call)
        return call.future

    def start(
        self, function: Callable[..., Any], *args: Any, timeout_s: float | None = None
    ) -> Call:
        """Call a function that takes its time, and calls `checkpoint`; as `submit`, never busy.

        The future may also have `TaskLostError`; such a task is worth another try.
        """
        call = Call(function, args, timeout_s)
        self._add(self._tasks, call)
        return call

    @property
    def free(self) -> int:
        """Further tasks that would not wait for others."""
        with self._changed:
            at_work = sum(worker.task is not None for worker in self._workers)
            size = len(self._workers) + len(self._unstarted)
            return max(0, size - at_work - len(self._tasks))

    def close(self) -> None:
        """End the processes; calls at work fail."""
        with self._changed:
            self._is_closed = True
            waiting = [*self._requests, *self._tasks]
            self._changed.notify_all()
        for call in waiting:
            call.future.cancel()
        for worker in self._workers:
            worker.close()
        for thread in self._threads:
            thread.join()

    def _add(self, calls: deque[Call], call: Call) -> None:
        with self._changed:
            if self._is_closed:
                call.future.cancel()
                return
            calls.append(call)
            free = sum(worker.is_free for worker in self._workers)
            if self._unstarted and len(self._requests) + len(self._tasks) > free:
                self._begin(self._unstarted.pop())
            self._changed.notify_all()

    def _begin(self, worker: _Worker) -> None:
        """Set two threads on a process: one for each of its pipes, so that none needs a queue."""
        self._workers.append(worker)
        for drive in (self._drive_requests, self._drive_tasks):
            thread = threading.Thread(target=drive, args=(worker,), name="worker", daemon=True)
            self._threads.append(thread)
            thread.start()

    def _drive_requests(self, worker: _Worker) -> None:
        def wanted() -> bool:
            others = any(other.is_free for other in self._workers)
            return any(
                self._is_for(worker, call) and (worker.is_free or not others or call.home)
                for call in self._requests
            )

        while self._wait_for(wanted):
            try:
                process = worker.started()
            except WorkerCrashError as error:
                self._refuse_next(error)
                continue
            is_ready = process.offer_request()
            call = None
            # Whoever died beside its task took no request with it.
            if is_ready or worker.task is None:
                call = worker.request = self._next(self._requests, worker)
            if call is not None:
                worker.was_at(call.home)
                deliver = call.run(process.answer)
                self._done(worker, "request")
                deliver()
            elif is_ready:
                process.withdraw_request()

    def _drive_tasks(self, worker: _Worker) -> None:
        while self._wait_for(lambda: bool(self._tasks) and worker.is_free):
            call = worker.task = self._next(self._tasks)
            if call is not None:
                deliver = call.run(worker.do_task)
                self._done(worker, "task")
                deliver()

    def _refuse_next(self, error: WorkerCrashError) -> None:
        """Tell who waits for no process that none can be started."""
        call = self._next(self._requests)
        if call is not None:
            call.future.set_exception(error)

    def _wait_for(self, wanted: Callable[[], bool]) -> bool:
        """Wait until there is something to do; False where the pool is closed."""
        with self._changed:
            self._changed.wait_for(lambda: self._is_closed or wanted())
            return not self._is_closed

    def _next(self, calls: deque[Call], worker: _Worker | None = None) -> Call | None:
        """The first call that waits; that waits for a worker, where one is given."""
        with self._changed:
            for call in list(calls):
                if worker is not None and not self._is_for(worker, call):
                    continue
                calls.remove(call)
                if call.future.set_running_or_notify_cancel():
                    return call
            return None

    def _is_for(self, worker: _Worker, call: Call) -> bool:
        """False where another worker has the call's home and will take it at once."""
        homes = [
            other for other in self._workers if call.home in other.homes and other.request is None
        ]
        return call.home is None or not homes or worker in homes

    def _done(self, worker: _Worker, what: Literal["request", "task"]) -> None:
        with self._changed:
            setattr(worker, what, None)
            self._changed.notify_all()


class _Worker:
    """A place for one process, and what it is at."""

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._lock = threading.Lock()
        self._process: Process | None = None
        self._is_closed = False
        self.request: Call | None = None
        self.task: Call | None = None
        self.homes: deque[str] = deque(maxlen=_HOMES)

    @property
    def is_free(self) -> bool:
        """True where it is at nothing."""
        return self.request is None and self.task is None

    def started(self) -> Process:
        """The process; another one where the last one ended.

        Raises
        ------
        TaskLostError
            If the system has no room for one at present.
        """
        with self._lock:
            if self._process is None or not self._process.is_alive():
                try:
                    self._process = Process(self._limits)
                except OSError as error:
                    raise TaskLostError(
                        f"no worker process can be started ({error.strerror or error}); free some "
                        "memory, or close other programs, and try again"
                    ) from error
            if self._is_closed:
                self._process.end()
            return self._process

    def was_at(self, home: str | None) -> None:
        """Note what a request is about."""
        if home is not None:
            if home in self.homes:
                self.homes.remove(home)
            self.homes.append(home)

    def do_task(self, call: Call) -> Any:
        """What comes of a task."""
        try:
            call.process = self.started()
        except TaskLostError:
            # It is tried again at once, which would keep a core busy.
            time.sleep(_START_AGAIN_S)
            raise
        return call.process.do_task(call)

    def close(self) -> None:
        """End the process for good."""
        with self._lock:
            self._is_closed = True
            if self._process is not None:
                self._process.end()
