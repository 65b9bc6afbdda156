"""Lets a cluster's worker process go when it was idle for long, and has another take its place.

What a process has imported and kept for its tasks, some 300 MB, goes with it. The next one joins at
once and imports the same when it gets a task.
"""

from __future__ import annotations

import asyncio
import time
from typing import TYPE_CHECKING, Any

from distributed import WorkerPlugin

if TYPE_CHECKING:
    from distributed import Worker


class RestartIdle(WorkerPlugin):
    """Of one worker process, which its nanny starts again.

    Parameters
    ----------
    idle_s : float
        After so long without a task; a process that has had none holds nothing, and stays.
    """

    name = "padstudio-restart-idle"

    def __init__(self, idle_s: float) -> None:
        self._idle_s = idle_s
        self._worked_s: float | None = None
        self._watching: asyncio.Task[None] | None = None

    def setup(self, worker: Worker) -> None:
        """As of `WorkerPlugin`."""
        self._watching = asyncio.get_running_loop().create_task(self._watch(worker))

    def teardown(self, worker: Worker) -> None:
        """As of `WorkerPlugin`."""
        if self._watching is not None:
            self._watching.cancel()

    def transition(self, key: Any, start: str, finish: str, **kwargs: Any) -> None:
        """As of `WorkerPlugin`: a task begins, ends or is forgotten."""
        self._worked_s = time.monotonic()

    async def _watch(self, worker: Worker) -> None:
        left_s = self._idle_s
        while left_s > 0:
            await asyncio.sleep(left_s)
            left_s = self._idle_s
            if self._worked_s is not None and not worker.state.tasks:
                left_s += self._worked_s - time.monotonic()
        # What ends the worker must not be ended by it.
        self._watching = None
        # In order: the scheduler gives it no task any more.
        await worker.close_gracefully(restart=True, reason="idle")
