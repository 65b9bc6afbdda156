"""Brings queued chunks to the engine, and their results to the database."""

from __future__ import annotations

import contextlib
import logging
import queue
import threading
from collections.abc import Callable
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
_IDLE_S = 1.0
# After a fault of the database or the engine.
_RETRY_S = 5.0
# Waits between tries to store a result.
_STORE_AGAIN_S = (1.0, 5.0, 20.0)


class Runner:
    """One thread that keeps the engine busy while there is work.

    Parameters
    ----------
    flights : Flights
    chunks : Chunks
    engine : Engine
    task_of : callable
        Makes the task of a flight's chunk; runs in this thread.
    """

    def __init__(
        self,
        flights: Flights,
        chunks: Chunks,
        engine: Engine,
        task_of: Callable[[FlightRow, ChunkRow], Task],
    ) -> None:
        self._flights, self._chunks, self._engine = flights, chunks, engine
        self._task_of = task_of
        self._ended: queue.SimpleQueue[tuple[Claim, Outcome] | None] = queue.SimpleQueue()
        self._at_work: dict[str, Claim] = {}
        self._trouble: str | None = None
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
                    self._chunks.release_all()
                    is_fresh = False
                self._take_ended()
                self._stop_unwanted()
                if not self._flights.purge():
                    self._fill()
                self._trouble = self._engine.tend() if self._at_work else None
            except SQLAlchemyError as error:
                logger.exception("the database cannot be used; trying again")
                self._pause(storage_error(error).message)
            except Exception as error:
                logger.exception("the work on flights was interrupted; going on")
                self._pause(f"workers cannot be started or reached ({error})")

    def _pause(self, why: str) -> None:
        """Let some time go by, and say why."""
        self._trouble = f"{why}; trying again every {_RETRY_S:.0f} s"
        self._closing.wait(_RETRY_S)

    def _fill(self) -> None:
        """Claim as much as the engine can do."""
        limit = self._engine.room(len(self._at_work))
        if limit <= 0:
            return
        for claim in self._chunks.claim(limit):
            try:
                self._submit(claim)
            except BaseException:
                self._chunks.release(claim)
                raise

    def _submit(self, claim: Claim) -> None:
        loaded = self._chunks.load(claim)
        if loaded is None:
            return
        try:
            task = self._task_of(*loaded)
        except StudioError as error:
            self._chunks.fail(claim, error_dict(error))
            return
        key = f"chunk-{claim.chunk}-{claim.attempt}"
        self._at_work[key] = claim
        try:
            self._engine.submit(key, task, partial(self._on_ended, claim))
        except BaseException:
            self._at_work.pop(key, None)
            raise

    def _on_ended(self, claim: Claim, outcome: Outcome) -> None:
        self._ended.put((claim, outcome))

    def _take_ended(self) -> None:
        """Wait for something to happen, and bring all that did to the database."""
        wait: float | None = _IDLE_S
        while True:
            try:
                ended = self._ended.get(timeout=wait)
            except queue.Empty:
                return
            wait = 0
            if ended is not None:
                self._take(*ended)

    def _take(self, claim: Claim, outcome: Outcome) -> None:
        """Store what came of a claim; a database that is away for a moment costs no work."""
        for wait_s in (*_STORE_AGAIN_S, None):
            try:
                self._store(claim, outcome)
                break
            except SQLAlchemyError as error:
                logger.exception("a result cannot be stored")
                fault = storage_error(error)
                if wait_s is None or fault.error_code != "database_busy":
                    self._store_failed(claim, fault)
                    break
                if self._closing.wait(wait_s):
                    break
        self._at_work.pop(f"chunk-{claim.chunk}-{claim.attempt}", None)

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

    def _store_failed(self, claim: Claim, fault: StudioError) -> None:
        """End the flight by name; of the chunk's frames none was taken."""
        what = error_dict(fault)
        what["message"] = f"the results could not be stored: {fault.message}"
        while not self._closing.is_set():
            try:
                self._chunks.fail(claim, what)
                return
            except SQLAlchemyError:
                self._closing.wait(_RETRY_S)

    def _stop_unwanted(self) -> None:
        """Stop tasks that were cancelled, and give up those that hang."""
        claims = dict(self._at_work)
        for key, claim in claims.items():
            if not self._chunks.is_current(claim):
                self._engine.stop(key)
                self._at_work.pop(key, None)
        for claim in self._chunks.expired(list(claims.values())):
            key = f"chunk-{claim.chunk}-{claim.attempt}"
            self._chunks.crash(
                claim,
                {
                    "code": "time_limit",
                    "message": "the work took longer than its limit and was ended; the file may be "
                    "damaged, or raise the limit in the settings",
                    "detail": {},
                },
            )
            self._engine.end_worker_of(key)
            self._at_work.pop(key, None)
