"""The timeline of a flight: outcomes and heights in columns of equally many frames."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import groupby
from typing import Any

from sqlalchemy import ColumnElement, case, func, literal_column, select
from sqlalchemy.orm import Session

from padstudio.flights.results.bins import add_up, grid_of, read_bins
from padstudio.store.database.flight_tables import FlightRow, FrameDetailRow, FrameRow

#: Outcomes of a column of the timeline, in the order of its lists: the layer of a pose, but
#: ``bearing`` where only range and bearing can be used.
OUTCOMES = ("red", "green", "blue", "outline", "failed", "bearing")
# What of a column's frames is the least or the most; names as of `FrameBinRow`.
_EXTREMES: dict[str, Callable[..., Any]] = {
    "first_frame": min,
    "last_frame": max,
    "time_s": min,
    "z_min_mm": min,
    "z_max_mm": max,
}
_CHANNELS = ("red", "green", "blue")


def timeline_of(
    session: Session, flight: FlightRow, columns: int, first: int | None, last: int | None
) -> dict[str, Any]:
    """As `padstudio.flights.results.charts.FigureRows.timeline` describes it."""
    ends = ends_of(session, flight.key)
    if ends is None:
        return {"first_frame": 0, "last_frame": 0, "frames_per_column": 1, "columns": []}
    start = ends[0] if first is None else first
    stop = max(start, ends[1] if last is None else last)
    width = -(-(stop - start + 1) // columns)
    grid = grid_of(flight.request)
    if width < grid.width:
        # Whole strides, lest every other column be empty.
        stride = int(flight.request.get("stride", 1))
        width = -(-width // stride) * stride
        found = _merged(_rows_by_column(session, flight.key, start, stop, width))
        _add_channels(session, flight.key, (start, stop, width), found)
    else:
        # Whole bins; a column that a bin begins in has all of it.
        start = grid.start_of(start)
        width = -(-(stop - start + 1) // columns)
        width = -(-width // grid.width) * grid.width
        found = list(_from_bins(read_bins(session, flight, start, stop), start, width))
    return {
        "first_frame": start,
        "last_frame": stop,
        "frames_per_column": width,
        "columns": found,
    }


def _add_channels(
    session: Session, flight: int, part: tuple[int, int, int], columns: list[dict[str, Any]]
) -> None:
    """Say of each column at which stage each channel failed, in frames."""
    start, stop, width = part
    column = ((FrameRow.number - start) // width).label("column")
    stages = [FrameDetailRow.body["failed_at"][name].as_string() for name in _CHANNELS]
    found = session.execute(
        select(column, *stages, func.count())
        .join(
            FrameDetailRow,
            (FrameDetailRow.flight == FrameRow.flight) & (FrameDetailRow.number == FrameRow.number),
        )
        .where(
            FrameRow.flight == flight,
            FrameRow.status == "failed",
            FrameRow.number.between(start, stop),
        )
        .group_by(column, *stages)
    )
    by_column = {entry["column"]: entry["failed_at"] for entry in columns}
    for place, *named, count in found:
        for name, stage in zip(_CHANNELS, named, strict=True):
            if stage is not None:
                counts = by_column[int(place)].setdefault(name, {})
                counts[stage] = counts.get(stage, 0) + count


def _rows_by_column(
    session: Session, flight: int, start: int, stop: int, width: int
) -> Sequence[Any]:
    """As `_merged` takes, from the frames themselves."""
    column = ((FrameRow.number - start) // width).label("column")
    return session.execute(
        select(
            column,
            _outcome(),
            FrameRow.stage,
            func.count(),
            func.min(FrameRow.number),
            func.max(FrameRow.number),
            func.min(FrameRow.time_s),
            func.min(FrameRow.z_mm),
            func.max(FrameRow.z_mm),
        )
        .where(FrameRow.flight == flight, FrameRow.number.between(start, stop))
        .group_by(column, _outcome(), FrameRow.stage)
        .order_by(column)
    ).all()


def _outcome() -> ColumnElement[str | None]:
    # No parameter, as databases tell what is grouped by only where it stands there word by word.
    bearing: ColumnElement[str] = literal_column("'bearing'")
    return case((FrameRow.quality == bearing, bearing), else_=FrameRow.layer)


def _from_bins(bins: Iterable[Any], start: int, width: int) -> Iterator[dict[str, Any]]:
    """The columns of bins, which are in order."""
    for column, rows in groupby(bins, key=lambda row: (row.first_frame - start) // width):
        part = list(rows)
        stages: dict[str, int] = {}
        layers: dict[str, int] = {}
        bearings: dict[str, int] = {}
        for row in part:
            add_up(stages, row.body["stages"])
            add_up(layers, row.body["layers"])
            add_up(bearings, row.body["bearings"])
        entry = _column(column, stages)
        for layer, count in layers.items():
            entry["outcomes"][_place(layer)] += count - bearings.get(layer, 0)
        entry["outcomes"][_place("bearing")] += sum(bearings.values())
        entry["outcomes"][_place(None)] += sum(stages.values())
        for name, best in _EXTREMES.items():
            known = [value for row in part if (value := getattr(row, name)) is not None]
            entry[name] = best(known, default=None)
        yield entry


def ends_of(session: Session, flight: int) -> tuple[int, int] | None:
    """The first and the last frame of a flight that have a result, None where none has."""
    # Each alone is looked up in the index; both in one question are sought among all frames.
    first, last = (
        session.scalar(select(end(FrameRow.number)).where(FrameRow.flight == flight))
        for end in (func.min, func.max)
    )
    return None if first is None or last is None else (first, last)


def _merged(rows: Iterable[Any]) -> list[dict[str, Any]]:
    """One entry a column from one row a column, outcome and stage."""
    merged: dict[int, dict[str, Any]] = {}
    for column, outcome, stage, count, *values in rows:
        entry = merged.setdefault(int(column), _column(int(column), {}))
        entry["outcomes"][_place(outcome)] += count
        if stage is not None:
            entry["stages"][stage] = entry["stages"].get(stage, 0) + count
        for (name, best), value in zip(_EXTREMES.items(), values, strict=True):
            if value is not None:
                held = entry[name]
                entry[name] = value if held is None else best(held, value)
    return list(merged.values())


def _column(column: int, stages: dict[str, int]) -> dict[str, Any]:
    return {
        "column": column,
        **dict.fromkeys(_EXTREMES),
        "outcomes": [0] * len(OUTCOMES),
        "stages": stages,
        "failed_at": {},
    }


def _place(outcome: str | None) -> int:
    """Where frames of an outcome, which None and names from elsewhere are not, are counted."""
    return OUTCOMES.index(outcome if outcome in OUTCOMES else "failed")
