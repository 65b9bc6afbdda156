"""Sweeps as jobs: one parameter over values, on a sample of a flight's frames.

They live as long as the server; the newest ones are kept.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field

from padstudio.errors import LimitError, NotFoundError, StudioError
from padstudio.store.database.data_folder import new_id

#: Sweeps that may wait or run at a time.
MAX_OPEN = 4
_KEPT = 20
_OPEN = ("queued", "running")
_log = logging.getLogger(__name__)


@dataclass
class SweptFrame:
    """A frame of a sweep.

    Attributes
    ----------
    frame : int
    was_ok : bool
        The flight has a pose of it.
    ok : list of bool
        Under each value; empty until it was read, or where it cannot be.
    """

    frame: int
    was_ok: bool
    ok: list[bool] = field(default_factory=list)


@dataclass
class Sweep:
    """One sweep; fields as of `padstudio.web.schemas.tuning.SweepInfo`."""

    flight: str
    parameter: str
    values: list[int | float | bool]
    frames: list[SweptFrame]
    id: str = field(default_factory=new_id)
    state: str = "queued"
    frames_done: int = 0
    error: str | None = None
    task: asyncio.Task[None] | None = field(default=None, repr=False)

    @property
    def frames_total(self) -> int:
        """Frames that are read."""
        return len(self.frames)

    @property
    def won(self) -> list[int]:
        """Under each value: frames that have a pose and had none."""
        return self._count(was_ok=False)

    @property
    def lost(self) -> list[int]:
        """Under each value: frames that had a pose and have none."""
        return self._count(was_ok=True)

    def _count(self, *, was_ok: bool) -> list[int]:
        read = [item for item in self.frames if item.ok and item.was_ok is was_ok]
        return [
            sum(item.ok[place] is not was_ok for item in read) for place in range(len(self.values))
        ]


class SweepService:
    """The sweeps of a server; for one event loop."""

    def __init__(self) -> None:
        self._sweeps: dict[str, Sweep] = {}
        # The workers serve other callers too.
        self._turn = asyncio.Lock()

    def start(self, sweep: Sweep, read: Callable[[int], Awaitable[list[bool]]]) -> Sweep:
        """Queue a sweep.

        Parameters
        ----------
        sweep : Sweep
        read : callable
            Gives what a frame, by its number, is under each value.

        Raises
        ------
        LimitError
            If `MAX_OPEN` wait or run.
        """
        if sum(other.state in _OPEN for other in self._sweeps.values()) >= MAX_OPEN:
            raise LimitError(
                f"{MAX_OPEN} sweeps run or wait, the limit; wait for one, or stop it",
                code="too_many_sweeps",
            )
        over = [other.id for other in self._sweeps.values() if other.state not in _OPEN]
        for sweep_id in over[: max(0, len(over) - _KEPT + 1)]:
            del self._sweeps[sweep_id]
        self._sweeps[sweep.id] = sweep
        sweep.task = asyncio.create_task(self._run(sweep, read))
        return sweep

    def get(self, sweep_id: str) -> Sweep:
        """One of them; raises `NotFoundError`."""
        if sweep_id not in self._sweeps:
            raise NotFoundError("there is no sweep of that id; only the newest are kept")
        return self._sweeps[sweep_id]

    def stop(self, sweep_id: str) -> None:
        """End one where it is; what was read stays. Raises as `get`."""
        sweep = self.get(sweep_id)
        if sweep.state in _OPEN:
            sweep.state = "cancelled"

    async def close(self) -> None:
        """End all of them."""
        tasks = [sweep.task for sweep in self._sweeps.values() if sweep.task]
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    async def _run(self, sweep: Sweep, read: Callable[[int], Awaitable[list[bool]]]) -> None:
        try:
            async with self._turn:
                for item in sweep.frames:
                    if sweep.state == "cancelled":
                        return
                    sweep.state = "running"
                    found = await read(item.frame)
                    item.ok = found if len(found) == len(sweep.values) else []
                    sweep.frames_done += 1
            sweep.state = "done"
        except StudioError as error:
            sweep.state, sweep.error = "failed", error.message
        except Exception:
            _log.exception("sweep %s failed", sweep.id)
            sweep.state, sweep.error = "failed", "a fault of the program; the server's log has it"
