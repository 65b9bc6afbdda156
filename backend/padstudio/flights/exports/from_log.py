"""The vehicle's track on the clock of a flight, from a log on a clock of its own."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from padstudio.autopilot.vehicle import VehicleTrack
from padstudio.errors import SpecError
from padstudio.flights.exports.frames.records import alike
from padstudio.flights.exports.options import Record
from padstudio.flights.vehicle.comparison import clock_of
from padstudio.flights.vehicle.ours import OurPoses

_COLUMNS = ("north_m", "east_m", "down_m", "qw", "qx", "qy", "qz")


def has_track(columns: Mapping[str, Any] | None) -> bool:
    """Whether telemetry holds both the vehicle's attitude and its local position."""
    return columns is not None and all(
        any(value is not None for value in columns.get(name) or ()) for name in _COLUMNS
    )


def track_of(columns: Mapping[str, Any], records: Iterable[Record]) -> VehicleTrack:
    """A log's poses of the vehicle, put on the clock of a flight by the motion that both saw.

    Parameters
    ----------
    columns : mapping
        As of `padstudio.media.telemetry.reading.read`.
    records : iterable of dict
        The flight's, of one pad.

    Raises
    ------
    SpecError
        If the log lacks attitude or local position, or the motion does not tell its clock.
    """
    if not has_track(columns):
        raise SpecError(
            "the log does not hold both the vehicle's attitude and its local position, which the "
            "export needs; log them, or send a CSV of the vehicle's poses",
            code="invalid_vehicle_track",
        )
    clock = clock_of(_ours(records), columns)
    if clock.offset_s is None:
        raise SpecError(
            f"the clock of the vehicle's log cannot be matched: {clock.reason}; send a CSV of its "
            "poses on the flight's clock",
            code="clock_not_matched",
        )
    table = np.array([columns[name] for name in ("time_s", *_COLUMNS)], float).T
    table = table[np.isfinite(table).all(axis=1)]
    return VehicleTrack(table[:, 0] - clock.offset_s, table[:, 1:4], table[:, 4:])


def _ours(records: Iterable[Record]) -> OurPoses:
    """The poses of records that have times, without those of quality ``bearing``."""
    kept = [
        (each["frame"], each["time_s"], each["position_mm"][2], each["quaternion_xyzw"])
        for each in alike(records)
        if each["status"] == "ok"
        and each.get("quality") != "bearing"
        and each.get("time_s") is not None
    ]
    turns = np.array([each[3] for each in kept], float).reshape(-1, 4)
    return OurPoses(
        np.array([each[0] for each in kept], np.int64),
        np.array([each[1] for each in kept], float),
        np.array([each[2] for each in kept], float) / 1000,
        turns[:, [3, 0, 1, 2]],
    )
