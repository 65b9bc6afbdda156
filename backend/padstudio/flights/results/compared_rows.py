"""Two runs of a database, compared."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from sqlalchemy import ColumnElement, and_, or_, select
from sqlalchemy.orm import Session, aliased, sessionmaker

from padstudio.errors import ConflictError
from padstudio.flights.results.answer_cache import KeptAnswers
from padstudio.flights.results.comparing import (
    Changes,
    RunColumns,
    compare_runs,
    kind_of,
    moved_between,
)
from padstudio.flights.results.rows import record_of, select_rows
from padstudio.store.database.flight_tables import FlightRow, FrameRow


@dataclass(frozen=True, kw_only=True)
class ChangeFilter:
    """Which frames of two runs.

    Attributes
    ----------
    kind : {"changed", "won", "lost", "moved", "both", "neither"} or None
        ``moved``: read by both, `least_mm` apart or more; ``changed``: won, lost or moved.
    least_mm : float
    """

    kind: str | None = None
    least_mm: float = 1.0


class Comparisons:
    """Compares the runs of a database; the last answers are kept.

    Parameters
    ----------
    session : sessionmaker
    """

    def __init__(self, session: sessionmaker[Session]) -> None:
        self._session = session
        self._kept = KeptAnswers()

    def summary(self, own: FlightRow, other: FlightRow, columns: int) -> dict[str, Any]:
        """What `own` does otherwise than `other`: `Changes.summary` and ``columns``.

        Raises
        ------
        ConflictError
            If they are not of the same files.
        """
        check_same(own, other)

        def find_out() -> dict[str, Any]:
            with self._session() as session:
                first, second = (_columns(session, flight) for flight in (other, own))
            changes: Changes = compare_runs(first, second)
            return changes.summary() | {"columns": changes.columns(columns)}

        return self._kept.of(own, f"{other.id} {other.frames_done} {columns}", find_out)

    def page(
        self,
        own: FlightRow,
        other: FlightRow,
        wanted: ChangeFilter,
        limit: int,
        after: int | None = None,
        before: int | None = None,
    ) -> list[dict[str, Any]]:
        """Frames that both runs read, in the order of their numbers, as `Results.page`.

        Returns
        -------
        list of dict
            ``frame``, ``kind``, ``moved_mm``, ``moved_share``, ``turned_deg``, and the records
            ``own`` and ``other``.

        Raises
        ------
        ConflictError
            If they are not of the same files.
        """
        check_same(own, other)
        one, two = aliased(FrameRow), aliased(FrameRow)
        numbers = (
            select(one.number)
            .join(two, and_(two.flight == other.key, two.number == one.number))
            .where(one.flight == own.key, *_conditions(one, two, wanted))
        )
        if after is not None:
            numbers = numbers.where(one.number > after)
        if before is not None:
            numbers = numbers.where(one.number < before)
        backwards = before is not None and after is None
        order = one.number.desc() if backwards else one.number
        with self._session() as session:
            chosen = sorted(session.scalars(numbers.order_by(order).limit(limit)).all())
            mine, others = (
                [
                    record_of(frame, body)
                    for frame, body in session.execute(
                        select_rows(flight.key).where(FrameRow.number.in_(chosen))
                    )
                ]
                for flight in (own, other)
            )
        return [
            {
                "frame": record["frame"],
                "kind": kind_of(was, record),
                **moved_between(was, record),
                "own": record,
                "other": was,
            }
            for record, was in zip(mine, others, strict=True)
        ]


def check_same(own: FlightRow, other: FlightRow) -> None:
    """Refuse runs whose frames of the same number are not the same frame.

    Raises
    ------
    ConflictError
        Also where the files of one were not looked into yet.
    """
    if not own.sources or not other.sources:
        raise ConflictError(
            "the files of one of them were not looked into yet; ask again when it is running",
            code="not_started",
        )
    if _files(own) != _files(other):
        raise ConflictError(
            "these flights are not of the same files in the same order; compare runs of one "
            "flight, or order another run of it",
            code="other_files",
        )


def _files(flight: FlightRow) -> list[tuple[str, int]]:
    return [(source["name"], source["frames"]) for source in flight.sources]


def _columns(session: Session, flight: FlightRow) -> RunColumns:
    chosen = select(FrameRow.number, FrameRow.status, FrameRow.x_mm, FrameRow.y_mm, FrameRow.z_mm)
    rows = session.execute(
        chosen.where(FrameRow.flight == flight.key).order_by(FrameRow.number)
    ).all()
    numbers, statuses, x, y, z = zip(*rows, strict=True) if rows else ((), (), (), (), ())
    position = np.array([x, y, z], dtype=float).T.reshape(-1, 3)
    return RunColumns(np.array(numbers, dtype=np.int64), np.array(statuses) == "ok", position)


def _conditions(one: Any, two: Any, wanted: ChangeFilter) -> list[ColumnElement[bool]]:
    now, was = one.status == "ok", two.status == "ok"
    x, y, z = (getattr(one, name) - getattr(two, name) for name in ("x_mm", "y_mm", "z_mm"))
    kinds: dict[str, ColumnElement[bool]] = {
        "won": and_(now, ~was),
        "lost": and_(~now, was),
        "both": and_(now, was),
        "neither": and_(~now, ~was),
        "moved": and_(now, was, x * x + y * y + z * z >= wanted.least_mm**2),
    }
    kinds["changed"] = or_(kinds["won"], kinds["lost"], kinds["moved"])
    return [kinds[wanted.kind]] if wanted.kind else []
