"""Reads the results of flights: pages of frames, one frame, all of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from sqlalchemy import ColumnElement, func, select
from sqlalchemy.orm import Session, sessionmaker, undefer

from padstudio.errors import NotFoundError
from padstudio.flights.results.rows import Record, record_of, select_rows
from padstudio.flights.tasks.from_rows import numbers_of
from padstudio.store.database.flight_tables import ChunkRow, FlightRow, FrameRow

# Held in memory at a time, a few megabytes.
_READ_ROWS = 2_000


@dataclass(frozen=True, kw_only=True)
class FrameFilter:
    """Which frames; None asks for nothing.

    Attributes
    ----------
    status : {"ok", "failed"} or None
    reason, stage, layer, quality : str or None
    from_s, to_s : float or None
        Time, s; the end is not within.
    min_height, max_height : float or None
        Height of the camera over the pad, mm.
    """

    status: str | None = None
    reason: str | None = None
    stage: str | None = None
    layer: str | None = None
    quality: str | None = None
    from_s: float | None = None
    to_s: float | None = None
    min_height: float | None = None
    max_height: float | None = None

    def conditions(self) -> list[ColumnElement[bool]]:
        """The conditions on `FrameRow`, but for those on time."""
        pairs = (
            (self.status, FrameRow.status.__eq__),
            (self.reason, FrameRow.reason.__eq__),
            (self.stage, FrameRow.stage.__eq__),
            (self.layer, FrameRow.layer.__eq__),
            (self.quality, FrameRow.quality.__eq__),
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
            As `padstudio.flights.results.rows.record_of`.
        """
        # The numbers first, from the table of short rows; the rest of a page's rows alone.
        numbers = select(FrameRow.number).where(FrameRow.flight == flight.key, *wanted.conditions())
        if after is not None:
            numbers = numbers.where(FrameRow.number > after)
        if before is not None:
            numbers = numbers.where(FrameRow.number < before)
        # Times rise with the numbers, and numbers are what the table is sorted by.
        for time_s, compare in (
            (wanted.from_s, FrameRow.number.__ge__),
            (wanted.to_s, FrameRow.number.__lt__),
        ):
            if time_s is not None:
                numbers = numbers.where(compare(_first_from(flight.key, time_s)))
        backwards = before is not None and after is None
        order = FrameRow.number.desc() if backwards else FrameRow.number
        with self._session() as session:
            chosen = session.scalars(numbers.order_by(order).limit(limit)).all()
            rows = session.execute(select_rows(flight.key).where(FrameRow.number.in_(chosen)))
            return [record_of(frame, body) for frame, body in rows]

    def frame(self, flight: FlightRow, number: int) -> Record:
        """One frame.

        Raises
        ------
        NotFoundError
            If it has no result (yet).
        """
        with self._session() as session:
            row = session.execute(select_rows(flight.key).where(FrameRow.number == number)).first()
        if row is None:
            raise NotFoundError(f"frame {number} of this flight has no result", code="no_result")
        return record_of(*row)

    def every(self, flight: FlightRow) -> Iterator[Record]:
        """All frames in order, read little by little."""
        after = -1
        while page := self.page(flight, FrameFilter(), _READ_ROWS, after):
            yield from page
            after = page[-1]["frame"]

    def sample(self, flight: FlightRow, status: str, most: int) -> list[int]:
        """Numbers of frames of a status that were read, at most so many, evenly taken."""
        wanted = select(FrameRow.number).where(
            FrameRow.flight == flight.key,
            FrameRow.status == status,
            FrameRow.stage.is_distinct_from("read"),
        )
        with self._session() as session:
            numbers = session.scalars(wanted.order_by(FrameRow.number)).all()
        if len(numbers) <= most:
            return list(numbers)
        return [numbers[round((k + 0.5) * len(numbers) / most - 0.5)] for k in range(most)]

    def failed(self, flight: FlightRow, reason: str | None) -> list[int]:
        """The numbers of the frames without a pose, rising; those of one reason, or all."""
        wanted = [FrameRow.flight == flight.key, FrameRow.status == "failed"]
        if reason is not None:
            wanted.append(FrameRow.reason == reason)
        with self._session() as session:
            numbers = select(FrameRow.number).where(*wanted).order_by(FrameRow.number)
            return list(session.scalars(numbers))

    def chunk_of(self, flight: FlightRow, number: int) -> ChunkRow:
        """The chunk that a frame belongs to, with its timestamps.

        Raises
        ------
        NotFoundError
            If the flight does not have that frame, or was not told to read it.
        """
        with self._session() as session:
            chunk = session.scalar(
                select(ChunkRow)
                .where(
                    ChunkRow.flight == flight.key,
                    ChunkRow.number > 0,
                    ChunkRow.first_frame <= number,
                )
                .order_by(ChunkRow.first_frame.desc())
                .limit(1)
                .options(undefer(ChunkRow.pts), undefer(ChunkRow.numbers))
            )
        if chunk is None or number not in numbers_of(flight, chunk):
            raise NotFoundError(f"this flight does not read frame {number}", code="no_such_frame")
        return chunk


def _first_from(flight: int, time_s: float) -> ColumnElement[int]:
    """The number of the first frame at or after a time; above all numbers where there is none."""
    found = (
        select(FrameRow.number)
        .where(FrameRow.flight == flight, FrameRow.time_s >= time_s)
        .order_by(FrameRow.time_s, FrameRow.number)
        .limit(1)
        .scalar_subquery()
    )
    return func.coalesce(found, 2**31 - 1)
