"""Reads what charts of a flight show, reduced in the database to as much as a chart can show."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
from sqlalchemy import ColumnElement, case, func, literal_column, select
from sqlalchemy.orm import Session, sessionmaker

from padstudio.flights.results.answer_cache import KeptAnswers
from padstudio.flights.results.bins import grid_of, read_bins
from padstudio.flights.results.height_fit import choose_samples, compare_heights
from padstudio.flights.results.rows import select_rows
from padstudio.geometry.pose import rotation_from_quaternion
from padstudio.media.telemetry.columns import ON_FLIGHT_CLOCK, height_at
from padstudio.store.database.flight_tables import FlightRow, FrameDetailRow, FrameRow
from padstudio.vision.stage.trace import STAGES

#: Outcomes of a column of the timeline, in the order of its lists: the layer of a pose, but
#: ``bearing`` where only range and bearing can be used.
OUTCOMES = ("red", "green", "blue", "outline", "failed", "bearing")
_CHANNELS = ("red", "green", "blue")


class FigureRows:
    """The frames of a database's flights, for charts; the last answers are kept.

    Parameters
    ----------
    session : sessionmaker
    """

    def __init__(self, session: sessionmaker[Session]) -> None:
        self._session = session
        self._kept = KeptAnswers()

    def timeline(
        self, flight: FlightRow, columns: int, first: int | None = None, last: int | None = None
    ) -> dict[str, Any]:
        """Outcomes and heights of a part of a flight, in columns of equally many frames.

        Parameters
        ----------
        flight : FlightRow
        columns : int
            Most columns.
        first, last : int or None
            Frame numbers, the last within; None: all that have a result.

        Returns
        -------
        dict
            ``first_frame``, ``last_frame``, ``frames_per_column`` (in frame numbers; where columns
            hold a hundred frames or more, they begin and end at hundreds), and
            ``columns``: each ``column``, ``first_frame``, ``last_frame``, ``time_s``,
            ``z_min_mm``, ``z_max_mm`` (None without a pose), ``outcomes`` (frames, as
            `OUTCOMES`), ``stages`` (failing stage: frames), ``failed_at`` (the same by channel;
            empty in columns of a hundred frames or more). Columns without frames are left out.
        """

        def find_out() -> dict[str, Any]:
            with self._session() as session:
                return _timeline(session, flight, columns, first, last)

        return self._kept.of(flight, ("timeline", columns, first, last), find_out)

    def figures(self, flight: FlightRow, points: int = 2000, samples: int = 24) -> dict[str, Any]:
        """What the charts of a flight show, JSON-serialisable.

        Parameters
        ----------
        flight : FlightRow
            Loaded with its telemetry.
        points : int
            Most points of the trajectory.
        samples : int
            Poses to show in space.

        Returns
        -------
        dict
            ``trajectory``: columns ``frame``, ``time_s``, ``x_mm``, ``y_mm``, ``z_mm``,
            ``quality``, ``heading_deg``, ``tilt_deg``, ``position_sigma_mm`` and
            ``attitude_sigma_deg`` (of the three the largest), ``cells_read``, ``cells_wrong``, None
            where a frame has no pose; ``total_ms`` and the time of each stage, as ``edges_ms``.
            ``samples``: ``number`` (from 1), ``frame``, and where there is a pose its ``quality``,
            ``position_mm`` and ``axis``, the unit vector along which the camera looks.
            ``heights``, of poses that are not of quality ``bearing``: None without telemetry of
            heights, else ``telemetry_m``, ``pose_mm``, ``frame`` and ``fit`` (`HeightComparison`,
            or None).
        """

        def find_out() -> dict[str, Any]:
            with self._session() as session:
                trajectory = _trajectory(session, flight, points)
                chosen = _samples(session, flight, samples)
            heights = _heights(flight, trajectory)
            return {"trajectory": trajectory, "samples": chosen, "heights": heights}

        return self._kept.of(flight, ("figures", points, samples), find_out)


def _timeline(
    session: Session, flight: FlightRow, columns: int, first: int | None, last: int | None
) -> dict[str, Any]:
    ends = _ends(session, flight.key)
    if ends is None:
        return {"first_frame": 0, "last_frame": 0, "frames_per_column": 1, "columns": []}
    start = ends[0] if first is None else first
    stop = max(start, ends[1] if last is None else last)
    width = -(-(stop - start + 1) // columns)
    grid = grid_of(flight.request)
    rows: Iterable[Any]
    if width < grid.width:
        # Whole strides, lest every other column be empty.
        stride = int(flight.request.get("stride", 1))
        width = -(-width // stride) * stride
        rows = _rows_by_column(session, flight.key, start, stop, width)
    else:
        # Whole bins; a column that a bin begins in has all of it.
        start = grid.start_of(start)
        width = -(-(stop - start + 1) // columns)
        width = -(-width // grid.width) * grid.width
        rows = _bins_by_column(read_bins(session, flight, start, stop), start, width)
        return _answer(start, stop, width, _merged(rows))
    columns_ = _merged(rows)
    _add_channels(session, flight.key, (start, stop, width), columns_)
    return _answer(start, stop, width, columns_)


def _answer(start: int, stop: int, width: int, columns: list[dict[str, Any]]) -> dict[str, Any]:
    return {
        "first_frame": start,
        "last_frame": stop,
        "frames_per_column": width,
        "columns": columns,
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


def _bins_by_column(bins: Iterable[Any], start: int, width: int) -> Iterator[tuple[Any, ...]]:
    """As `_merged` takes, from bins: an entry for each outcome and for each failing stage."""
    for row in bins:
        column = (row.first_frame - start) // width
        about = row.first_frame, row.last_frame, row.time_s, row.z_min_mm, row.z_max_mm
        bearings = row.body["bearings"]
        for layer, count in row.body["layers"].items():
            yield column, layer, None, count - bearings.get(layer, 0), *about
        yield column, "bearing", None, sum(bearings.values()), *about
        for stage, count in row.body["stages"].items():
            yield column, None, stage, count, *about


def _ends(session: Session, flight: int) -> tuple[int, int] | None:
    """The first and the last frame that have a result."""
    # Each alone is looked up in the index; both in one question are sought among all frames.
    first, last = (
        session.scalar(select(end(FrameRow.number)).where(FrameRow.flight == flight))
        for end in (func.min, func.max)
    )
    return None if first is None or last is None else (first, last)


def _merged(rows: Iterable[Any]) -> list[dict[str, Any]]:
    """One entry a column from one row a column, outcome and stage."""
    merged: dict[int, dict[str, Any]] = {}
    for column, outcome, stage, count, first, last, time_s, z_min, z_max in rows:
        entry = merged.setdefault(
            int(column),
            {
                "column": int(column),
                "first_frame": first,
                "last_frame": last,
                "time_s": time_s,
                "z_min_mm": None,
                "z_max_mm": None,
                "outcomes": [0] * len(OUTCOMES),
                "stages": {},
                "failed_at": {},
            },
        )
        entry["outcomes"][OUTCOMES.index(outcome if outcome in OUTCOMES else "failed")] += count
        if stage is not None:
            entry["stages"][stage] = entry["stages"].get(stage, 0) + count
        for name, value, better in (
            ("first_frame", first, min),
            ("last_frame", last, max),
            ("time_s", time_s, min),
            ("z_min_mm", z_min, min),
            ("z_max_mm", z_max, max),
        ):
            if value is not None:
                held = entry[name]
                entry[name] = value if held is None else better(held, value)
    return list(merged.values())


def _trajectory(session: Session, flight: FlightRow, points: int) -> dict[str, list[Any]]:
    names = ("frame", "time_s", "x_mm", "y_mm", "z_mm", "quality")
    ends = _ends(session, flight.key)
    if ends is None:
        return {name: [] for name in names}
    stride = int(flight.request.get("stride", 1))
    every = stride * -(-((ends[1] - ends[0]) // stride + 1) // points)
    numbers = range(ends[0], ends[1] + 1, every)
    position = (FrameRow.x_mm, FrameRow.y_mm, FrameRow.z_mm)
    rows = session.execute(
        select(FrameRow.number, FrameRow.time_s, *position, FrameRow.quality, FrameDetailRow.body)
        .join(
            FrameDetailRow,
            (FrameDetailRow.flight == FrameRow.flight) & (FrameDetailRow.number == FrameRow.number),
        )
        .where(FrameRow.flight == flight.key, FrameRow.number.in_(numbers))
        .order_by(FrameRow.number)
    ).all()
    shown = [tuple(row) for row in rows]
    # Lines break where frames are not read yet.
    blank = (None,) * (len(names) - 1)
    for place in range(len(shown) - 1, 0, -1):
        if shown[place][0] != shown[place - 1][0] + every:
            shown.insert(place, (shown[place - 1][0] + every, *blank, {}))
    columns = {name: [row[place] for row in shown] for place, name in enumerate(names)}
    return columns | _details([row[-1] for row in shown])


def _details(bodies: Sequence[Mapping[str, Any]]) -> dict[str, list[Any]]:
    """Attitude, sigmas, cells and times of frames, None where a frame has none."""
    columns: dict[str, list[Any]] = {
        name: [body.get(name) for body in bodies]
        for name in ("heading_deg", "tilt_deg", "cells_read", "cells_wrong")
    }
    for name in ("position_sigma_mm", "attitude_sigma_deg"):
        # Of the three that is largest.
        columns[name] = [max(body[name]) if body.get(name) else None for body in bodies]
    times = [body.get("elapsed_ms", {}) for body in bodies]
    stages = [stage for stage in STAGES if any(stage in each for each in times)]
    for stage in ("total", *stages):
        columns[f"{stage}_ms"] = [each.get(stage) for each in times]
    return columns


def _samples(session: Session, flight: FlightRow, count: int) -> list[dict[str, Any]]:
    ends = _ends(session, flight.key)
    if ends is None:
        return []
    numbers = choose_samples(*ends, int(flight.request.get("stride", 1)), count)
    chosen = select_rows(flight.key).where(FrameRow.number.in_(numbers), FrameRow.status == "ok")
    found = {row.number: (row, body) for row, body in session.execute(chosen)}
    samples: list[dict[str, Any]] = []
    for place, number in enumerate(numbers, 1):
        sample: dict[str, Any] = {"number": place, "frame": number}
        if number in found:
            row, body = found[number]
            # The camera looks along its z axis.
            axis = rotation_from_quaternion(body["quaternion_xyzw"])[:, 2]
            position = [row.x_mm, row.y_mm, row.z_mm]
            sample |= {"quality": row.quality, "position_mm": position, "axis": axis.tolist()}
        samples.append(sample)
    return samples


def _heights(flight: FlightRow, trajectory: dict[str, list[Any]]) -> dict[str, Any] | None:
    if not flight.telemetry or flight.telemetry.get("kind", "srt") not in ON_FLIGHT_CLOCK:
        return None
    known = [place for place, z in enumerate(trajectory["z_mm"]) if z is not None]
    known = [place for place in known if trajectory["time_s"][place] is not None]
    known = [place for place in known if trajectory["quality"][place] != "bearing"]
    heights = height_at(flight.telemetry, [trajectory["time_s"][place] for place in known])
    pairs = [(place, m) for place, m in zip(known, heights, strict=True) if m is not None]
    if not pairs:
        return None
    places, telemetry_m = zip(*pairs, strict=True)
    pose_mm = [trajectory["z_mm"][place] for place in places]
    fit = compare_heights(np.array(telemetry_m), np.array(pose_mm))
    return {
        "frame": [trajectory["frame"][place] for place in places],
        "telemetry_m": list(telemetry_m),
        "pose_mm": pose_mm,
        "fit": asdict(fit) if fit else None,
    }
