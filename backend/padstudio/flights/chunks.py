"""The state machine of chunks: claimed, finished, failed, queued again.

A claim raises the chunk's attempt; whatever ends it has to name that attempt and finds nothing to
do where another claim came between, so that no result is taken twice. Only the server calls this.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from typing import Any

from sqlalchemy import func, insert, select, update
from sqlalchemy.orm import Session, sessionmaker, undefer

from padstudio.flights.results.fused_rows import fuse_around
from padstudio.flights.results.rows import insert_rows, rows_of
from padstudio.flights.tasks.frames import Record
from padstudio.flights.tasks.planning import Plan
from padstudio.store.database.flight_tables import OPEN, RECIPE, ChunkRow, FlightRow

# Enough for the slowest disk and a machine full of other work; only what hangs takes longer.
_LEASE_S, _FRAME_LEASE_S = 600.0, 10.0


@dataclass(frozen=True)
class Claim:
    """A chunk that the caller may work on.

    Attributes
    ----------
    chunk, flight : int
        Keys.
    attempt : int
        What the claim is ended with.
    is_plan : bool
        The chunk parts the flight's work into the others.
    limit_s : float
        Time for the work; what takes longer hangs.
    """

    chunk: int
    flight: int
    attempt: int
    is_plan: bool
    limit_s: float


class Chunks:
    """The chunks of a database's flights.

    Parameters
    ----------
    session : sessionmaker
    attempts : int
        Dead or hanging workers that one chunk may cost.
    lease_s, frame_lease_s : float
        Time for a chunk, and more of it for each frame.
    """

    def __init__(
        self,
        session: sessionmaker[Session],
        *,
        attempts: int = 3,
        lease_s: float = _LEASE_S,
        frame_lease_s: float = _FRAME_LEASE_S,
    ) -> None:
        self._session, self._attempts = session, attempts
        self._lease_s, self._frame_lease_s = lease_s, frame_lease_s

    def claim(self, limit: int) -> list[Claim]:
        """Take up to `limit` queued chunks, those of older flights first."""
        now = datetime.now(UTC)
        queued = (
            select(ChunkRow.id, ChunkRow.flight, ChunkRow.number, ChunkRow.frames)
            .join(FlightRow, FlightRow.key == ChunkRow.flight)
            .where(ChunkRow.state == "queued", FlightRow.state.in_(OPEN))
            .order_by(ChunkRow.flight, ChunkRow.number)
            .limit(limit)
        )
        claims = []
        with self._session.begin() as session:
            chosen = session.execute(queued).all()
            _hold(session, {chunk.flight for chunk in chosen})
            for chunk in chosen:
                seconds = self._lease_s + chunk.frames * self._frame_lease_s
                attempt = session.scalar(
                    update(ChunkRow)
                    # It may have been cancelled just before its flight was held.
                    .where(ChunkRow.id == chunk.id, ChunkRow.state == "queued")
                    .values(
                        state="running",
                        attempt=ChunkRow.attempt + 1,
                        lease_until=now + timedelta(seconds=seconds),
                    )
                    .returning(ChunkRow.attempt)
                )
                if attempt is not None:
                    is_plan = chunk.number == 0
                    claims.append(Claim(chunk.id, chunk.flight, attempt, is_plan, seconds))
            session.execute(
                update(FlightRow)
                .where(
                    FlightRow.key.in_({claim.flight for claim in claims}),
                    FlightRow.state == "queued",
                )
                .values(state="running", started_at=func.coalesce(FlightRow.started_at, now))
            )
        return claims

    def load(self, claim: Claim) -> tuple[FlightRow, ChunkRow] | None:
        """A claim's flight, with pads and camera, and chunk; None where they are gone."""
        with self._session() as session:
            flight = session.get(FlightRow, claim.flight, options=[*map(undefer, RECIPE)])
            chunk = session.get(
                ChunkRow, claim.chunk, options=[undefer(ChunkRow.pts), undefer(ChunkRow.numbers)]
            )
        return (flight, chunk) if flight and chunk else None

    def finish_plan(self, claim: Claim, plan: Plan) -> bool:
        """Take a plan: its chunks are queued. False where the claim is over."""
        with self._session.begin() as session:
            if not self._end(session, claim, state="done"):
                return False
            session.execute(
                insert(ChunkRow),
                [
                    {
                        "flight": claim.flight,
                        "number": number,
                        "state": "queued",
                        "source": chunk.source,
                        "first_frame": chunk.first_frame,
                        "frames": chunk.frames,
                        "pts": chunk.pts,
                        "numbers": chunk.numbers,
                    }
                    for number, chunk in enumerate(plan.chunks, 1)
                ],
            )
            session.execute(
                update(FlightRow)
                .where(FlightRow.key == claim.flight)
                .values(
                    sources=plan.sources,
                    telemetry=plan.telemetry,
                    frames_total=sum(chunk.frames for chunk in plan.chunks),
                )
            )
        return True

    def finish(self, claim: Claim, records: Sequence[Record]) -> bool:
        """Take the frames of a chunk, all or none. False where the claim is over."""
        frames, details = rows_of(claim.flight, claim.chunk, records)
        with self._session.begin() as session:
            if not self._end(session, claim, state="done"):
                return False
            request = session.execute(
                select(FlightRow.request).where(FlightRow.key == claim.flight)
            ).scalar_one()
            insert_rows(session, request, frames, details)
            numbers = range(frames[0]["number"], frames[-1]["number"] + 1)
            # Poses of a live session were fused when they came.
            if not request.get("live"):
                fuse_around(session, claim.flight, request, numbers)
            session.execute(
                update(FlightRow)
                .where(FlightRow.key == claim.flight)
                .values(
                    frames_done=FlightRow.frames_done + len(frames),
                    frames_ok=FlightRow.frames_ok + sum(row["status"] == "ok" for row in frames),
                )
            )
            self._settle(session, claim.flight)
        return True

    def fail(self, claim: Claim, error: dict[str, Any]) -> bool:
        """End a chunk for good with ``{"code", "message", "detail"}``. False where it is over."""
        with self._session.begin() as session:
            if not self._end(session, claim, state="failed", error=error):
                return False
            self._settle(session, claim.flight)
        return True

    def crash(self, claim: Claim, error: dict[str, Any]) -> bool:
        """Queue a chunk again whose worker died or hung; too often, and it fails with `error`."""
        with self._session.begin() as session:
            chunk = session.get(ChunkRow, claim.chunk)
            failures = chunk.failures + 1 if chunk else 0
            again = failures < self._attempts
            values = {"state": "queued"} if again else {"state": "failed", "error": error}
            if not self._end(session, claim, failures=failures, **values):
                return False
            if not again:
                self._settle(session, claim.flight)
        return True

    def release(self, claim: Claim) -> bool:
        """Queue a chunk again that nobody could work on."""
        with self._session.begin() as session:
            return self._end(session, claim, state="queued")

    def release_all(self, besides: Collection[int] = ()) -> int:
        """Queue everything unfinished again: no task outlives the server that asked for it.

        Parameters
        ----------
        besides : collection of int
            Chunks that somebody is at.
        """
        with self._session.begin() as session:
            released = session.execute(
                update(ChunkRow)
                .where(ChunkRow.state == "running", ChunkRow.id.not_in(besides))
                .values(state="queued", lease_until=None)
            )
            return int(released.rowcount)  # type: ignore[attr-defined]

    def is_current(self, claim: Claim) -> bool:
        """False where a claim was cancelled."""
        with self._session() as session:
            chunk = session.get(ChunkRow, claim.chunk)
            return bool(chunk and chunk.attempt == claim.attempt and chunk.state == "running")

    @staticmethod
    def _end(session: Session, claim: Claim, **values: Any) -> bool:
        _hold(session, {claim.flight})
        ended = session.execute(
            update(ChunkRow)
            .where(
                ChunkRow.id == claim.chunk,
                ChunkRow.attempt == claim.attempt,
                ChunkRow.state == "running",
            )
            .values(lease_until=None, **values)
        )
        return bool(ended.rowcount)  # type: ignore[attr-defined]

    @staticmethod
    def _settle(session: Session, flight: int) -> None:
        """End a flight whose last chunk has ended."""
        mine = ChunkRow.flight == flight
        open_chunk = select(ChunkRow.id).where(mine, ChunkRow.state.in_(OPEN)).limit(1)
        if session.scalar(open_chunk) is not None:
            return
        failed = list(
            session.scalars(
                select(ChunkRow).where(mine, ChunkRow.state == "failed").order_by(ChunkRow.number)
            )
        )
        session.execute(
            update(FlightRow)
            .where(FlightRow.key == flight, FlightRow.state.in_(OPEN))
            .values(
                state="failed" if failed else "done",
                error=_summary(failed) if failed else None,
                finished_at=datetime.now(UTC),
            )
        )


def _hold(session: Session, flights: set[int]) -> None:
    """Lock flights before their chunks, as whoever cancels one does, lest both wait for ever.

    SQLite has one writer at a time and needs no such locks.
    """
    locked = select(FlightRow.key).where(FlightRow.key.in_(flights)).order_by(FlightRow.key)
    session.execute(locked.with_for_update())


def _summary(failed: Sequence[ChunkRow]) -> dict[str, Any]:
    """The first failure, and which frames are missing."""
    first = dict(failed[0].error or {})
    if failed[0].number == 0:
        return first
    parts = [{"first_frame": chunk.first_frame, "frames": chunk.frames} for chunk in failed]
    missing = sum(chunk.frames for chunk in failed)
    message = (
        f"{missing} frames have no result, the first of them frame {failed[0].first_frame}: "
        f"{first.get('message', '')}"
    )
    return {**first, "message": message, "detail": {"missing": parts}}
