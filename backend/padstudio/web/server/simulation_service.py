"""Simulated flights as jobs: one after the other, each in a worker process.

They live as long as the server: the upload and the analysis that come of one stay, its archive
goes with the server or when newer ones push it out.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from padstudio.errors import LimitError, NotFoundError, StudioError
from padstudio.store.database.data_folder import new_id, remove
from padstudio.workers.simulated_flights import STOP, frames_done

#: Jobs that may wait or run at a time.
MAX_OPEN = 10
# Jobs that are over and keep their archives on disk.
_KEPT = 5
_OPEN = ("queued", "running")
_log = logging.getLogger(__name__)


@dataclass
class SimulationJob:
    """One simulated flight; fields as of `padstudio.web.schemas.simulations.Simulation`.

    Attributes
    ----------
    folder : Path
        Where a worker renders it.
    """

    name: str
    frames_total: int
    video: bool
    folder: Path
    id: str = field(default_factory=new_id)
    created_at: datetime = field(default_factory=lambda: datetime.now(UTC))
    state: str = "queued"
    upload: str | None = None
    flight: str | None = None
    error: dict[str, Any] | None = None
    task: asyncio.Task[None] | None = field(default=None, repr=False)

    @property
    def frames_done(self) -> int:
        """Frames that are rendered."""
        return self.frames_total if self.state == "done" else frames_done(self.folder)


class SimulationService:
    """The simulated flights of a server; for one event loop."""

    def __init__(self) -> None:
        self._jobs: dict[str, SimulationJob] = {}
        # The workers serve other callers too.
        self._turn = asyncio.Lock()

    def start(
        self, job: SimulationJob, work: Callable[[SimulationJob], Awaitable[None]]
    ) -> SimulationJob:
        """Queue a job.

        Parameters
        ----------
        job : SimulationJob
        work : callable
            Renders it, and sets `upload` and `flight`.

        Raises
        ------
        LimitError
            If `MAX_OPEN` jobs wait or run.
        """
        if sum(other.state in _OPEN for other in self._jobs.values()) >= MAX_OPEN:
            raise LimitError(
                f"{MAX_OPEN} flights are being simulated or wait for it, the limit; wait for some "
                "to finish, or stop some",
                code="too_many_flights",
            )
        over = [other for other in self._jobs.values() if other.state not in _OPEN]
        for other in over[: max(0, len(over) - _KEPT + 1)]:
            self._drop(other)
        self._jobs[job.id] = job
        job.task = asyncio.create_task(self._run(job, work))
        return job

    def get(self, job_id: str) -> SimulationJob:
        """One of them; raises `NotFoundError`."""
        if job_id not in self._jobs:
            raise NotFoundError("there is no simulated flight of that id; it was removed")
        return self._jobs[job_id]

    def remove(self, job_id: str) -> None:
        """Stop a job where it is not over, and forget it; raises as `get`."""
        job = self.get(job_id)
        if job.state in _OPEN:
            (job.folder / STOP).touch()
            job.state = "cancelled"
        else:
            self._drop(job)

    async def close(self) -> None:
        """End all jobs."""
        tasks = [job.task for job in self._jobs.values() if job.task]
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    async def _run(
        self, job: SimulationJob, work: Callable[[SimulationJob], Awaitable[None]]
    ) -> None:
        try:
            async with self._turn:
                if job.state == "cancelled":
                    return
                job.state = "running"
                await work(job)
            if job.state == "running":
                job.state = "done"
        except StudioError as error:
            _fail(job, error.error_code, error.message, error.detail)
        except Exception:
            _log.exception("simulation %s failed", job.id)
            _fail(job, "internal_error", "a fault of the program; the server's log has it", {})
        finally:
            if job.state != "done":
                remove(job.folder)

    def _drop(self, job: SimulationJob) -> None:
        del self._jobs[job.id]
        remove(job.folder)


def _fail(job: SimulationJob, code: str, message: str, detail: Any) -> None:
    if job.state == "cancelled":
        return
    job.state = "failed"
    job.error = {"code": code, "message": message, "detail": dict(detail or {})}
