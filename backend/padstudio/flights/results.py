"""Reads the results of flights: pages of frames, one frame, figures over all of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from sqlalchemy import ColumnElement, Select, case, func, select
from sqlalchemy.orm import Session, sessionmaker, undefer

from padstudio.errors import NotFoundError
from padstudio.flights.flight_tables import ChunkRow, FlightRow, FrameDetailRow, FrameRow
from padstudio.flights.result_rows import Record, record_of

_READ_ROWS = 2_000


@dataclass(frozen=True, kw_only=True)
class FrameFilter:
    """Which frames; None asks for nothing.

    Attributes
    ----------
    status : {"ok", "failed"} or None
    reason, stage, layer : str or None
    from_s, to_s : float or None
        Time, s; the end is not within.
    min_height, max_height : float or None
        Height of the camera over the pad, mm.
    """

    status: str | None = None
    reason: str | None = None
    stage: str | None = None
    layer: str | None = None
    from_s: float | None = None
    to_s: float | None = None
    min_height: float | None = None
    max_height: float | None = None

    def conditions(self) -> list[ColumnElement[bool]]:
        """The conditions on `FrameRow`."""
        pairs = (
            (self.status, FrameRow.status.__eq__),
            (self.reason, FrameRow.reason.__eq__),
            (self.stage, FrameRow.stage.__eq__),
            (self.layer, FrameRow.layer.__eq__),
            (self.from_s, FrameRow.time_s.__ge__),
            (self.to_s, FrameRow.time_s.__lt__),
            (self.min_height, FrameRow.z_mm.__ge__),
            (self.max_height, FrameRow.z_mm.__le__),
        )
        return [compare(value) for value, compare in pairs if value is not None]


class Results:
    """The frames of a database's flights.

    Parameters
    ----------
    session : sessionmaker
    """

    def __init__(self, session: sessionmaker[Session]) -> None:
        self._session = session

    def page(
        self,
        flight: FlightRow,
        wanted: FrameFilter,
        limit: int,
        after: int | None = None,
        before: int | None = None,
    ) -> list[Record]:
        """Frames in the order of their numbers.

        Parameters
        ----------
        flight : FlightRow
        wanted : FrameFilter
        limit : int
        after : int or None
            Only frames of a higher number: the last of the page before.
        before : int or None
            Only frames of a lower number, and of these the last ones.

        Returns
        -------
        list of dict
            As `padstudio.flights.result_rows.record_of`.
        """
        # The numbers first, from the table of short rows; the rest of a page's rows alone.
        numbers = select(FrameRow.number).where(FrameRow.flight == flight.key, *wanted.conditions())
        if after is not None:
            numbers = numbers.where(FrameRow.number > after)
        if before is not None:
            numbers = numbers.where(FrameRow.number < before)
        backwards = before is not None and after is None
        order = FrameRow.number.desc() if backwards else FrameRow.number
        with self._session() as session:
            chosen = session.scalars(numbers.order_by(order).limit(limit)).all()
            rows = session.execute(_rows(flight.key).where(FrameRow.number.in_(chosen)))
            return [record_of(frame, body) for frame, body in rows]

    def frame(self, flight: FlightRow, number: int) -> Record:
        """One frame.

        Raises
        ------
        NotFoundError
            If it has no result (yet).
        """
        with self._session() as session:
            row = session.execute(_rows(flight.key).where(FrameRow.number == number)).first()
        if row is None:
            raise NotFoundError(f"frame {number} of this flight has no result", code="no_result")
        return record_of(*row)

    def every(self, flight: FlightRow) -> Iterator[Record]:
        """All frames in order, read little by little."""
        after = -1
        while page := self.page(flight, FrameFilter(), _READ_ROWS, after):
            yield from page
            after = page[-1]["frame"]

    def chunk_of(self, flight: FlightRow, number: int) -> ChunkRow:
        """The chunk that a frame belongs to, with its timestamps.

        Raises
        ------
        NotFoundError
            If the flight does not have that frame, or was not told to read it.
        """
        stride = flight.request["stride"]
        last = ChunkRow.first_frame + (ChunkRow.frames - 1) * stride
        with self._session() as session:
            chunk = session.scalar(
                select(ChunkRow)
                .where(
                    ChunkRow.flight == flight.key,
                    ChunkRow.number > 0,
                    ChunkRow.first_frame <= number,
                    last >= number,
                )
                .options(undefer(ChunkRow.pts))
            )
        if chunk is None or (number - chunk.first_frame) % stride:
            raise NotFoundError(f"this flight does not read frame {number}", code="no_such_frame")
        return chunk

    def summary(self, flight: FlightRow, points: int = 2000) -> dict[str, Any]:
        """Figures over all frames that have a result, JSON-serialisable.

        Parameters
        ----------
        flight : FlightRow
        points : int
            Most points of the series of heights.

        Returns
        -------
        dict
            ``frames``, ``ok``, ``share_ok``; ``longest_gap`` (first and last frame, frames and
            seconds without a pose); ``stages``, ``reasons`` and ``layers`` (counts, highest
            first); ``timeline`` (ok and failed frames of each second); ``heights`` (frame, time,
            height).
        """
        with self._session() as session:
            totals = session.execute(
                select(func.count(), func.sum(case((FrameRow.status == "ok", 1), else_=0))).where(
                    FrameRow.flight == flight.key
                )
            ).one()
            frames, ok = int(totals[0]), int(totals[1] or 0)
            return {
                "frames": frames,
                "ok": ok,
                "share_ok": ok / frames if frames else None,
                "longest_gap": _longest_gap(session, flight.key),
                "stages": _counts(session, flight.key, FrameRow.stage),
                "reasons": _counts(session, flight.key, FrameRow.reason),
                "layers": _counts(session, flight.key, FrameRow.layer),
                "timeline": _timeline(session, flight.key),
                "heights": _heights(session, flight.key, max(1, -(-ok // points))),
            }


def _rows(flight: int) -> Select[tuple[FrameRow, dict[str, Any]]]:
    return (
        select(FrameRow, FrameDetailRow.body)
        .join(
            FrameDetailRow,
            (FrameDetailRow.flight == FrameRow.flight) & (FrameDetailRow.number == FrameRow.number),
        )
        .where(FrameRow.flight == flight)
        .order_by(FrameRow.number)
    )


def _counts(session: Session, flight: int, column: Any) -> dict[str, int]:
    found = session.execute(
        select(column, func.count())
        .where(FrameRow.flight == flight, column.is_not(None))
        .group_by(column)
        .order_by(func.count().desc(), column)
    )
    return {name: int(count) for name, count in found}


def _longest_gap(session: Session, flight: int) -> dict[str, Any] | None:
    """The longest run of failed frames; the times of the poses around it tell its seconds."""
    rows = session.execute(
        select(FrameRow.number, FrameRow.time_s, FrameRow.status)
        .where(FrameRow.flight == flight)
        .order_by(FrameRow.number)
    ).all()
    failed = np.array([row.status != "ok" for row in rows], bool)
    if not failed.any():
        return None
    edges = np.flatnonzero(np.diff(np.r_[False, failed, False].astype(np.int8)))
    starts, ends = edges[::2], edges[1::2]
    longest = int(np.argmax(ends - starts))
    start, end = int(starts[longest]), int(ends[longest])
    before, after = rows[max(0, start - 1)], rows[min(len(rows) - 1, end)]
    timed = before.time_s is not None and after.time_s is not None
    return {
        "first_frame": rows[start].number,
        "last_frame": rows[end - 1].number,
        "frames": end - start,
        "seconds": after.time_s - before.time_s if timed else None,
    }


def _timeline(session: Session, flight: int) -> list[dict[str, Any]]:
    """Outcomes of each second; of each hundred frames where they have no times."""
    second = func.floor(func.coalesce(FrameRow.time_s, FrameRow.number / 100.0))
    rows = session.execute(
        select(
            second,
            func.min(FrameRow.number),
            func.count(),
            func.sum(case((FrameRow.status == "ok", 1), else_=0)),
        )
        .where(FrameRow.flight == flight)
        .group_by(second)
        .order_by(second)
    )
    return [
        {"at": int(at), "first_frame": first, "ok": int(ok), "failed": int(count - ok)}
        for at, first, count, ok in rows
    ]


def _heights(session: Session, flight: int, every: int) -> dict[str, list[Any]]:
    place = func.row_number().over(order_by=FrameRow.number)
    numbered = (
        select(FrameRow.number, FrameRow.time_s, FrameRow.z_mm, place.label("place"))
        .where(FrameRow.flight == flight, FrameRow.status == "ok")
        .subquery()
    )
    rows = session.execute(
        select(numbered.c.number, numbered.c.time_s, numbered.c.z_mm)
        .where((numbered.c.place - 1) % every == 0)
        .order_by(numbered.c.number)
    ).all()
    return {
        "frame": [row.number for row in rows],
        "time_s": [row.time_s for row in rows],
        "height_mm": [row.z_mm for row in rows],
    }
