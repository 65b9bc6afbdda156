"""Comparisons of flights with their vehicles' logs; the last ones are kept."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from sqlalchemy.orm import Session, sessionmaker

from padstudio.flights.results.answer_cache import KeptAnswers
from padstudio.flights.vehicle.comparison import compare
from padstudio.flights.vehicle.ours import poses_of
from padstudio.store.database.flight_tables import FlightRow


class VehicleAnswers:
    """Of a database's flights.

    Parameters
    ----------
    session : sessionmaker
    """

    def __init__(self, session: sessionmaker[Session]) -> None:
        self._session = session
        self._kept = KeptAnswers(most=50)

    def compare(self, flight: FlightRow, run: Callable[..., Any]) -> dict[str, Any]:
        """As `padstudio.flights.vehicle.comparison.compare`.

        Parameters
        ----------
        flight : FlightRow
            Loaded with its telemetry, which it has.
        run : callable
            Calls a function in a worker process and waits for it.
        """

        def find_out() -> dict[str, Any]:
            found: dict[str, Any] = run(compare, poses_of(self._session, flight), flight.telemetry)
            return found

        return self._kept.of(flight, "vehicle", find_out)
