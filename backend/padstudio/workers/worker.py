"""A place for one process of the pool."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

from padstudio.workers.inside import Limits
from padstudio.workers.process import NO_ROOM, Call, NoWorkerError, Process

# Between two tries to start a process for tasks.
_START_AGAIN_S = 1.0
# What a process may still have, of what requests were about.
_HOMES = 2


class Worker:
    """A place for one process, and what it is at."""

    def __init__(self, limits: Limits, warming: Sequence[str]) -> None:
        self._limits, self._warming = limits, warming
        self._lock = threading.Lock()
        self._process: Process | None = None
        self._is_closed = False
        self.request: Call | None = None
        self.task: Call | None = None
        self.homes: deque[str] = deque(maxlen=_HOMES)
        self.rested_s = time.monotonic()
        #: Why no process comes up at present, a sentence; None where one does.
        self.trouble: str | None = None

    @property
    def is_free(self) -> bool:
        """True where it is at nothing."""
        return self.request is None and self.task is None

    def started(self) -> Process:
        """The process; another one where the last one ended.

        Raises
        ------
        NoWorkerError
            If the system has no room for one at present.
        """
        with self._lock:
            if self._process is None or not self._process.is_alive():
                try:
                    self._process = Process(self._limits, self._warming)
                except NO_ROOM as error:
                    raise NoWorkerError.of(error) from error
            if self._is_closed:
                self._process.end()
            return self._process

    def replace(self) -> None:
        """Start a process unless there is one; where none can be, the next call tells why."""
        if not self._is_closed:
            with suppress(NoWorkerError):
                self.started()

    def release(self) -> None:
        """End the process, which is at nothing, until there is a call again."""
        with self._lock:
            if self._process is not None and self.is_free:
                self._process.end()
            self.homes.clear()

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
            done = call.process.do_task(call)
        except NoWorkerError as error:
            self.trouble = error.message
            # It is tried again at once, which would keep a core busy.
            time.sleep(_START_AGAIN_S)
            raise
        self.trouble = None
        return done

    def close(self) -> None:
        """End the process for good."""
        with self._lock:
            self._is_closed = True
            if self._process is not None:
                self._process.end()
