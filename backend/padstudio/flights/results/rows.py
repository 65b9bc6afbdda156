"""Lines of a poses file as rows of the database, and back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from sqlalchemy import Select, insert, select
from sqlalchemy.orm import Session

from padstudio.flights.results.bins import bins_of
from padstudio.flights.results.completed import completed
from padstudio.geometry.pose import rotation_from_quaternion
from padstudio.store.database.flight_tables import FrameBinRow, FrameDetailRow, FrameRow

Record = dict[str, Any]

_IN_ROW = ("frame", "time_s", "status", "stage", "reason", "layer", "quality", "position_mm")
# Follows from the quaternion.
_LEFT_OUT = ("rotation",)


def rows_of(
    flight: int, chunk: int, records: Sequence[Record]
) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Rows of the tables ``frames`` and ``frame_details``.

    Parameters
    ----------
    flight, chunk : int
        Keys.
    records : sequence of dict
        As `padstudio.flights.tasks.frames.FramesTask.run` gives.
    """
    frames, details = [], []
    for record in records:
        x, y, z = record.get("position_mm") or (None, None, None)
        key = {"flight": flight, "number": record["frame"]}
        told = {name: record.get(name) for name in _IN_ROW if name not in ("frame", "position_mm")}
        frames.append(key | told | {"x_mm": x, "y_mm": y, "z_mm": z})
        body = {k: v for k, v in record.items() if k not in _IN_ROW and k not in _LEFT_OUT}
        details.append(key | {"chunk": chunk, "body": body})
    return frames, details


def insert_rows(
    session: Session,
    request: Mapping[str, Any],
    frames: Sequence[Mapping[str, Any]],
    details: Sequence[Mapping[str, Any]],
) -> None:
    """Store the rows of a run of frames, and what sums them up.

    Parameters
    ----------
    session : Session
        In a transaction.
    request : mapping
        The flight's.
    frames, details : sequence of mapping
        As `rows_of` gives, ascending by number; not empty.
    """
    session.execute(insert(FrameRow), frames)
    session.execute(insert(FrameDetailRow), details)
    damaged = {detail["number"] for detail in details if detail["body"].get("damaged")}
    session.execute(insert(FrameBinRow), list(bins_of(frames, request, damaged)))


def select_rows(flight: int) -> Select[tuple[FrameRow, dict[str, Any]]]:
    """A flight's frames, each with the body of its `FrameDetailRow`, ascending by number."""
    return (
        select(FrameRow, FrameDetailRow.body)
        .join(
            FrameDetailRow,
            (FrameDetailRow.flight == FrameRow.flight) & (FrameDetailRow.number == FrameRow.number),
        )
        .where(FrameRow.flight == flight)
        .order_by(FrameRow.number)
    )


def record_of(frame: FrameRow, body: Mapping[str, Any]) -> Record:
    """A line of a poses file, with ``covariance`` (upper triangle by rows) where there is a pose.

    Parameters
    ----------
    frame : FrameRow
    body : mapping
        Of its `FrameDetailRow`.
    """
    record: Record = {
        "source": body.get("source", ""),
        "frame": frame.number,
        "time_s": frame.time_s,
        "status": frame.status,
    }
    if frame.status == "ok":
        record |= {
            "position_mm": [frame.x_mm, frame.y_mm, frame.z_mm],
            "rotation": rotation_from_quaternion(body["quaternion_xyzw"]).tolist(),
            "layer": frame.layer,
        }
        # Rows of an older program may be without, and then it follows from the rest.
        record |= {"quality": frame.quality} if frame.quality else {}
    else:
        record |= {"stage": frame.stage, "reason": frame.reason}
    return completed(record | {key: value for key, value in body.items() if key != "source"})
