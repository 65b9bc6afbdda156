"""Jobs that a worker does in a folder of their own: one after the other, none outliving the server.

What comes of one and is to stay is handed over to the store; the rest goes with the server, or when
newer ones push it out.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Generic, TypeVar

from padstudio.errors import LimitError, NotFoundError, StudioError
from padstudio.store.database.data_folder import new_id, remove

#: Jobs of a kind that may wait or run at a time.
MAX_OPEN = 10
# Jobs that are over and keep their folders.
_KEPT = 5
_OPEN = ("queued", "running")
_log = logging.getLogger(__name__)


@dataclass(kw_only=True)
class FolderJob:
    """One job.

    Attributes
    ----------
    name : str
    folder : Path
        Where a worker does it.
    state : {"queued", "running", "done", "failed", "cancelled"}
    error : dict or None
        Why it failed, as of `padstudio.web.schemas.base.ErrorInfo`.
    """

    name: str
    folder: Path
    id: str = field(default_factory=new_id)
    created_at: datetime = field(default_factory=lambda: datetime.now(UTC))
    state: str = "queued"
    error: dict[str, Any] | None = None
    task: asyncio.Task[None] | None = field(default=None, repr=False)

    def stop(self) -> None:
        """Tell the worker that nobody waits for it."""


JobT = TypeVar("JobT", bound=FolderJob)


class FolderJobs(Generic[JobT]):
    """The jobs of one kind; for one event loop.

    Parameters
    ----------
    one, several : str
        What they are called.
    full : str
        Error code where too many are open.
    """

    def __init__(self, one: str, several: str, full: str) -> None:
        self._one, self._several, self._full = one, several, full
        self._jobs: dict[str, JobT] = {}
        # The workers serve other callers too.
        self._turn = asyncio.Lock()

    def start(self, job: JobT, work: Callable[[JobT], Awaitable[None]]) -> JobT:
        """Queue a job.

        Parameters
        ----------
        job : FolderJob
        work : callable
            Does it, and keeps in the job what came of it.

        Raises
        ------
        LimitError
            If `MAX_OPEN` jobs wait or run.
        """
        if sum(other.state in _OPEN for other in self._jobs.values()) >= MAX_OPEN:
            raise LimitError(
                f"{MAX_OPEN} {self._several} are under way or wait, the limit; wait for some to "
                "finish, or stop some",
                code=self._full,
            )
        over = [other for other in self._jobs.values() if other.state not in _OPEN]
        for other in over[: max(0, len(over) - _KEPT + 1)]:
            self._drop(other)
        self._jobs[job.id] = job
        job.task = asyncio.create_task(self._run(job, work))
        return job

    def get(self, job_id: str) -> JobT:
        """One of them; raises `NotFoundError`."""
        if job_id not in self._jobs:
            raise NotFoundError(f"there is no {self._one} of that id; it was removed")
        return self._jobs[job_id]

    @property
    def all(self) -> list[JobT]:
        """All of them, newest first."""
        return list(reversed(self._jobs.values()))

    def remove(self, job_id: str) -> None:
        """Stop a job where it is not over, and forget it; raises as `get`."""
        job = self.get(job_id)
        if job.state in _OPEN:
            job.stop()
            job.state = "cancelled"
        else:
            self._drop(job)

    async def close(self) -> None:
        """End all jobs."""
        tasks = [job.task for job in self._jobs.values() if job.task]
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    async def _run(self, job: JobT, work: Callable[[JobT], Awaitable[None]]) -> None:
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
            _log.exception("%s %s failed", self._one, job.id)
            _fail(job, "internal_error", "a fault of the program; the server's log has it", {})
        finally:
            if job.state != "done":
                remove(job.folder)

    def _drop(self, job: JobT) -> None:
        del self._jobs[job.id]
        remove(job.folder)


def _fail(job: FolderJob, code: str, message: str, detail: Any) -> None:
    if job.state == "cancelled":
        return
    job.state = "failed"
    job.error = {"code": code, "message": message, "detail": dict(detail or {})}
