"""Reads what charts of a flight show, reduced in the database to as much as a chart can show."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
from sqlalchemy import select
from sqlalchemy.orm import Session, sessionmaker

from padstudio.flights.results.answer_cache import KeptAnswers
from padstudio.flights.results.height_fit import choose_samples, compare_heights
from padstudio.flights.results.rows import select_rows
from padstudio.flights.results.timeline import ends_of, timeline_of
from padstudio.geometry.pose import rotation_from_quaternion
from padstudio.media.telemetry.columns import ON_FLIGHT_CLOCK, height_at
from padstudio.store.database.flight_tables import FlightRow, FrameDetailRow, FrameRow
from padstudio.vision.stage.trace import STAGES


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
            `padstudio.flights.results.timeline.OUTCOMES`), ``stages`` (failing stage: frames),
            ``failed_at`` (the same by channel; empty in columns of a hundred frames or more).
            Columns without frames are left out.
        """

        def find_out() -> dict[str, Any]:
            with self._session() as session:
                return timeline_of(session, flight, columns, first, last)

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


def _trajectory(session: Session, flight: FlightRow, points: int) -> dict[str, list[Any]]:
    names = ("frame", "time_s", "x_mm", "y_mm", "z_mm", "quality")
    ends = ends_of(session, flight.key)
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
    ends = ends_of(session, flight.key)
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
