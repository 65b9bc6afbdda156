"""Callbacks of flights that have ended, in the database: which are due, and how they went.

That one is due follows from the state of its flight, so that none is lost wherever the server is
ended. An attempt is written down before it is made: a server that ends in the middle of one makes
it again, and so a callback is delivered at least once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from typing import Any

from sqlalchemy import or_, select, update
from sqlalchemy.orm import Session, sessionmaker

from padstudio.store.database.data_folder import new_id
from padstudio.store.database.flight_tables import ENDED, CallbackRow, FlightRow


@dataclass(frozen=True)
class DueCallback:
    """A callback that is to be made now.

    Attributes
    ----------
    delivery : str
        Its id.
    url : str
    attempts : int
        Made before.
    flight : FlightRow
    """

    delivery: str
    url: str
    attempts: int
    flight: FlightRow


class Callbacks:
    """The callbacks of a database's flights.

    Parameters
    ----------
    session : sessionmaker
    """

    def __init__(self, session: sessionmaker[Session]) -> None:
        self._session = session

    def of(self, flight: FlightRow) -> CallbackRow | None:
        """A flight's; None where nobody is called."""
        with self._session() as session:
            return session.get(CallbackRow, flight.key)

    def due(self, limit: int) -> Sequence[DueCallback]:
        """Up to so many that are to be made now, those that wait longest first."""
        now = datetime.now(UTC)
        chosen = (
            select(CallbackRow, FlightRow)
            .join(FlightRow, FlightRow.key == CallbackRow.flight)
            .where(
                CallbackRow.state == "open",
                FlightRow.state.in_(ENDED),
                or_(CallbackRow.next_at.is_(None), CallbackRow.next_at <= now),
            )
            .order_by(FlightRow.finished_at, FlightRow.key)
            .limit(limit)
        )
        with self._session() as session:
            return [
                DueCallback(row.delivery, row.url, row.attempts, flight)
                for row, flight in session.execute(chosen)
            ]

    def begin(self, due: DueCallback, wait_s: float) -> bool:
        """Count an attempt; False where the flight goes on by now, or somebody else made it.

        Parameters
        ----------
        due : DueCallback
        wait_s : float
            Until the next attempt, unless this one is told to have succeeded.
        """
        next_at = datetime.now(UTC) + timedelta(seconds=wait_s)
        counted = {"attempts": due.attempts + 1, "next_at": next_at}
        return self._set(due, due.attempts, counted)

    def delivered(self, due: DueCallback) -> None:
        """The attempt that began was taken."""
        now = datetime.now(UTC)
        told = {"state": "delivered", "delivered_at": now, "next_at": None, "error": None}
        self._set(due, due.attempts + 1, told)

    def failed(self, due: DueCallback, error: str, *, is_last: bool) -> None:
        """The attempt that began was not taken, for a reason; after the last there is no other."""
        ended = {"state": "given_up", "next_at": None} if is_last else {}
        self._set(due, due.attempts + 1, {"error": error, **ended})

    def _set(self, due: DueCallback, attempts: int, values: dict[str, Any]) -> bool:
        mine = (
            CallbackRow.delivery == due.delivery,
            CallbackRow.state == "open",
            CallbackRow.attempts == attempts,
        )
        with self._session.begin() as session:
            changed = session.execute(update(CallbackRow).where(*mine).values(**values))
            return bool(changed.rowcount)  # type: ignore[attr-defined]


def add_callback(session: Session, flight: int, url: str) -> None:
    """Have somebody called when a flight ends."""
    row = CallbackRow(flight=flight, delivery=new_id(), url=url, state="open", attempts=0)
    session.add(row)


def renew_callback(session: Session, flight: int) -> None:
    """Call once more, when a flight that goes on has ended again."""
    fresh = {"state": "open", "attempts": 0, "next_at": None, "delivered_at": None, "error": None}
    mine = CallbackRow.flight == flight
    session.execute(update(CallbackRow).where(mine).values(delivery=new_id(), **fresh))
