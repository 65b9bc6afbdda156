"""Processes that do what must not harm or hold up the server.

Requests, for whose answers somebody waits, and tasks, which may take minutes, share them. A process
that works on a task answers requests between two of its steps (`padstudio.workers.inside`), so that
a request waits for a step and not for a task. A call that exceeds its time is ended with its
process; a process that dies costs its caller an error, and another takes its place at once, warm
by the time it is needed. Processes that have had nothing to do for long are ended until there is
something again.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from contextlib import suppress
from typing import Any, Literal, TypeVar

from padstudio.errors import BusyError
from padstudio.workers.inside import Limits
from padstudio.workers.process import NO_ROOM, Call, NoWorkerError
from padstudio.workers.worker import Worker

ResultT = TypeVar("ResultT")


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
    warming : sequence of str
        Modules whose ``steps`` each process takes while there is nothing else to do.
    idle_s : float or None
        After so long without work a process is ended; None keeps it.
    """

    def __init__(
        self,
        size: int,
        limits: Limits,
        max_waiting: int,
        *,
        warming: Sequence[str] = (),
        idle_s: float | None = None,
    ) -> None:
        self._room = threading.BoundedSemaphore(size + max_waiting)
        self._changed = threading.Condition()
        self._requests: deque[Call] = deque()
        self._tasks: deque[Call] = deque()
        self._idle_s = idle_s
        self._unstarted = [Worker(limits, warming) for _ in range(size)]
        self._workers: list[Worker] = []
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
            `WorkerCrashError`, `NoWorkerError`, or `LimitError` where it ran out of memory.

        Raises
        ------
        BusyError
            If too many requests wait.
        NoWorkerError
            If the system has no room for the threads that would drive a process.
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
    def trouble(self) -> str | None:
        """Why tasks wait for processes that do not come up, a sentence; None where they do."""
        with self._changed:
            return next((worker.trouble for worker in self._workers if worker.trouble), None)

    @property
    def free(self) -> int:
        """Further tasks that would not wait for others."""
        with self._changed:
            at_work = sum(worker.task is not None for worker in self._workers)
            size = len(self._workers) + len(self._unstarted)
            return max(0, size - at_work - len(self._tasks))

    def warm_up(self) -> None:
        """Start all processes before they are needed."""
        with self._changed:
            # What cannot be started now is tried again with the first call that needs it.
            with suppress(NoWorkerError):
                while self._unstarted and not self._is_closed:
                    self._begin()
            workers = list(self._workers)
        for worker in workers:
            worker.replace()

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
                try:
                    self._begin()
                except NoWorkerError:
                    # Without any worker there is nobody to wait for.
                    if not self._workers:
                        calls.remove(call)
                        call.future.cancel()
                        raise
            self._changed.notify_all()

    def _begin(self) -> None:
        """Set two threads on a process: one for each of its pipes, so that none needs a queue.

        Raises
        ------
        NoWorkerError
            If the system has no room for both; then there is none.
        """
        worker, has_both = self._unstarted[-1], Future[bool]()
        started = []
        try:
            for drive in (self._drive_requests, self._drive_tasks):
                thread = threading.Thread(
                    target=lambda drive=drive: has_both.result() and drive(worker),
                    name="worker",
                    daemon=True,
                )
                thread.start()
                started.append(thread)
        except NO_ROOM as error:
            has_both.set_result(False)
            raise NoWorkerError.of(error) from error
        self._workers.append(self._unstarted.pop())
        self._threads += started
        has_both.set_result(True)

    def _drive_requests(self, worker: Worker) -> None:
        def wanted() -> bool:
            others = any(other.is_free for other in self._workers)
            return any(
                self._is_for(worker, call) and (worker.is_free or not others or call.home)
                for call in self._requests
            )

        while self._wait_for(wanted, worker):
            try:
                process = worker.started()
            except NoWorkerError as error:
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
                self._done(worker, "request", deliver)
            elif is_ready:
                process.withdraw_request()

    def _drive_tasks(self, worker: Worker) -> None:
        while self._wait_for(lambda: bool(self._tasks) and worker.is_free):
            call = worker.task = self._next(self._tasks)
            if call is not None:
                deliver = call.run(worker.do_task)
                self._done(worker, "task", deliver)

    def _refuse_next(self, error: NoWorkerError) -> None:
        """Tell who waits for no process that none can be started."""
        call = self._next(self._requests)
        if call is not None:
            call.future.set_exception(error)

    def _wait_for(self, wanted: Callable[[], bool], resting: Worker | None = None) -> bool:
        """Wait until there is something to do; False where the pool is closed.

        A worker that is given is let go meanwhile, once it has been idle for long.
        """
        with self._changed:
            while not (self._is_closed or wanted()):
                left_s = None
                if resting is not None and self._idle_s is not None and resting.is_free:
                    left_s = resting.rested_s + self._idle_s - time.monotonic()
                    if left_s <= 0:
                        resting.release()
                        left_s = None
                self._changed.wait(left_s)
            return not self._is_closed

    def _next(self, calls: deque[Call], worker: Worker | None = None) -> Call | None:
        """The first call that waits; that waits for a worker, where one is given."""
        with self._changed:
            for call in list(calls):
                if worker is not None and not self._is_for(worker, call):
                    continue
                calls.remove(call)
                if call.future.set_running_or_notify_cancel():
                    return call
            return None

    def _is_for(self, worker: Worker, call: Call) -> bool:
        """False where another worker has the call's home and will take it at once."""
        homes = [
            other for other in self._workers if call.home in other.homes and other.request is None
        ]
        return call.home is None or not homes or worker in homes

    def _done(
        self, worker: Worker, what: Literal["request", "task"], deliver: Callable[[], None]
    ) -> None:
        """A call is over; where it cost the process, there is another before the next one."""
        with self._changed:
            worker.rested_s = time.monotonic()
            setattr(worker, what, None)
            self._changed.notify_all()
        deliver()
        worker.replace()
