"""A run's fused pose: the frames' own poses that it follows from, and the pose fused again.

A run fuses poses over time (`padstudio.flights.results.fused_rows`); what it says of a frame
follows from its own pose and those within some seconds of it, which are little data.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from padstudio.flights.results.frames import FrameFilter, Results
from padstudio.flights.results.fused_rows import REACH_S, fusion_of
from padstudio.flights.results.fusing import fused_records, single_record
from padstudio.store.database.flight_tables import FlightRow

Record = dict[str, Any]
#: More than a run has within reach, at any rate that cameras have.
MOST_RECORDS = 4_000
# What a pose is fused by.
_OF_A_POSE = ("position_mm", "quaternion_xyzw", "covariance", "pad_id")
_IN_ALL = ("source", "frame", "time_s", "status")
_LENGTHS = {"position_mm": 3, "quaternion_xyzw": 4, "covariance": 21}
_FARTHEST = 1e12


@dataclass(frozen=True)
class Around:
    """Frames' own poses in the order of time, the bundle's frame among them.

    Attributes
    ----------
    fusion : {"filter", "smooth"}
    frame : int
        The bundle's.
    records : tuple of dict
        ``source``, ``frame``, ``time_s``, ``status``; of poses also ``position_mm``,
        ``quaternion_xyzw``, ``covariance`` (upper triangle by rows) and ``pad_id``.
    """

    fusion: Literal["filter", "smooth"]
    frame: int
    records: tuple[Record, ...]

    def to_dict(self) -> Record:
        """JSON-serialisable."""
        return {"fusion": self.fusion, "frame": self.frame, "frames": list(self.records)}

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> Around:
        """From what `to_dict` gives.

        Raises
        ------
        ValueError, KeyError, TypeError
            If it is of another shape.
        """
        fusion, frame, records = values["fusion"], values["frame"], values["frames"]
        if fusion not in ("filter", "smooth") or type(frame) is not int:
            raise ValueError("a fusion that is none")
        if len(records) > MOST_RECORDS:
            raise ValueError(f"more than {MOST_RECORDS} frames around")
        for record in records:
            _check(record)
        if [record["frame"] for record in records].count(frame) != 1:
            raise ValueError("the frame is not among those around it")
        return cls(fusion, frame, tuple(records))


def around(flight: FlightRow, results: Results, recorded: Mapping[str, Any]) -> Around | None:
    """What a frame's fused pose follows from; None where the run fuses none.

    Parameters
    ----------
    flight : FlightRow
    results : Results
    recorded : mapping
        The frame's record.
    """
    fusion, time_s = fusion_of(flight.request), recorded["time_s"]
    if fusion == "none" or time_s is None:
        return None
    behind_s = REACH_S if fusion == "smooth" else 0.0
    # The end is not within.
    near = FrameFilter(from_s=time_s - REACH_S, to_s=math.nextafter(time_s + behind_s, math.inf))
    records = results.page(flight, near, MOST_RECORDS)
    return Around(fusion, recorded["frame"], tuple(map(_lean, records)))


def fused_again(around: Around, own: Record) -> Record:
    """The frame's record with its fused pose.

    Parameters
    ----------
    around : Around
    own : dict
        The frame's own, as it is now, with ``covariance``.

    Raises
    ------
    ValueError, ArithmeticError
        If no poses can be so.
    """
    place = next(record for record in around.records if record["frame"] == around.frame)
    named = {name: place[name] for name in ("source", "frame", "time_s")}
    records: Sequence[Record] = [
        own | named if record is place else dict(record) for record in around.records
    ]
    fused = fused_records(records, around.fusion)
    return next(record for record in fused if record["frame"] == around.frame)


def _lean(record: Record) -> Record:
    own = single_record(record)
    names = (*_IN_ALL, *_OF_A_POSE) if own["status"] == "ok" else _IN_ALL
    return {name: own[name] for name in names if name in own}


def _check(record: Mapping[str, Any]) -> None:
    time_s = record["time_s"]
    if not isinstance(record["source"], str) or type(record["frame"]) is not int:
        raise ValueError("a frame around that is none")
    if record["status"] not in ("ok", "failed") or not (time_s is None or _is_figure(time_s)):
        raise ValueError("a frame around without a time or a status")
    if not isinstance(record.get("pad_id"), str | None):
        raise ValueError("a pad's identity that is no text")
    if record["status"] == "ok":
        for name, length in _LENGTHS.items():
            values: Any = record.get(name)
            if name == "covariance" and values is None:
                continue
            if len(values) != length or not all(map(_is_figure, values)):
                raise ValueError(f"{name} of a frame around that is none")
        if not 0.5 < math.hypot(*record["quaternion_xyzw"]) < 2:
            raise ValueError("a rotation that is none")


def _is_figure(value: Any) -> bool:
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return is_number and abs(value) < _FARTHEST
