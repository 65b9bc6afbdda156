"""A table of the vehicle's poses on the clock of the flight, as CSV."""

from __future__ import annotations

import csv
from collections.abc import Iterable

import numpy as np

from padstudio.arrays import Array
from padstudio.errors import SpecError
from padstudio.media.telemetry.vehicle_log import Series, VehicleLog

COLUMNS = ("time_s", "north_m", "east_m", "down_m", "qw", "qx", "qy", "qz")
# Less is no quaternion of a rotation, however it was rounded.
_LEAST_NORM = 0.5


def read_rows(lines: Iterable[str]) -> Array:
    """(N, 8) rows of a table whose header names `COLUMNS`, in any order.

    Raises
    ------
    SpecError
        If a column is missing or stands twice or a cell is no number, naming it.
    """
    reader = csv.DictReader(line for line in lines if not line.startswith("#"))
    header = list(reader.fieldnames or ())
    twice = next((name for name in COLUMNS if header.count(name) > 1), None)
    if twice is not None:
        raise SpecError(
            f"the vehicle's track has the column {twice} twice; leave one",
            code="invalid_vehicle_track",
        )
    missing = [name for name in COLUMNS if name not in header]
    if missing:
        raise SpecError(
            f"the vehicle's track lacks the columns {', '.join(missing)}; its header must name "
            f"{','.join(COLUMNS)}",
            code="invalid_vehicle_track",
        )
    try:
        rows = np.array([[float(row[name]) for name in COLUMNS] for row in reader])
    except (TypeError, ValueError, csv.Error) as error:
        raise SpecError(
            f"line {reader.line_num} of the vehicle's track holds what is no number",
            code="invalid_vehicle_track",
        ) from error
    return rows.reshape(-1, len(COLUMNS))


def parse(data: bytes) -> VehicleLog:
    """Read a file.

    Raises
    ------
    SpecError
        As of `read_rows`; or if there are fewer than two poses, or they are not finite, their times
        do not rise, or a quaternion is none.
    """
    rows = read_rows(data.decode("utf-8-sig", "replace").splitlines())
    norms = np.linalg.norm(rows[:, 4:], axis=1, keepdims=True)
    if (
        len(rows) < 2
        or not np.isfinite(rows).all()
        or (np.diff(rows[:, 0]) <= 0).any()
        or (norms < _LEAST_NORM).any()
    ):
        raise SpecError(
            "the vehicle's track needs two poses or more, finite, with rising times and unit "
            "quaternions",
            code="invalid_vehicle_track",
        )
    rows[:, 4:] /= norms
    return VehicleLog(
        "csv",
        attitude=Series.of(rows[:, 0], rows[:, 4:]),
        local=Series.of(rows[:, 0], rows[:, 1:4]),
        height=Series.of(rows[:, 0], -rows[:, 3]),
    )
