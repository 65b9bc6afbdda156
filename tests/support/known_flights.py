"""Flights whose frames are known, as they stand in the database."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Any

from sqlalchemy.orm import Session, sessionmaker

from padstudio.flights.results.rows import insert_rows
from padstudio.store.database.flight_tables import FlightRow

FRAMES = 5003
FPS = 25
LAYERS = ("red", "blue", "outline")
# A camera that looks straight down, turned by a half turn about X.
DOWN_XYZW = [1.0, 0.0, 0.0, 0.0]


def _frame(key: int, number: int, place: int) -> dict[str, Any]:
    failed = place % 7 == 3
    return {
        "flight": key,
        "number": number,
        "time_s": number / FPS,
        "status": "failed" if failed else "ok",
        "stage": ("grid", "lines")[place % 2] if failed else None,
        "reason": "no_lattice" if failed else None,
        "layer": None if failed else LAYERS[place % 3],
        "quality": None if failed else "bearing" if place % 5 == 1 else "full",
        "x_mm": None if failed else float(place),
        "y_mm": None if failed else -float(place),
        "z_mm": None if failed else 5000.0 - place / 2,
    }


def store_flight(
    session: sessionmaker[Session], *, first: int = 0, stride: int = 1, frames: int = FRAMES
) -> tuple[FlightRow, list[dict[str, Any]]]:
    """A flight with frames of known outcome; where the telemetry's heights are 5 % too small."""
    telemetry = {
        "time_s": [0.0, FRAMES * stride / FPS],
        "height_m": [5.0 / 1.05, (5.0 - FRAMES / 2000) / 1.05],
    }
    flight = FlightRow(
        id=f"flight-{first}-{stride}-{frames}",
        created_at=datetime.now(UTC),
        name="flight",
        state="done",
        request={"first_frame": first, "stride": stride},
        sources=[],
        pad="",
        camera="",
        telemetry=telemetry,
    )
    with session.begin() as open_session:
        open_session.add(flight)
        open_session.flush()
        rows = [_frame(flight.key, first + place * stride, place) for place in range(frames)]
        if rows:
            details = [
                {"flight": flight.key, "number": row["number"], "chunk": 1,
                 "body": {"quaternion_xyzw": DOWN_XYZW}}
                for row in rows
            ]  # fmt: skip
            insert_rows(open_session, flight.request, rows, details)
    return flight, rows
