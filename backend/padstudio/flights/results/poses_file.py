"""Reads poses files (docs/conventions.md, "Poses file")."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from padstudio.bounded_files import open_regular
from padstudio.errors import StudioError
from padstudio.flights.results.completed import completed

Record = dict[str, Any]

# Of the longest records, with all findings, some thousands.
_MOST_LINE_BYTES = 1 << 20
# Read at a time from a file's end.
_BLOCK_BYTES = 1 << 16
# Beyond what any of the numbers can be; NaN is not within either.
_MOST = 1e15
_NEAREST_MM = 1e-6
_BEGINNING = b'{"source": '
# What a field holds in whichever record it stands; others are handed on as they are.
_VECTORS = {
    "position_mm": 3,
    "quaternion_xyzw": 4,
    "euler_deg": 3,
    "bearing": 3,
    "position_sigma_mm": 3,
    "attitude_sigma_deg": 3,
    "covariance": 21,
    "frame_px": 2,
}
_NUMBERS = (
    *("time_s", "heading_deg", "tilt_deg", "range_mm", "range_sigma_mm", "bearing_sigma_deg"),
    *("log10_false_alarm", "reprojection_px", "ambiguity", "flatness_mm"),
)
_COUNTS = ("cells_read", "cells_wrong", "stamp_ns")
_TEXTS = ("layer", "pad_id", "stage", "reason", "detail", "advice", "topic", "run")
_WORDS = {"quality": ("full", "bearing"), "estimate": ("frame", "filtered", "smoothed")}
_OBJECTS = ("elapsed_ms", "failed_at", "single", "live")
_POSE = ("position_mm", "quaternion_xyzw", "rotation")


class PosesFormatError(StudioError):
    """A poses file is ill-formed; the message names the line."""

    code = "invalid_poses_file"
    status = 422


def read_poses(path: Path, *, may_be_cut: bool = False) -> Iterator[Record]:
    """Records of a poses file, as they are asked for, completed where an older program wrote them.

    Parameters
    ----------
    path : Path
    may_be_cut : bool
        Pass over a last line without its end.

    Raises
    ------
    PosesFormatError
        If a line is no record.
    OSError
        If it cannot be read, or is no regular file.
    """
    with open_regular(path) as file:
        for number, line in enumerate(iter(lambda: file.readline(_MOST_LINE_BYTES), b""), 1):
            if may_be_cut and not line.endswith(b"\n") and len(line) < _MOST_LINE_BYTES:
                return
            if line.strip():
                try:
                    yield completed(parse_record(line))
                except PosesFormatError as error:
                    raise PosesFormatError(
                        f"{path.name}, line {number}: {error.message}"
                    ) from error


def cut_unfinished_line(path: Path) -> None:
    """Cut away a last line without its end, as a writer that was killed leaves it.

    Raises
    ------
    PosesFormatError
        If what would be cut away is no beginning of a record; nothing is changed then.
    OSError
        If the file cannot be read or written.
    """
    with path.open("r+b") as file:
        keep = file.seek(0, os.SEEK_END)
        while keep > 0:
            start = max(0, keep - _BLOCK_BYTES)
            file.seek(start)
            found = file.read(keep - start).rfind(b"\n")
            if found >= 0:
                keep = start + found + 1
                break
            keep = start
        file.seek(keep)
        rest = file.read(len(_BEGINNING))
        if not _BEGINNING.startswith(rest):
            raise PosesFormatError(f"{path.name} does not end as a poses file does; name another")
        file.truncate(keep)


def parse_record(line: bytes) -> Record:
    """The record of one line.

    Raises
    ------
    PosesFormatError
        If it is none.
    """
    try:
        record = json.loads(line.decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:
        raise PosesFormatError("this is no JSON in UTF-8; give a poses file (*.jsonl)") from error
    if not isinstance(record, dict):
        raise PosesFormatError("this is no object; give a poses file (*.jsonl)")
    if not isinstance(record.get("source"), str) or not _is_count(record.get("frame")):
        raise PosesFormatError("a record needs a text source and a number frame")
    if b"\\u" in line and not _is_writable(record):
        raise PosesFormatError("it holds half a surrogate pair, which is no text")
    _check_fields(record)
    if record.get("status") == "ok":
        _check_pose(record)
    elif record.get("status") == "failed":
        if record.get("stage") is None or record.get("reason") is None:
            raise PosesFormatError("a failed record needs a stage and a reason")
    else:
        raise PosesFormatError("status must be ok or failed")
    return record


def _check_fields(record: Record) -> None:
    """Refuse fields that hold something else than they may; null is what is not known."""
    for key, value in record.items():
        wanted = None if value is None else _wanted(key, value)
        if wanted is not None:
            raise PosesFormatError(f"{key} must be {wanted}")


def _wanted(key: str, value: object) -> str | None:
    """What a field must hold, where it does not."""
    if key in _VECTORS:
        count = _VECTORS[key]
        return None if _are_numbers(value, count) else f"{count} numbers"
    if key in _NUMBERS:
        return None if _are_numbers([value]) else "a number or null"
    if key in _COUNTS:
        return None if _is_count(value) else "a whole number"
    if key in _TEXTS:
        return None if isinstance(value, str) else "a text"
    if key in _WORDS:
        return None if value in _WORDS[key] else " or ".join(_WORDS[key])
    if key in _OBJECTS:
        return None if isinstance(value, dict) else "an object"
    if key == "rotation":
        return None if _is_rotation(value) else "3 rows of 3 numbers"
    return None


def _is_rotation(value: object) -> bool:
    return (
        isinstance(value, list) and len(value) == 3 and all(_are_numbers(row, 3) for row in value)
    )


def _check_pose(record: Record) -> None:
    for key in _POSE:
        if record.get(key) is None:
            raise PosesFormatError(f"{key} must not be missing where a pose was found")
    if max(map(abs, record["position_mm"])) < _NEAREST_MM:
        raise PosesFormatError("position_mm must not be the pad's centre")
    if not 0.25 < sum(value * value for value in record["quaternion_xyzw"]) < 4:
        raise PosesFormatError("quaternion_xyzw must be of length 1")
    if not all(0.25 < sum(value * value for value in row) < 4 for row in record["rotation"]):
        raise PosesFormatError("the rows of rotation must be of length 1")


def _is_writable(record: Record) -> bool:
    try:
        json.dumps(record, ensure_ascii=False).encode()
    except UnicodeEncodeError:
        return False
    return True


def _are_numbers(values: object, count: int = 1) -> bool:
    if not isinstance(values, list) or len(values) != count:
        return False
    numbers = [v for v in values if isinstance(v, int | float) and not isinstance(v, bool)]
    return len(numbers) == count and all(abs(v) <= _MOST for v in numbers)


def _is_count(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value < 2**63
