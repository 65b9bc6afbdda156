"""Tasks in the worker processes of this machine, which the server's requests share."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from concurrent.futures import CancelledError, Future
from functools import partial
from typing import Any

from padstudio.errors import WorkerCrashError
from padstudio.flights.cluster.task import Kind, Outcome, Task, crashed, outcome, perform
from padstudio.workers.inside import checkpoint
from padstudio.workers.pool import WorkerPool
from padstudio.workers.process import Call, TaskLostError


class LocalEngine:
    """An `Engine` of a pool, which outlives it.

    Parameters
    ----------
    pool : WorkerPool
    """

    def __init__(self, pool: WorkerPool) -> None:
        self._pool = pool
        self._calls: dict[str, Call] = {}

    def room(self, at_work: int) -> int:
        """As of `Engine`; other tasks of the pool count."""
        return self._pool.free

    def submit(self, key: str, task: Task, ended: Callable[[Outcome], None]) -> None:
        """As of `Engine`; crashes are counted by who calls."""
        call = self._calls[key] = self._pool.start(_perform, pickle.dumps(task))
        call.future.add_done_callback(partial(self._ended, key, ended))

    def stop(self, key: str) -> None:
        """As of `Engine`."""
        call = self._calls.get(key)
        if call is not None:
            call.stop()

    def end_worker_of(self, key: str) -> None:
        """As of `Engine`."""
        call = self._calls.get(key)
        if call is not None:
            call.kill()

    def tend(self) -> str | None:
        """As of `Engine`: the pool starts processes as they are needed, where it can."""
        return self._pool.trouble

    def rest(self) -> None:
        """Nothing to let go of: the pool sees to its processes."""

    def close(self) -> None:
        """Tell what is at work to stop."""
        for call in list(self._calls.values()):
            call.stop()

    def _ended(self, key: str, ended: Callable[[Outcome], None], future: Future[Any]) -> None:
        self._calls.pop(key, None)
        ended(_outcome_of(future))


def _perform(packed: bytes) -> tuple[Kind, Any]:
    return perform(packed, checkpoint)


def _outcome_of(future: Future[Any]) -> Outcome:
    try:
        return outcome(*future.result())
    except (CancelledError, TaskLostError):
        return Outcome("lost")
    except WorkerCrashError:
        return crashed()
    except Exception as error:
        return crashed(error)
