"""Flights as jobs: made, cancelled, tried again, run again, removed.

The database is the truth; whatever runs the work may die at any time. States: ``queued`` →
``running`` → ``done``, ``failed`` or ``cancelled``; ``deleting`` while the rows go.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import delete, func, select, update
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session, sessionmaker, undefer

from padstudio.errors import ConflictError, LimitError, NotFoundError
from padstudio.flights.callbacks import add_callback, renew_callback
from padstudio.store.database.data_folder import new_id
from padstudio.store.database.flight_tables import (
    OPEN,
    RECIPE,
    ChunkRow,
    FlightRow,
    FlightUploadRow,
    FrameDetailRow,
    FrameRow,
)

# Of one transaction: other writers wait for no more than these.
_DELETE_ROWS = 20_000


@dataclass(frozen=True)
class FlightOrder:
    """What a flight is made of.

    Attributes
    ----------
    name : str
    uploads : sequence of str
        Ids, in the order of their frames.
    pad, camera : str
        The content of a pad file and of a camera file.
    request : mapping
        JSON-serialisable: ``method``, ``params``, ``first_frame``, ``end_frame``, ``stride``,
        ``apply_rotation``, ``fuse``, ``smooth``, and what else lists show.
    rerun_of : str or None
    other_pads : sequence of str
        The content of more pad files, of pads that frames may show as well, or instead.
    callback : str or None
        URL of who is called when the flight has ended; it has been checked.
    key : str or None
        What no other flight is ordered under.
    """

    name: str
    uploads: Sequence[str]
    pad: str
    camera: str
    request: Mapping[str, Any] = field(default_factory=dict)
    rerun_of: str | None = None
    other_pads: Sequence[str] = ()
    callback: str | None = None
    key: str | None = None


class Flights:
    """The flights of a database.

    Parameters
    ----------
    session : sessionmaker
    max_open : int
        Flights that may be queued or running at a time.
    """

    def __init__(self, session: sessionmaker[Session], max_open: int = 1000) -> None:
        self._session, self._max_open = session, max_open

    def create(self, order: FlightOrder) -> FlightRow:
        """Queue a flight; one that was ordered under the same key is the one that is there.

        Raises
        ------
        LimitError
            If too many are queued or running.
        NotFoundError
            If an upload was removed meanwhile.
        """
        flight = FlightRow(
            id=new_id(),
            created_at=datetime.now(UTC),
            name=order.name,
            state="queued",
            request=json.loads(json.dumps(dict(order.request))),
            sources=[],
            frames_done=0,
            frames_ok=0,
            rerun_of=order.rerun_of,
            pad=order.pad,
            other_pads=list(order.other_pads),
            camera=order.camera,
            order_key=order.key,
        )
        try:
            with self._session.begin() as session:
                self._check_room(session)
                session.add(flight)
                session.flush()
                session.add_all(
                    FlightUploadRow(flight=flight.key, place=place, upload=upload)
                    for place, upload in enumerate(order.uploads)
                )
                session.add(ChunkRow(flight=flight.key, number=0, state="queued"))
                if order.callback is not None:
                    add_callback(session, flight.key, order.callback)
        except IntegrityError as error:
            known = None if order.key is None else self.of_key(order.key)
            if known is not None:
                return known
            raise NotFoundError("an upload of this flight was removed; upload it again") from error
        return self.get(flight.id)

    def list(
        self, limit: int, offset: int, state: str | None = None
    ) -> tuple[list[FlightRow], int]:
        """A page of flights, newest first, and how many there are."""
        shown = select(FlightRow).where(FlightRow.state != "deleting")
        if state is not None:
            shown = shown.where(FlightRow.state == state)
        newest = shown.order_by(FlightRow.created_at.desc(), FlightRow.key.desc())
        with self._session() as session:
            total = session.scalar(select(func.count()).select_from(shown.subquery())) or 0
            return list(session.scalars(newest.limit(limit).offset(offset))), total

    def get(self, flight_id: str, *, texts: bool = False) -> FlightRow:
        """One flight.

        Parameters
        ----------
        flight_id : str
        texts : bool
            With its pads, camera and telemetry.

        Raises
        ------
        NotFoundError
        """
        options = [*map(undefer, RECIPE), undefer(FlightRow.telemetry)]
        with self._session() as session:
            found = session.scalar(
                select(FlightRow)
                .where(FlightRow.id == flight_id, FlightRow.state != "deleting")
                .options(*(options if texts else ()))
            )
        if found is None:
            raise NotFoundError("there is no flight of that id; the list of flights has them all")
        return found

    def of_key(self, key: str) -> FlightRow | None:
        """The flight that was ordered under a key; None where there is none."""
        ordered = select(FlightRow).where(FlightRow.order_key == key)
        with self._session() as session:
            return session.scalar(ordered)

    def uploads(self, flight: FlightRow) -> tuple[str, ...]:
        """Ids of the uploads that a flight reads, in order."""
        places = select(FlightUploadRow.upload).where(FlightUploadRow.flight == flight.key)
        with self._session() as session:
            return tuple(session.scalars(places.order_by(FlightUploadRow.place)))

    def cancel(self, flight_id: str) -> FlightRow:
        """Stop a flight; what is finished stays. Nothing happens where it is over already."""
        flight = self.get(flight_id)
        with self._session.begin() as session:
            changed = session.execute(
                update(FlightRow)
                .where(FlightRow.key == flight.key, FlightRow.state.in_(OPEN))
                .values(state="cancelled", finished_at=datetime.now(UTC))
            )
            if changed.rowcount:  # type: ignore[attr-defined]
                self._end_chunks(session, flight.key)
        return self.get(flight_id)

    def retry(self, flight_id: str) -> FlightRow:
        """Queue what failed or was cancelled again; finished chunks are kept.

        Raises
        ------
        ConflictError
            If the flight is still at work, or done.
        """
        flight = self.get(flight_id)
        with self._session.begin() as session:
            changed = session.execute(
                update(FlightRow)
                .where(FlightRow.key == flight.key, FlightRow.state.in_(("failed", "cancelled")))
                .values(state="queued", finished_at=None, error=None)
            )
            if not changed.rowcount:  # type: ignore[attr-defined]
                raise ConflictError(
                    f"the flight is {flight.state}: only failed and cancelled ones are tried again;"
                    " run it again with other parameters instead",
                    code="not_retryable",
                )
            session.execute(
                update(ChunkRow)
                .where(ChunkRow.flight == flight.key, ChunkRow.state.in_(("failed", "cancelled")))
                .values(state="queued", failures=0, error=None, lease_until=None)
            )
            renew_callback(session, flight.key)
        return self.get(flight_id)

    def rename(self, flight_id: str, name: str) -> FlightRow:
        """Call a flight otherwise; raises as `get`."""
        flight = self.get(flight_id)
        with self._session.begin() as session:
            session.execute(update(FlightRow).where(FlightRow.key == flight.key).values(name=name))
        return self.get(flight_id)

    def delete(self, flight_id: str) -> None:
        """Hide a flight and stop its work; `purge` removes its rows."""
        flight = self.get(flight_id)
        with self._session.begin() as session:
            session.execute(
                update(FlightRow)
                .where(FlightRow.key == flight.key)
                .values(state="deleting", order_key=None)
            )
            self._end_chunks(session, flight.key)
            # From now on its uploads may go.
            session.execute(delete(FlightUploadRow).where(FlightUploadRow.flight == flight.key))

    def purge(self) -> bool:
        """Remove some rows of deleted flights; False where none are left.

        Few at a time, so that other writers need not wait for a flight of a million frames.
        """
        with self._session.begin() as session:
            key = session.scalar(
                select(FlightRow.key).where(FlightRow.state == "deleting").limit(1)
            )
            if key is None:
                return False
            for table in (FrameDetailRow, FrameRow):
                some = select(table.number).where(table.flight == key).limit(_DELETE_ROWS)
                numbers = list(session.scalars(some.order_by(table.number)))
                if numbers:
                    session.execute(
                        delete(table).where(table.flight == key, table.number <= numbers[-1])
                    )
                    return True
            session.execute(delete(FlightRow).where(FlightRow.key == key))
        return True

    def _check_room(self, session: Session) -> None:
        count = select(func.count()).select_from(FlightRow).where(FlightRow.state.in_(OPEN))
        if (session.scalar(count) or 0) >= self._max_open:
            raise LimitError(
                f"{self._max_open} flights are queued or running, the limit; wait for some to "
                "finish, or cancel some",
                code="too_many_flights",
            )

    @staticmethod
    def _end_chunks(session: Session, key: int) -> None:
        session.execute(
            update(ChunkRow)
            .where(ChunkRow.flight == key, ChunkRow.state.in_(OPEN))
            # A late result of the attempt under way finds that it is no longer wanted.
            .values(state="cancelled", attempt=ChunkRow.attempt + 1, lease_until=None)
        )
