"""Writes small logs of vehicles: PX4's ULog, ArduPilot's DataFlash, MAVLink telemetry.

The bytes are built by the formats' descriptions, apart from what reads them.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import Any

import numpy as np

#: Where the local origin is: degrees, and metres over the sea.
LATITUDE, LONGITUDE, ALTITUDE_M = 47.1, 8.2, 400.0
_METRES_A_DEGREE = 111_319.5


@dataclass(frozen=True, eq=False)
class Flown:
    """A vehicle's flight: times (N,) s, roll, pitch, yaw (N, 3) rad, north, east, down (N, 3) m."""

    time_s: Any
    angles: Any
    local_m: Any

    @property
    def quaternions(self) -> Any:
        """(N, 4), scalar first, from the product of three turns."""
        half = self.angles / 2
        found = np.tile([1.0, 0, 0, 0], (len(self.time_s), 1))
        # Yaw first, then pitch, then roll.
        for axis in (2, 1, 0):
            turn = np.zeros((len(self.time_s), 4))
            turn[:, 0], turn[:, 1 + axis] = np.cos(half[:, axis]), np.sin(half[:, axis])
            found = _product(found, turn)
        return found

    @property
    def place(self) -> Any:
        """(N, 3) latitude, longitude, altitude."""
        north, east, down = self.local_m.T
        east_deg = east / _METRES_A_DEGREE / np.cos(np.radians(LATITUDE))
        return np.column_stack(
            [LATITUDE + north / _METRES_A_DEGREE, LONGITUDE + east_deg, ALTITUDE_M - down]
        )


def wandering(seconds: float = 20.0, hertz: float = 50.0, start_s: float = 100.0) -> Flown:
    """A flight that turns about all axes and climbs and sinks."""
    time_s = start_s + np.arange(round(seconds * hertz)) / hertz
    t = time_s - start_s
    angles = np.column_stack(
        [0.1 * np.sin(1.1 * t), 0.12 * np.sin(0.7 * t + 1), 0.4 * np.sin(0.31 * t) + 0.5]
    )
    local = np.column_stack([np.sin(0.4 * t), np.cos(0.3 * t), -3 + 1.5 * np.sin(0.5 * t)])
    return Flown(time_s, angles, local)


def ulog(flown: Flown) -> bytes:
    """PX4: vehicle_attitude, vehicle_local_position, vehicle_global_position."""
    topics = {
        "vehicle_attitude": ("uint64_t timestamp;float[4] q;", "<Q4f", flown.quaternions),
        "vehicle_local_position": (
            "uint64_t timestamp;float x;float y;float z;bool xy_valid;bool z_valid;",
            "<Q3f2B",
            np.column_stack([flown.local_m, np.ones((len(flown.time_s), 2))]),
        ),
        "vehicle_global_position": (
            "uint64_t timestamp;double lat;double lon;float alt;",
            "<Q2df",
            flown.place,
        ),
    }
    out = bytearray(b"ULog\x01\x12\x35\x01" + struct.pack("<Q", round(flown.time_s[0] * 1e6)))

    def message(kind: str, body: bytes) -> None:
        out.extend(struct.pack("<HB", len(body), ord(kind)) + body)

    message("B", bytes(40))
    for name, (fields, _, _) in topics.items():
        message("F", f"{name}:{fields}".encode())
    for number, name in enumerate(topics):
        message("A", struct.pack("<BH", 0, number) + name.encode())
    for k, time_s in enumerate(flown.time_s):
        for number, (_, layout, values) in enumerate(topics.values()):
            kinds = [bool if code == "B" else float for code in _codes(layout)]
            row = [kind(value) for kind, value in zip(kinds, values[k], strict=True)]
            body = struct.pack(layout, round(time_s * 1e6), *row)
            message("D", struct.pack("<H", number) + body)
    return bytes(out)


def _codes(layout: str) -> str:
    """The codes of a layout's fields behind the time, one a field."""
    return {"<Q4f": "ffff", "<Q3f2B": "fffBB", "<Q2df": "ddf"}[layout]


def dataflash(flown: Flown) -> bytes:
    """ArduPilot: ATT, POS, and XKF1 of two cores, of which the second is nonsense."""
    kinds = {
        "FMT": (128, "BBnNZ", "Type,Length,Name,Format,Columns", "<BB4s16s64s"),
        "ATT": (129, "Qccc", "TimeUS,Roll,Pitch,Yaw", "<Qhhh"),
        "POS": (130, "QLLff", "TimeUS,Lat,Lng,Alt,RelHomeAlt", "<Qiiff"),
        "XKF1": (131, "QBfff", "TimeUS,C,PN,PE,PD", "<QBfff"),
    }
    out = bytearray()

    def message(name: str, *values: Any) -> None:
        number, _, _, layout = kinds[name]
        out.extend(bytes([0xA3, 0x95, number]) + struct.pack(layout, *values))

    for name, (number, form, columns, layout) in kinds.items():
        size = 3 + struct.calcsize(layout)
        message("FMT", number, size, name.encode(), form.encode(), columns.encode())
    degrees = np.degrees(flown.angles)
    for k, time_s in enumerate(flown.time_s):
        time_us = round(time_s * 1e6)
        message("ATT", time_us, *(round(100 * angle) for angle in degrees[k]))
        latitude, longitude, altitude = flown.place[k]
        height = -flown.local_m[k, 2]
        message("POS", time_us, round(latitude * 1e7), round(longitude * 1e7), altitude, height)
        message("XKF1", time_us, 0, *flown.local_m[k])
        message("XKF1", time_us, 1, 999.0, 999.0, 999.0)
    return bytes(out)


def tlog(flown: Flown, *, systems: tuple[int, ...] = (1,), unix_s: float = 1.7e9) -> bytes:
    """MAVLink 2: ATTITUDE, LOCAL_POSITION_NED, GLOBAL_POSITION_INT, and a gimbal's ATTITUDE."""
    from pymavlink.dialects.v20 import common

    out = bytearray()
    for k, time_s in enumerate(flown.time_s):
        boot_ms, received_us = round(time_s * 1e3), round((unix_s + time_s) * 1e6)
        latitude, longitude, altitude = flown.place[k]
        height = -flown.local_m[k, 2]
        place = [round(latitude * 1e7), round(longitude * 1e7)]
        place += [round(altitude * 1e3), round(height * 1e3)]
        for system in systems:
            told = {
                1: [
                    common.MAVLink_attitude_message(boot_ms, *flown.angles[k], 0, 0, 0),
                    common.MAVLink_local_position_ned_message(boot_ms, *flown.local_m[k], 0, 0, 0),
                    common.MAVLink_global_position_int_message(boot_ms, *place, 0, 0, 0, 65535),
                ],
                154: [common.MAVLink_attitude_message(boot_ms, 1, 1, 1, 0, 0, 0)],
            }
            for component, messages in told.items():
                link = common.MAVLink(None, system, component)
                for message in messages:
                    out.extend(struct.pack(">Q", received_us) + message.pack(link))
    return bytes(out)


def table(flown: Flown) -> bytes:
    """The CSV of the vehicle's poses."""
    rows = np.column_stack([flown.time_s, flown.local_m, flown.quaternions])
    head = "time_s,north_m,east_m,down_m,qw,qx,qy,qz"
    lines = [",".join(f"{value:.9f}" for value in row) for row in rows]
    return "\n".join([head, *lines]).encode()


def _product(a: Any, b: Any) -> Any:
    """Of quaternions (N, 4), scalar first."""
    w = a[:, 0] * b[:, 0] - np.sum(a[:, 1:] * b[:, 1:], axis=1)
    v = a[:, :1] * b[:, 1:] + b[:, :1] * a[:, 1:] + np.cross(a[:, 1:], b[:, 1:])
    return np.column_stack([w, v])
