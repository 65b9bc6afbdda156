"""Fuses the poses of a flight's rows as its chunks come in, in whatever order.

What a frame's fused pose is follows from the frames' own poses within `REACH_S` of it, and from
nothing else: the filter remembers a second or two. So each chunk that comes in settles its own
frames and those near it that are there already, and in the end every frame is what it would be had
the flight been worked on by one.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from sqlalchemy import select, update
from sqlalchemy.orm import Session

from padstudio.flights.results.bins import sum_up_again
from padstudio.flights.results.fusing import Fusion, fused_records
from padstudio.flights.results.rows import Record, record_of, rows_of, select_rows
from padstudio.store.database.flight_tables import FrameDetailRow, FrameRow

#: How far a frame's own pose matters to others, s: several times as long as the filter remembers.
REACH_S = 6.0


def fusion_of(request: Mapping[str, Any]) -> Fusion:
    """How a flight's request has poses fused; flights of older programs were not."""
    if not request.get("fuse", False):
        return "none"
    return "smooth" if request.get("smooth", False) else "filter"


def fuse_around(session: Session, flight: int, request: Mapping[str, Any], numbers: range) -> None:
    """Fuse frames that were just stored, and those near them.

    Parameters
    ----------
    session : Session
        In a transaction.
    flight : int
        Its key.
    request : mapping
        The flight's.
    numbers : range
        From the first to the last stored frame.
    """
    fusion = fusion_of(request)
    ends = None if fusion == "none" else _times_of(session, flight, numbers)
    if ends is None:
        return
    before_s = REACH_S if fusion == "smooth" else 0.0
    first_s, last_s = ends[0] - before_s, ends[1] + REACH_S
    near = select_rows(flight).where(
        FrameRow.time_s >= first_s - REACH_S,
        FrameRow.time_s <= last_s + (REACH_S if fusion == "smooth" else 0.0),
    )
    rows = [(frame.number, record_of(frame, body)) for frame, body in session.execute(near)]
    before = dict(rows)
    fused = fused_records((record for _, record in rows), fusion)
    changed = [
        record
        for record in fused
        if record["time_s"] is not None
        and first_s <= record["time_s"] <= last_s
        and record != before[record["frame"]]
    ]
    if changed:
        _write(session, flight, changed)
        sum_up_again(session, flight, changed[0]["frame"], changed[-1]["frame"])


def _times_of(session: Session, flight: int, numbers: range) -> tuple[float, float] | None:
    """When the first and the last of some frames were taken; None of stills."""
    found = session.scalars(
        select(FrameRow.time_s)
        .where(FrameRow.flight == flight, FrameRow.number.between(numbers[0], numbers[-1]))
        .order_by(FrameRow.number)
    )
    known = [time_s for time_s in found if time_s is not None]
    return (min(known), max(known)) if known else None


def _write(session: Session, flight: int, records: Iterable[Record]) -> None:
    # The chunk of a row stays what it is.
    frames, details = rows_of(flight, 0, list(records))
    session.execute(update(FrameRow), frames)
    session.execute(
        update(FrameDetailRow),
        [{key: row[key] for key in ("flight", "number", "body")} for row in details],
    )
