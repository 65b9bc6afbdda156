"""A table of the vehicle's poses on the clock of the flight, as CSV."""

from __future__ import annotations

import csv
from collections.abc import Iterable

import numpy as np

from padstudio.arrays import Array
from padstudio.errors import SpecError
from padstudio.media.telemetry.vehicle_log import Series, VehicleLog

COLUMNS = ("time_s", "north_m", "east_m", "down_m", "qw", "qx", "qy", "qz")


def read_rows(lines: Iterable[str]) -> Array:
    """(N, 8) rows of a table whose header names `COLUMNS`, in any order.

    Raises
    ------
    SpecError
        If a column is missing or a cell is no number, naming it.
    """
    reader = csv.DictReader(line for line in lines if not line.startswith("#"))
    missing = [name for name in COLUMNS if name not in (reader.fieldnames or ())]
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
    """Read a file; raises as `read_rows`."""
    rows = read_rows(data.decode("utf-8-sig", "replace").splitlines())
    return VehicleLog(
        "csv",
        attitude=Series.of(rows[:, 0], rows[:, 4:]),
        local=Series.of(rows[:, 0], rows[:, 1:4]),
        height=Series.of(rows[:, 0], -rows[:, 3]),
    )
