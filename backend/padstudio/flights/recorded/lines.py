"""Reads the poses beside a recorded segment; they may be anybody's.

What follows from a pose and its covariance is worked out anew, so that a line cannot contradict
itself; what is left is checked, and what is not known is refused.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Collection, Mapping
from typing import Any

import numpy as np

from padstudio.arrays import Array
from padstudio.flights.recorded.session import RecordingFormatError, no_number, plain_text
from padstudio.geometry.pose import Pose, rotation_from_quaternion
from padstudio.live.recording.poses import DROPPED
from padstudio.media.remote import open_source
from padstudio.vision.stage.detection import (
    Uncertainty,
    pose_fields,
    uncertainty_fields,
)
from padstudio.vision.stage.trace import STAGES, Reason

Record = dict[str, Any]

#: A line of a poses file; more is no frame's.
MOST_LINE_BYTES = 100_000
_MOST_LINES = 2_000_000
_FARTHEST_MM, _LARGEST = 1e7, 1e15
_WORD, _MOST_WORDS = re.compile(r"^[a-z0-9_]{1,40}$"), 60
_UPPER = np.triu_indices(6)
_LAYERS = ("red", "green", "blue", "outline")
_REASONS = frozenset(map(str, Reason))
# What every line has, and what only those of frames with or without a pose have.
_IN_ALL = {"source", "frame", "time_s", "status", "elapsed_ms", "pts", "live"}
_MAY = {"frame_px", "damaged", "findings"}
_OK = {
    *("position_mm", "quaternion_xyzw", "layer", "cells_read", "cells_wrong", "log10_false_alarm"),
    *("reprojection_px", "ambiguity", "estimate"),
}
_OK_MAY = {
    *("covariance", "flatness_mm", "pad_id", "single"),
    # They follow from others.
    *("rotation", "heading_deg", "tilt_deg", "euler_deg", "range_mm", "bearing", "quality"),
    *("position_sigma_mm", "attitude_sigma_deg", "range_sigma_mm", "bearing_sigma_deg"),
}
_FAILED, _FAILED_MAY = {"stage", "reason", "detail", "advice"}, {"failed_at"}


def dropped_record() -> Record:
    """The record of a frame that has no line, beside where it is from."""
    detail = "the session kept no line of it: it ended, or broke off, before the frame was read"
    return {**DROPPED, "detail": detail, "live": {}}


def read_lines(
    url: str,
    pad_ids: Collection[str],
    *,
    is_whole: bool = True,
    wanted: Collection[int] | None = None,
) -> dict[int, Record]:
    """The records of a poses file by their frames' timestamps in the segment.

    Parameters
    ----------
    url : str
        Where it lies.
    pad_ids : collection of str
        Of the recording's pads.
    is_whole : bool
        Else the last line may be cut short.
    wanted : collection of int or None
        Other timestamps are passed over; None: all are read.

    Returns
    -------
    dict of int to dict
        As `padstudio.flights.tasks.frames.FramesTask.run` gives, but for source, number and time.

    Raises
    ------
    RecordingFormatError
        If a line is no frame's of such a recording; the message names it.
    StorageError
        If the file cannot be reached.
    """
    found: dict[int, Record] = {}
    with open_source(url, as_file=True) as file:
        assert not isinstance(file, str)
        number = 0
        while line := file.readline(MOST_LINE_BYTES):
            number += 1
            if not line.endswith(b"\n") and not is_whole and not file.read(1):
                break
            try:
                pts, record = _line(line, pad_ids, wanted)
                if pts in found:
                    raise ValueError("two lines of one frame")
            except (KeyError, TypeError, ValueError, OverflowError, RecursionError) as error:
                what = f"lacks {error}" if isinstance(error, KeyError) else str(error)
                raise RecordingFormatError(
                    f"line {number} of the poses: {what[:200]}; copy the recording again"
                ) from error
            if record is not None:
                found[pts] = record
            if number > _MOST_LINES:
                raise RecordingFormatError(f"the poses have more than {_MOST_LINES} lines")
    return found


def _line(
    line: bytes, pad_ids: Collection[str], wanted: Collection[int] | None
) -> tuple[int, Record | None]:
    record = json.loads(line, parse_constant=no_number)
    if not isinstance(record, dict):
        raise ValueError("this is no object")
    pts = _count(record["pts"], least=-(2**62))
    if wanted is not None and pts not in wanted:
        return pts, None
    is_ok = record["status"] == "ok"
    if not is_ok and record["status"] != "failed":
        raise ValueError("a status must be ok or failed")
    needed = _IN_ALL | (_OK if is_ok else _FAILED)
    known = needed | _MAY | (_OK_MAY if is_ok else _FAILED_MAY)
    if lacking := needed - record.keys():
        raise KeyError(min(lacking))
    if strange := record.keys() - known:
        raise ValueError(f"{min(strange)[:40]!r} is nothing that a recording has")
    cleaned: Record = {"status": record["status"]}
    cleaned |= _pose(record, pad_ids) if is_ok else _failure(record)
    if "frame_px" in record:
        cleaned["frame_px"] = [_count(each) for each in _list(record["frame_px"], 2)]
    if record.get("damaged", False) is not False:
        cleaned["damaged"] = True
    if "findings" in record:
        cleaned["findings"] = [
            _finding(each) for each in _list(record["findings"], 20, exact=False)
        ]
    cleaned["elapsed_ms"] = _words(record["elapsed_ms"], _figure)
    return pts, cleaned | {"live": _live(record["live"])}


def _pose(record: Mapping[str, Any], pad_ids: Collection[str]) -> Record:
    pose = _pose_of(record)
    covariance = None if record.get("covariance") is None else _covariance(record["covariance"])
    sigma = None if covariance is None else Uncertainty.of(pose, covariance)
    told: Record = {
        **pose_fields(pose),
        # To the last digit as it was sent.
        "quaternion_xyzw": record["quaternion_xyzw"],
        "layer": _one_of(record["layer"], _LAYERS),
        "cells_read": _count(record["cells_read"]),
        "cells_wrong": _count(record["cells_wrong"]),
        "estimate": _one_of(record["estimate"], ("frame", "filtered", "smoothed")),
        **{
            name: _figure(record[name])
            for name in ("log10_false_alarm", "reprojection_px", "ambiguity")
        },
        "flatness_mm": _maybe(record.get("flatness_mm"), _figure),
        **uncertainty_fields(sigma),
        "quality": None if sigma is None else sigma.quality_at(pose.range_mm),
    }
    if covariance is not None:
        told["covariance"] = covariance[_UPPER].tolist()
    if record.get("pad_id") is not None:
        if record["pad_id"] not in pad_ids:
            raise ValueError("a pose of a pad that the recording does not have")
        told["pad_id"] = record["pad_id"]
    if record.get("single") is not None:
        told["single"] = _single(record["single"])
    return told


def _single(values: Mapping[str, Any]) -> Record:
    """A frame's own pose."""
    pose, covariance = _pose_of(values), _covariance(values["covariance"])
    sigma = Uncertainty.of(pose, covariance)
    if not isinstance(values["is_outlier"], bool):
        raise ValueError("is_outlier must be true or false")
    return {
        "position_mm": pose.position_mm.tolist(),
        "quaternion_xyzw": values["quaternion_xyzw"],
        "position_sigma_mm": sigma.position_sigma_mm.tolist(),
        "attitude_sigma_deg": sigma.attitude_sigma_deg.tolist(),
        "quality": sigma.quality_at(pose.range_mm),
        "covariance": covariance[_UPPER].tolist(),
        "is_outlier": values["is_outlier"],
    }


def _pose_of(values: Mapping[str, Any]) -> Pose:
    position = [_figure(each, _FARTHEST_MM) for each in _list(values["position_mm"], 3)]
    quaternion = [_figure(each, 2.0) for each in _list(values["quaternion_xyzw"], 4)]
    if abs(math.hypot(*quaternion) - 1) > 1e-6:
        raise ValueError("quaternion_xyzw is no rotation")
    if not any(position):
        raise ValueError("position_mm must not be the pad's centre")
    return Pose(np.array(position), rotation_from_quaternion(quaternion))


def _covariance(values: Any) -> Array:
    """(6, 6) of an upper triangle by rows."""
    matrix = np.zeros((6, 6))
    matrix[_UPPER] = [_figure(each, _LARGEST) for each in _list(values, 21)]
    matrix += np.triu(matrix, 1).T
    eigenvalues = np.linalg.eigvalsh(matrix)
    # Rounding makes the least ones a little negative.
    if eigenvalues[0] < -1e-6 * max(eigenvalues[-1], 0.0) or not eigenvalues[-1] > 0:
        raise ValueError("covariance is of no deviations")
    return np.asarray(matrix)


def _failure(record: Mapping[str, Any]) -> Record:
    stage = _one_of(record["stage"], ("read", *STAGES))
    reason = plain_text(record["reason"], 40)
    if not (_WORD.match(reason) if stage == "read" else reason in _REASONS):
        raise ValueError(f"the reason {reason!r} is not known")
    told: Record = {
        "stage": stage,
        "reason": reason,
        "detail": plain_text(record["detail"], 2000),
        "advice": plain_text(record["advice"], 2000),
    }
    if "failed_at" in record:
        told["failed_at"] = _words(record["failed_at"], lambda value: _one_of(value, STAGES))
    return told


def _finding(value: Mapping[str, Any]) -> Record:
    return {
        "reason": _one_of(value["reason"], _REASONS),
        "detail": plain_text(value["detail"], 2000),
        "advice": plain_text(value["advice"], 2000),
    }


def _live(value: Any) -> Record:
    """When a frame came, and how long its pose took."""
    known = {"unix_s": _figure, "number": _count, "latency_ms": _figure}
    if not isinstance(value, dict) or value.keys() - known.keys():
        raise ValueError("what it says of the session is no such thing")
    return {name: known[name](each) for name, each in value.items()}


def _words(value: Any, taken: Callable[[Any], Any]) -> Record:
    if not isinstance(value, dict) or len(value) > _MOST_WORDS or not all(map(_WORD.match, value)):
        raise ValueError("stages or channels that are none")
    return {name: taken(each) for name, each in value.items()}


def _list(value: Any, count: int, *, exact: bool = True) -> list[Any]:
    if not isinstance(value, list) or (len(value) != count if exact else len(value) > count):
        raise ValueError(f"a list must have {count} entries")
    return value


def _figure(value: Any, most: float = _LARGEST) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"{str(value)[:40]!r} is no number")
    # Also false of what is no number.
    if not abs(value) <= most:
        raise ValueError(f"{value!r} is beyond {most:g}")
    return value


def _count(value: Any, least: int = 0) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value < 2**62:
        raise ValueError(f"{str(value)[:40]!r} is no whole number in range")
    return value


def _maybe(value: Any, taken: Callable[[Any], Any]) -> Any:
    return None if value is None else taken(value)


def _one_of(value: Any, known: Collection[str]) -> str:
    if not isinstance(value, str) or value not in known:
        raise ValueError(f"{str(value)[:40]!r} is none of {', '.join(sorted(known))}")
    return value
