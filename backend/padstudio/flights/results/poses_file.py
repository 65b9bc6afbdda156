"""Reads poses files (docs/conventions.md, "Poses file")."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from padstudio.errors import StudioError
from padstudio.flights.results.completed import completed

Record = dict[str, Any]

# Read at a time from a file's end.
_BLOCK_BYTES = 1 << 16
_BEGINNING = b'{"source": '
_SHAPES = {"position_mm": 3, "quaternion_xyzw": 4}
# Those that older files lack, or whose value is not known.
_OPTIONAL = {
    "bearing": 3,
    "position_sigma_mm": 3,
    "attitude_sigma_deg": 3,
    "covariance": 21,
    "range_mm": 1,
    "range_sigma_mm": 1,
    "bearing_sigma_deg": 1,
}


class PosesFormatError(StudioError):
    """A poses file is ill-formed; the message names the line."""

    code = "invalid_poses_file"
    status = 422


def read_poses(path: Path) -> Iterator[Record]:
    """Records of a poses file, as they are asked for, completed where an older program wrote them.

    Parameters
    ----------
    path : Path

    Raises
    ------
    PosesFormatError
        If a line is no record.
    OSError
        If the file cannot be read.
    """
    with path.open("rb") as file:
        for number, line in enumerate(file, 1):
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
        record = json.loads(line)
    except ValueError as error:
        raise PosesFormatError("this is no JSON; give a poses file (*.jsonl)") from error
    if not isinstance(record, dict):
        raise PosesFormatError("this is no object; give a poses file (*.jsonl)")
    if not isinstance(record.get("source"), str) or not _is_count(record.get("frame")):
        raise PosesFormatError("a record needs a text source and a number frame")
    time_s = record.get("time_s")
    if time_s is not None and not _are_numbers([time_s]):
        raise PosesFormatError("time_s must be a number or null")
    if record.get("status") == "ok":
        _check_pose(record)
    elif record.get("status") == "failed":
        if not all(isinstance(record.get(key), str) for key in ("stage", "reason")):
            raise PosesFormatError("a failed record needs a stage and a reason")
    else:
        raise PosesFormatError("status must be ok or failed")
    return record


def _check_pose(record: Record) -> None:
    for key, count in _SHAPES.items():
        if not _are_numbers(record.get(key), count):
            raise PosesFormatError(f"{key} must be {count} numbers")
    rotation = record.get("rotation")
    if not (
        isinstance(rotation, list)
        and len(rotation) == 3
        and all(_are_numbers(row, 3) for row in rotation)
    ):
        raise PosesFormatError("rotation must be 3 rows of 3 numbers")
    for key, count in _OPTIONAL.items():
        value = record.get(key)
        if value is not None and not _are_numbers([value] if count == 1 else value, count):
            wanted = "a number" if count == 1 else f"{count} numbers"
            raise PosesFormatError(f"{key} must be {wanted}")
    if record.get("quality") not in (None, "full", "bearing"):
        raise PosesFormatError("quality must be full or bearing")
    if not any(record["position_mm"]):
        raise PosesFormatError("position_mm must not be the pad's centre")


def _are_numbers(values: object, count: int = 1) -> bool:
    if not isinstance(values, list) or len(values) != count:
        return False
    numbers = [v for v in values if isinstance(v, int | float) and not isinstance(v, bool)]
    return len(numbers) == count and all(math.isfinite(v) for v in numbers)


def _is_count(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and value >= 0
