"""MAVLink telemetry log (``.tlog``): packets, each after its time of receipt; by `pymavlink`.

References
----------
https://mavlink.io/en/guide/serialization.html
"""

from __future__ import annotations

import struct
from collections import defaultdict
from collections.abc import Iterator
from typing import Any

from padstudio.media.telemetry.columns import TelemetryError
from padstudio.media.telemetry.vehicle_log import Series, VehicleLog, columns_of, quaternion_wxyz

_V1, _V2 = 0xFE, 0xFD
_TIME_BYTES = 8
# Header and checksum; of MAVLink 2 also the signature, where a flag says so.
_AROUND = {_V1: 8, _V2: 12}
_SIGNED, _SIGNATURE_BYTES = 0x01, 13
#: The flight controller among a vehicle's components.
_AUTOPILOT = 1
_FIELDS = {
    "ATTITUDE": ("roll", "pitch", "yaw"),
    "ATTITUDE_QUATERNION": ("q1", "q2", "q3", "q4"),
    "LOCAL_POSITION_NED": ("x", "y", "z"),
    "GLOBAL_POSITION_INT": ("lat", "lon", "alt", "relative_alt"),
}
_UNITS = {"GLOBAL_POSITION_INT": (1e-7, 1e-7, 1e-3, 1e-3)}


def parse(data: bytes) -> VehicleLog:
    """Read the attitude, position and height that a flight controller sent.

    Times are the vehicle's own, since it was started.

    Raises
    ------
    TelemetryError
        If several vehicles are in it.
    """
    from pymavlink.dialects.v20 import common

    numbers = {getattr(common, f"MAVLINK_MSG_ID_{name}"): name for name in _FIELDS}
    link = common.MAVLink(None)
    rows: dict[int, dict[str, list[list[float]]]] = defaultdict(lambda: defaultdict(list))
    for packet, number in _packets(data):
        if number not in numbers:
            continue
        try:
            message = link.decode(bytearray(packet))
        except common.MAVError:
            # Damaged on its way.
            continue
        if message.get_srcComponent() == _AUTOPILOT:
            name = numbers[number]
            rows[message.get_srcSystem()][name].append(_values(message, name))
    if len(rows) > 1:
        listed = ", ".join(map(str, sorted(rows)))
        raise TelemetryError(f"the log holds the vehicles {listed}; send that of one alone")
    return _log(next(iter(rows.values()), {}))


def _values(message: Any, name: str) -> list[float]:
    units = _UNITS.get(name, (1.0,) * len(_FIELDS[name]))
    pairs = zip(_FIELDS[name], units, strict=True)
    return [message.time_boot_ms / 1e3, *(getattr(message, field) * unit for field, unit in pairs)]


def _packets(data: bytes) -> Iterator[tuple[bytes, int]]:
    """Packets and the numbers of their messages; what lies between is passed over."""
    place = _TIME_BYTES
    while place + 8 < len(data):
        start = data[place]
        if start not in _AROUND:
            place += 1
            continue
        size = _AROUND[start] + data[place + 1]
        if start == _V2 and data[place + 2] & _SIGNED:
            size += _SIGNATURE_BYTES
        if place + size > len(data):
            # The log ends within a packet, or this is none.
            place += 1
            continue
        follows = place + size + _TIME_BYTES
        if follows < len(data) and data[follows] not in _AROUND:
            place += 1
            continue
        number = data[place + 5]
        if start == _V2:
            (number,) = struct.unpack("<I", data[place + 7 : place + 10] + b"\0")
        yield data[place : place + size], number
        place = follows


def _log(rows: dict[str, list[list[float]]]) -> VehicleLog:
    tables = {
        name: columns_of(rows.get(name, ()), 1 + len(fields)) for name, fields in _FIELDS.items()
    }
    angles, turns = tables["ATTITUDE"], tables["ATTITUDE_QUATERNION"]
    local, place = tables["LOCAL_POSITION_NED"], tables["GLOBAL_POSITION_INT"]
    attitude = Series.of(angles[:, 0], quaternion_wxyz(*angles[:, 1:].T))
    heights = [Series.of(place[:, 0], place[:, 4]), Series.of(local[:, 0], -local[:, 3])]
    return VehicleLog(
        "tlog",
        attitude=Series.of(turns[:, 0], turns[:, 1:]) or attitude,
        local=Series.of(local[:, 0], local[:, 1:]),
        height=next((series for series in heights if series is not None), None),
        place=Series.of(place[:, 0], place[:, 1:4]),
    )
