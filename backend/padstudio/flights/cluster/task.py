"""Tasks, how they end, and what an engine does with them."""

from __future__ import annotations

import logging
import pickle
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, Protocol

from padstudio.errors import StudioError, TaskStoppedError
from padstudio.workers.inside import known_fault

logger = logging.getLogger(__name__)

Kind = Literal["value", "refused", "crashed", "lost"]


class Task(Protocol):
    """What the engine runs; must be picklable."""

    def run(self, stopped: Callable[[], bool]) -> Any:
        """Do the work; asks `stopped` between its steps, and ends early where that says so."""


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

    kind: Kind
    value: Any = None
    error: dict[str, Any] | None = None


class Engine(Protocol):
    """Runs tasks and says how they ended; may be lost at any time, and started again."""

    def room(self, at_work: int) -> int:
        """How many more tasks can be taken beside those that the caller has at work."""

    def submit(self, key: str, task: Task, ended: Callable[[Outcome], None]) -> None:
        """Run a task.

        Parameters
        ----------
        key : str
            Names the task; never used twice.
        task : Task
        ended : callable
            Called once, from another thread.

        Raises
        ------
        OSError, TimeoutError
            If the engine cannot be started or reached.
        """

    def stop(self, key: str) -> None:
        """Tell a task to stop: at once where it waits, soon where it runs."""

    def end_worker_of(self, key: str) -> None:
        """End the process that hangs in a task; another takes its place."""

    def tend(self) -> str | None:
        """See that there are workers; a sentence where there is none, for who waits for one."""

    def rest(self) -> None:
        """Let go of what costs something while nothing is at work; the next task has it again."""

    def close(self) -> None:
        """Let go of the workers; tasks at work are lost."""


def perform(packed: bytes, stopped: Callable[[], bool]) -> tuple[Kind, Any]:
    """Run a pickled task in a worker; errors come back as values, as pickling would lose parts.

    The task is unpickled here, as workers end that cannot read what they are sent.
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
        return "value", task.run(stopped)
    except TaskStoppedError:
        return "lost", None
    except StudioError as error:
        return "refused", error_dict(error)
    except Exception as error:
        known = known_fault(error)
        if known is not None:
            return "refused", error_dict(known)
        logger.exception("a task brought a defect to light")
        return "crashed", _defect(error)


def outcome(kind: Kind, value: Any) -> Outcome:
    """What `perform` gave."""
    return Outcome(kind, value) if kind == "value" else Outcome(kind, error=value)


def crashed(error: Exception | None = None) -> Outcome:
    """Of a task that cost a worker its life, or met a defect outside of the task."""
    if error is not None:
        return Outcome("crashed", error=_defect(error))
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


def _defect(error: Exception) -> dict[str, Any]:
    message = f"a defect of the program: {error!r}"
    return {"code": "internal_error", "message": message, "detail": {}}


def error_dict(error: StudioError) -> dict[str, Any]:
    """An error as it is stored and shown."""
    return {"code": error.error_code, "message": error.message, "detail": error.detail}
