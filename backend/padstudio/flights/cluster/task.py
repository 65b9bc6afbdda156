"""A task on its way through Dask: configured, run in a worker, and what came of it."""

from __future__ import annotations

import asyncio
import concurrent.futures
import logging
import pickle
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, Protocol

from padstudio.errors import StudioError

if TYPE_CHECKING:
    from distributed import Future

logger = logging.getLogger(__name__)

# How often a task asks whether it is to stop; the question goes to the scheduler and back.
_ASK_EVERY_S = 0.25


class TaskStoppedError(Exception):
    """The task was told to stop; what it had done is dropped."""


class Task(Protocol):
    """What the engine runs; must be picklable."""

    def run(self, stopped: Callable[[], bool]) -> Any:
        """Do the work; may end early where `stopped` says so."""


@dataclass(frozen=True)
class Outcome:
    """How a task ended.

    Attributes
    ----------
    kind : {"value", "refused", "crashed", "lost"}
        ``refused``: a `StudioError`; ``crashed``: the worker died, or a defect came to light;
        ``lost``: the engine let go of the task.
    value : object
        The task's result.
    error : dict or None
        ``code``, ``message``, ``detail``.
    """

    kind: Literal["value", "refused", "crashed", "lost"]
    value: Any = None
    error: dict[str, Any] | None = None


def configure() -> None:
    """Set what every scheduler and worker of ours needs."""
    import dask

    dask.config.set(
        {
            # One task a worker: a dead worker is blamed on the task that it worked on.
            "distributed.scheduler.worker-saturation": 1.0,
            "distributed.scheduler.allowed-failures": 0,
            "distributed.worker.memory.target": False,
            "distributed.worker.memory.spill": False,
            "distributed.worker.memory.pause": False,
            # Stacks sampled a hundred times a second, and kept for an hour.
            "distributed.worker.profile.enabled": False,
            "distributed.admin.large-graph-warning-threshold": "1GB",
            # Large frames come and go; giving their memory back each time costs a sixth.
            "distributed.nanny.pre-spawn-environ": {
                "MALLOC_TRIM_THRESHOLD_": 268435456,
                "MALLOC_MMAP_THRESHOLD_": 268435456,
                "OMP_NUM_THREADS": 1,
                "MKL_NUM_THREADS": 1,
                "OPENBLAS_NUM_THREADS": 1,
            },
        }
    )


def perform(packed: bytes, stop: str) -> tuple[str, Any]:
    """Run a pickled task in a worker; errors come back as values, as pickling would lose parts.

    The task is unpickled here, as Dask ends workers that cannot read what they are sent.
    """
    try:
        task: Task = pickle.loads(packed)
    except Exception as error:
        logger.exception("a task cannot be read")
        message = (
            f"a worker cannot read its task ({error!r}): install the same version of Pad Studio "
            "on all machines, start the workers again, and try the flight again"
        )
        return "refused", {"code": "worker_differs", "message": message, "detail": {}}
    try:
        return "value", task.run(_stop_signal(stop))
    except TaskStoppedError:
        return "lost", None
    except StudioError as error:
        return "refused", error_dict(error)


def _stop_signal(name: str) -> Callable[[], bool]:
    from distributed import Event

    event = Event(name)
    asked, answer = time.monotonic(), False

    def stopped() -> bool:
        nonlocal asked, answer
        if time.monotonic() - asked >= _ASK_EVERY_S:
            asked, answer = time.monotonic(), bool(event.is_set())
        return answer

    return stopped


def outcome_of(future: Future[Any]) -> Outcome:
    """How a future that is over ended."""
    from distributed.scheduler import KilledWorker

    try:
        kind, value = future.result(timeout=60)
    except KilledWorker:
        return Outcome(
            "crashed",
            error={
                "code": "worker_crashed",
                "message": "the process that worked on it died, most likely for lack of memory or "
                "of damaged data; repair the file, or give workers more memory (on a cluster, see "
                "that each of its machines has Pad Studio installed)",
                "detail": {},
            },
        )
    except (asyncio.CancelledError, concurrent.futures.CancelledError):
        return Outcome("lost")
    except Exception as error:
        if future.status == "error":
            logger.exception("a task brought a defect to light")
            message = f"a defect of the program: {error!r}"
            return Outcome(
                "crashed", error={"code": "internal_error", "message": message, "detail": {}}
            )
        return Outcome("lost")
    if kind == "refused":
        return Outcome("refused", error=value)
    return Outcome("value" if kind == "value" else "lost", value=value)


def error_dict(error: StudioError) -> dict[str, Any]:
    """An error as it is stored and shown."""
    return {"code": error.error_code, "message": error.message, "detail": error.detail}
