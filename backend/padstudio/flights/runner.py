"""Brings queued chunks to the engine, and their results to the database."""

from __future__ import annotations

import contextlib
import logging
import queue
import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from sqlalchemy.exc import SQLAlchemyError

from padstudio.errors import StudioError
from padstudio.flights.chunks import Chunks, Claim
from padstudio.flights.cluster.task import Engine, Outcome, Task, error_dict
from padstudio.flights.jobs import Flights
from padstudio.store.database.engine import storage_error
from padstudio.store.database.flight_tables import ChunkRow, FlightRow

logger = logging.getLogger(__name__)

# Between looks for tasks that hang; new work and ended tasks wake the thread at once.
_LOOK_S = 1.0
# Between looks where there is nothing to do, should a wake have been missed.
_REST_S = 60.0
# After a fault of the database or the engine, and while a disk is full.
_RETRY_S = 5.0
_FULL = "disk_full"
# Faults that pass: what was computed is kept until it can be stored.
_PASSING = (_FULL, "database_busy")


@dataclass(frozen=True)
class _Work:
    """A claim whose task is at work, until when on the clock that nobody sets, s."""

    claim: Claim
    until_s: float


class _FullDiskError(Exception):
    """A task found no room on a disk; it is queued again."""


class Runner:
    """One thread that keeps the engine busy while there is work.

    Parameters
    ----------
    flights : Flights
    chunks : Chunks
    engine : Engine
    task_of : callable
        Makes the task of a flight's chunk; runs in this thread.
    idle_s : float or None
        After so long without work the engine lets go of what it holds; None keeps it.
    now : callable
        The time, s.
    """

    def __init__(
        self,
        flights: Flights,
        chunks: Chunks,
        engine: Engine,
        task_of: Callable[[FlightRow, ChunkRow], Task],
        idle_s: float | None = None,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self._flights, self._chunks, self._engine = flights, chunks, engine
        self._task_of = task_of
        self._ended: queue.SimpleQueue[tuple[Claim, Outcome] | None] = queue.SimpleQueue()
        self._unstored: deque[tuple[Claim, Outcome]] = deque()
        self._at_work: dict[str, _Work] = {}
        self._trouble: str | None = None
        self._idle_s, self._now = idle_s, now
        # Since when there is nothing to do.
        self._rests_since_s: float | None = None
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._run, name="flights", daemon=True)

    def start(self) -> None:
        """Begin, with what an earlier server left unfinished."""
        self._thread.start()

    @property
    def trouble(self) -> str | None:
        """Why queued work does not go on at present, a sentence; None where it does."""
        return self._trouble

    def wake(self) -> None:
        """Look for new or cancelled work now."""
        self._ended.put(None)

    def close(self) -> None:
        """Stop; what is unfinished is queued again at the next start."""
        self._closing.set()
        self.wake()
        if self._thread.is_alive():
            self._thread.join()
        self._engine.close()
        # A disk that is full keeps this from being written; the next start does it in any case.
        with contextlib.suppress(SQLAlchemyError):
            self._chunks.release_all()

    def _run(self) -> None:
        is_fresh = True
        while not self._closing.is_set():
            try:
                if is_fresh:
                    self._release_others()
                    is_fresh = False
                self._take_ended()
                self._stop_unwanted()
                is_idle = not self._flights.purge() and self._fill() and not self._at_work
                self._tell(self._engine.tend() if self._at_work else None)
                self._rest(is_idle)
                continue
            except SQLAlchemyError as error:
                self._pause(storage_error(error).message, error)
            except _FullDiskError as error:
                self._pause(str(error))
            except Exception as error:
                self._pause(f"workers cannot be started or reached ({error})", error)
            # Claims may have been made of which nothing is known here.
            is_fresh = True
            self._rests_since_s = None

    def _release_others(self) -> None:
        """Queue again what is claimed and neither at work nor kept."""
        mine = {work.claim.chunk for work in self._at_work.values()}
        self._chunks.release_all(mine | {claim.chunk for claim, _ in self._unstored})

    def _pause(self, why: str, error: Exception | None = None) -> None:
        """Let some time go by, and say why."""
        self._tell(f"{why}; trying again every {_RETRY_S:.0f} s", error)
        self._closing.wait(_RETRY_S)

    def _tell(self, trouble: str | None, error: Exception | None = None) -> None:
        """Keep what is the trouble; the log has its begin and its end."""
        if trouble and trouble != self._trouble:
            logger.warning("flights wait: %s", trouble, exc_info=error)
        elif self._trouble and not trouble:
            logger.warning("flights go on")
        self._trouble = trouble

    def _rest(self, is_idle: bool) -> None:
        """Note whether there is nothing to do, and let go of the engine's workers in the end."""
        if not is_idle:
            self._rests_since_s = None
            return
        if self._rests_since_s is None:
            self._rests_since_s = self._now()
        if self._idle_s is not None and self._now() - self._rests_since_s >= self._idle_s:
            self._engine.rest()

    def _wait_s(self) -> float:
        """How long to wait for something to happen."""
        if self._rests_since_s is None:
            return _LOOK_S
        left_s = self._rests_since_s + (self._idle_s or 0.0) - self._now()
        return min(_REST_S, left_s) if left_s > 0 else _REST_S

    def _fill(self) -> bool:
        """Claim as much as the engine can do; True where nothing waits for it."""
        limit = self._engine.room(len(self._at_work))
        if limit <= 0:
            return False
        claims = self._chunks.claim(limit)
        for claim in claims:
            self._submit(claim)
        return not claims

    def _submit(self, claim: Claim) -> None:
        loaded = self._chunks.load(claim)
        if loaded is None:
            return
        try:
            task = self._task_of(*loaded)
        except StudioError as error:
            if error.error_code == _FULL:
                raise _FullDiskError(error.message) from error
            self._chunks.fail(claim, error_dict(error))
            return
        key = _key(claim)
        self._at_work[key] = _Work(claim, time.monotonic() + claim.limit_s)
        try:
            self._engine.submit(key, task, partial(self._on_ended, claim))
        except BaseException:
            self._at_work.pop(key, None)
            raise

    def _on_ended(self, claim: Claim, outcome: Outcome) -> None:
        self._ended.put((claim, outcome))

    def _take_ended(self) -> None:
        """Wait for something to happen, and bring all that did to the database."""
        wait = None if self._unstored else self._wait_s()
        with contextlib.suppress(queue.Empty):
            while True:
                ended = self._ended.get(timeout=wait) if wait else self._ended.get_nowait()
                wait = None
                if ended is not None:
                    self._unstored.append(ended)
        self._store_all()

    def _store_all(self) -> None:
        """Store what came of claims; what cannot be stored now is kept, and nothing behind it lost.

        Raises
        ------
        SQLAlchemyError
            While the database is away or its disk full.
        _FullDiskError
            If a task found no room.
        """
        full: str | None = None
        while self._unstored:
            claim, outcome = self._unstored[0]
            full = self._stored(claim, outcome) or full
            self._unstored.popleft()
            self._at_work.pop(_key(claim), None)
        if full:
            raise _FullDiskError(full)

    def _stored(self, claim: Claim, outcome: Outcome) -> str | None:
        """Store what came of a claim; a sentence where its task found a disk full."""
        refusal = outcome.error or {}
        if outcome.kind == "refused" and refusal.get("code") == _FULL:
            self._chunks.release(claim)
            return str(refusal["message"])
        try:
            self._store(claim, outcome)
        except SQLAlchemyError as error:
            fault = storage_error(error)
            if fault.error_code in _PASSING:
                raise
            logger.exception("a result cannot be stored")
            what = error_dict(fault)
            what["message"] = f"the results could not be stored: {fault.message}"
            self._chunks.fail(claim, what)
        return None

    def _store(self, claim: Claim, outcome: Outcome) -> None:
        error = outcome.error or {}
        if outcome.kind == "lost":
            self._chunks.release(claim)
        elif outcome.kind == "crashed":
            self._chunks.crash(claim, error)
        elif outcome.kind == "refused":
            self._chunks.fail(claim, error)
        elif claim.is_plan:
            self._chunks.finish_plan(claim, outcome.value)
        else:
            self._chunks.finish(claim, outcome.value)

    def _stop_unwanted(self) -> None:
        """Stop tasks that were cancelled, and give up those that hang."""
        now = time.monotonic()
        for key, work in list(self._at_work.items()):
            if not self._chunks.is_current(work.claim):
                self._engine.stop(key)
                self._at_work.pop(key, None)
            elif self._trouble is not None:
                # Waiting for a worker is not work.
                self._at_work[key] = _Work(work.claim, now + work.claim.limit_s)
            elif work.until_s < now:
                self._chunks.crash(work.claim, _TOO_LONG)
                self._engine.end_worker_of(key)
                self._at_work.pop(key, None)


def _key(claim: Claim) -> str:
    """Names a claim's task to the engine."""
    return f"chunk-{claim.chunk}-{claim.attempt}"


_TOO_LONG = {
    "code": "time_limit",
    "message": "the work took longer than its limit and was ended; the file may be damaged, or "
    "raise the limit in the settings",
    "detail": {},
}
