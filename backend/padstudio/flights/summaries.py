"""Figures over all frames of a flight: shares, gaps, counts, and what charts draw."""

from __future__ import annotations

from typing import Any

from sqlalchemy import case, func, select
from sqlalchemy.orm import Session, sessionmaker

from padstudio.flights.flight_tables import FlightRow, FrameRow
from padstudio.flights.kept_answers import KeptAnswers


class Summaries:
    """The figures of a database's flights; the last ones are kept.

    Parameters
    ----------
    session : sessionmaker
    """

    def __init__(self, session: sessionmaker[Session]) -> None:
        self._session = session
        self._kept = KeptAnswers()

    def of(self, flight: FlightRow, points: int = 2000) -> dict[str, Any]:
        """Figures over all frames that have a result, JSON-serialisable.

        Parameters
        ----------
        flight : FlightRow
        points : int
            Most points of the series of heights.

        Returns
        -------
        dict
            ``frames``, ``ok``, ``share_ok``; ``longest_gap`` (first and last frame, frames without
            a pose, seconds between the poses around them); ``stages``, ``reasons`` and ``layers``
            (counts, highest first); ``timeline`` (ok and failed frames of each second);
            ``heights`` (frame, time, height).
        """

        def find_out() -> dict[str, Any]:
            with self._session() as session:
                return _summary(session, flight, points)

        return self._kept.of(flight, points, find_out)


def _summary(session: Session, flight: FlightRow, points: int) -> dict[str, Any]:
    frames, ok = session.execute(
        select(
            func.count(), func.coalesce(func.sum(case((FrameRow.status == "ok", 1), else_=0)), 0)
        ).where(FrameRow.flight == flight.key)
    ).one()
    return {
        "frames": int(frames),
        "ok": int(ok),
        "share_ok": ok / frames if frames else None,
        "longest_gap": _longest_gap(session, flight),
        "stages": _counts(session, flight.key, FrameRow.stage),
        "reasons": _counts(session, flight.key, FrameRow.reason),
        "layers": _counts(session, flight.key, FrameRow.layer),
        "timeline": _timeline(session, flight.key),
        "heights": _heights(session, flight.key, max(1, -(-int(ok) // points))),
    }


def _counts(session: Session, flight: int, column: Any) -> dict[str, int]:
    found = session.execute(
        select(column, func.count())
        .where(FrameRow.flight == flight, column.is_not(None))
        .group_by(column)
        .order_by(func.count().desc(), column)
    )
    return {name: int(count) for name, count in found}


def _longest_gap(session: Session, flight: FlightRow) -> dict[str, Any] | None:
    """The longest run of frames without a pose, and the seconds between the poses around it."""
    mine, stride = FrameRow.flight == flight.key, flight.request["stride"]
    ends = session.execute(
        select(func.min(FrameRow.number), func.max(FrameRow.number)).where(mine)
    ).one()
    if ends[0] is None:
        return None
    posed = mine, FrameRow.status == "ok"
    before = func.lag(FrameRow.number).over(order_by=FrameRow.number).label("before")
    steps = select(FrameRow.number.label("after"), before).where(*posed).subquery()
    size = steps.c.after - steps.c.before
    inner = session.execute(
        select(steps.c.before, steps.c.after)
        .where(steps.c.before.is_not(None))
        .order_by(size.desc(), steps.c.after)
        .limit(1)
    ).first()
    outer = session.execute(
        select(func.min(FrameRow.number), func.max(FrameRow.number)).where(*posed)
    ).one()
    # Poses thought of just before the first frame and just after the last one.
    edges = (ends[0] - stride, ends[1] + stride)
    gaps = [edges] if outer[0] is None else [(edges[0], outer[0]), (outer[1], edges[1])]
    if inner is not None:
        gaps.append((inner.before, inner.after))
    start, end = max(gaps, key=lambda gap: gap[1] - gap[0])
    frames = (end - start) // stride - 1
    if frames < 1:
        return None
    return {
        "first_frame": start + stride,
        "last_frame": end - stride,
        "frames": frames,
        "seconds": _seconds_between(session, flight.key, max(start, ends[0]), min(end, ends[1])),
    }


def _seconds_between(session: Session, flight: int, start: int, end: int) -> float | None:
    found = session.execute(
        select(FrameRow.number, FrameRow.time_s).where(
            FrameRow.flight == flight, FrameRow.number.in_((start, end))
        )
    )
    times = {row.number: row.time_s for row in found}
    first, last = times.get(start), times.get(end)
    return None if first is None or last is None else last - first


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
