"""MAVLink LANDING_TARGET as a telemetry log (.tlog), in the profiles that autopilots read.

ArduPilot takes the target's position in the body frame; PX4 takes it in the local frame alone, for
which the vehicle's own pose must be known. Range and bearing are enough for both, so poses of
either quality are sent, those of quality ``full`` alone with the target's orientation. A .tlog is a
sequence of packets, each after its time in microseconds of Unix time, 8 bytes big-endian.

References
----------
https://mavlink.io/en/services/landing_target.html
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterable, Iterator
from typing import Any

import numpy as np

from padstudio.autopilot.target import (
    Sight,
    Target,
    picture_fields,
    position_fields,
    target_in_body,
)
from padstudio.autopilot.vehicle import MAX_GAP_S, VehicleTrack
from padstudio.errors import SpecError
from padstudio.flights.exports.frames.records import timed
from padstudio.flights.exports.options import ExportOptions, Record, at_least_one, full_pose_of

# A companion computer of vehicle 1 speaks.
_SYSTEM, _COMPONENT = 1, 191


Place = Callable[[Target, float], Target | None]


def write_ardupilot(records: Iterable[Record], options: ExportOptions) -> Iterator[bytes]:
    """``MAV_FRAME_BODY_FRD``: metres forward, right and down from the vehicle."""
    return _write(records, options, "MAV_FRAME_BODY_FRD", lambda target, _: target, lambda: "")


def write_px4(records: Iterable[Record], options: ExportOptions) -> Iterator[bytes]:
    """``MAV_FRAME_LOCAL_NED``: metres north, east and down from the vehicle's origin.

    Frames at which the vehicle's pose is not known are left out.

    Raises
    ------
    SpecError
        If no poses of the vehicle are given.
    EmptyExportError
        If at the time of no frame with a pose the vehicle's is known.
    """
    track = options.vehicle
    if track is None:
        raise SpecError(
            "PX4 takes landing targets in its local frame alone, which needs the vehicle's own "
            "poses: give them, or use the ArduPilot profile",
            code="vehicle_pose_required",
        )

    def to_local(target: Target, time_s: float) -> Target | None:
        found = track.at(time_s)
        if found is None:
            return None
        return target.moved(*found)

    return _write(records, options, "MAV_FRAME_LOCAL_NED", to_local, lambda: _apart(track))


def _apart(track: VehicleTrack) -> str:
    return (
        f"at the time of none of them the vehicle's pose is known: its track goes from "
        f"{track.start_s:g} s to {track.end_s:g} s of the flight, with {track.usual_gap_s:g} s "
        f"between rows, and gaps above {MAX_GAP_S:g} s are not bridged; give a track on the "
        "flight's clock with more rows"
    )


def sight_of(record: Record) -> Sight | None:
    """A record's range and bearing; None where the frame failed."""
    if record["status"] != "ok":
        return None
    return Sight(record["range_mm"] / 1000, np.array(record["bearing"], float))


def _write(
    records: Iterable[Record],
    options: ExportOptions,
    frame: str,
    place: Place,
    why_none: Callable[[], str],
) -> Iterator[bytes]:
    from pymavlink.dialects.v20 import common

    link = common.MAVLink(None, _SYSTEM, _COMPONENT)

    def packet(message: Any, time_us: int) -> bytes:
        data: bytes = message.pack(link)
        link.seq = (link.seq + 1) % 256
        return struct.pack(">Q", time_us) + data

    start_us = round(options.start_unix_s * 1e6)
    header: bytes | None = packet(_header(common, frame), start_us)
    for time_s, fields in _targets(records, options, place, why_none):
        if header is not None:
            yield header
            header = None
        time_us = start_us + round(time_s * 1e6)
        message = common.MAVLink_landing_target_message(
            time_usec=time_us,
            target_num=0,
            frame=getattr(common, frame),
            **fields,
            type=common.LANDING_TARGET_TYPE_VISION_FIDUCIAL,
            position_valid=1,
        )
        yield packet(message, time_us)


def _targets(
    records: Iterable[Record],
    options: ExportOptions,
    place: Place,
    why_none: Callable[[], str],
) -> Iterator[tuple[float, dict[str, Any]]]:
    """Times, s, and fields of the messages; raises `EmptyExportError` where there is none."""
    sights = 0

    def found() -> Iterator[tuple[float, dict[str, Any]]]:
        nonlocal sights
        for record, time_s in timed(records):
            sight = sight_of(record)
            if sight is None:
                continue
            sights += 1
            body = target_in_body(sight, full_pose_of(record), options.mount)
            target = place(body, time_s)
            if target is not None:
                seen = picture_fields(sight, body, options.pad_size_mm)
                yield time_s, seen | position_fields(target)

    def nothing() -> str:
        what = f"{sights} frames have a pose, but {why_none()}" if sights else "no frame has a pose"
        return f"no LANDING_TARGET was written: {what}"

    return at_least_one(found(), nothing)


def _header(common: Any, frame: str) -> Any:
    """The convention, where log viewers show messages; 50 bytes are all there is."""
    text = f"LANDING_TARGET {frame} m".encode()
    return common.MAVLink_statustext_message(common.MAV_SEVERITY_INFO, text)
