"""Logs of vehicles, read as the libraries' own readers do and as they were written."""

from __future__ import annotations

import contextlib
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import vehicle_logs
from hypothesis import given, settings
from hypothesis import strategies as st
from vehicle_logs import Flown

from padstudio.errors import SpecError
from padstudio.media import content
from padstudio.media.telemetry import dataflash, reading, tlog, ulog, vehicle_table
from padstudio.media.telemetry.columns import TelemetryError
from padstudio.media.telemetry.vehicle_log import Series

FLOWN = vehicle_logs.wandering(4.0)
WRITERS: dict[str, Callable[[Flown], bytes]] = {
    "ulog": vehicle_logs.ulog,
    "dataflash": vehicle_logs.dataflash,
    "tlog": vehicle_logs.tlog,
    "csv": vehicle_logs.table,
}


@pytest.mark.parametrize("kind", WRITERS)
def test_logs_say_what_was_flown(kind: str, tmp_path: Path) -> None:
    path = tmp_path / "log"
    path.write_bytes(WRITERS[kind](FLOWN))
    assert content.identify(path.read_bytes()[: content.HEAD_BYTES]).kind == "telemetry"
    found = reading.read(str(path))
    assert found["kind"] == kind
    count = len(found["time_s"])
    assert all(len(found[name]) == count for name in found if isinstance(found[name], list))
    # Every second of 50 rows a second; a log counts from its first.
    assert count == len(FLOWN.time_s) // 2
    zero_s = 0.0 if kind == "csv" else 100.0
    assert np.array(found["time_s"]) + zero_s == pytest.approx(FLOWN.time_s[::2], abs=1e-3)
    local = np.column_stack([found[name] for name in ("north_m", "east_m", "down_m")])
    assert local == pytest.approx(FLOWN.local_m[::2], abs=1e-5)
    assert np.array(found["height_m"]) == pytest.approx(-FLOWN.local_m[::2, 2], abs=1e-3)
    turns = np.column_stack([found[name] for name in ("qw", "qx", "qy", "qz")])
    # DataFlash has hundredths of a degree.
    assert turns == pytest.approx(FLOWN.quaternions[::2], abs=1e-4)
    if kind != "csv":
        names = ("latitude_deg", "longitude_deg", "altitude_m")
        place = np.column_stack([found[name] for name in names])
        assert place == pytest.approx(FLOWN.place[::2], rel=0, abs=1e-3)


@pytest.mark.parametrize("kind", WRITERS)
@pytest.mark.parametrize("cut", [slice(None), slice(0, -7), slice(3, None)])
def test_reading_a_log_prints_nothing(
    kind: str, cut: slice, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Results may go to standard output."""
    data = WRITERS[kind](FLOWN)
    middle = len(data) // 2
    path = tmp_path / "log"
    path.write_bytes((data[:middle] + bytes(40) + data[middle:])[cut])
    with contextlib.suppress(TelemetryError, SpecError):
        reading.read(str(path))
    assert capsys.readouterr() == ("", "")


def test_written_logs_are_what_their_libraries_read(tmp_path: Path) -> None:
    from pymavlink import mavutil
    from pymavlink.DFReader import DFReader_binary
    from pyulog import ULog

    for kind in ("ulog", "dataflash", "tlog"):
        (tmp_path / kind).write_bytes(WRITERS[kind](FLOWN))
    topic = ULog(str(tmp_path / "ulog")).get_dataset("vehicle_attitude").data
    assert topic["q[3]"] == pytest.approx(FLOWN.quaternions[:, 3], abs=1e-6)
    log = DFReader_binary(str(tmp_path / "dataflash"))
    rolls = []
    while (message := log.recv_match(type="ATT")) is not None:
        rolls.append(message.Roll)
    log.close()
    assert rolls == pytest.approx(np.degrees(FLOWN.angles[:, 0]).tolist(), abs=0.006)
    link = mavutil.mavlink_connection(str(tmp_path / "tlog"), dialect="common")
    yaws = []
    while (message := link.recv_match(type="ATTITUDE")) is not None:
        if message.get_srcComponent() == 1:
            yaws.append(message.yaw)
    link.close()
    assert yaws == pytest.approx(FLOWN.angles[:, 2].tolist(), abs=1e-6)


@pytest.mark.parametrize("parse", [ulog.parse, dataflash.parse, tlog.parse])
@settings(max_examples=25, deadline=None)
@given(data=st.data())
def test_damage_is_an_error_of_ours_or_a_part(parse: Callable[[bytes], Any], data: Any) -> None:
    kind = parse.__module__.rpartition(".")[2]
    whole = bytearray(WRITERS[kind](vehicle_logs.wandering(0.4)))
    whole = whole[: data.draw(st.integers(20, len(whole)))]
    for _ in range(data.draw(st.integers(0, 3))):
        whole[data.draw(st.integers(9, len(whole) - 1))] = data.draw(st.integers(0, 255))
    with contextlib.suppress(TelemetryError):
        parse(bytes(whole)).to_dict()


def test_nothing_is_told_over_gaps() -> None:
    holed = np.r_[0:100, 150:200]
    flown = Flown(FLOWN.time_s[holed], FLOWN.angles[holed], FLOWN.local_m[holed])
    series = Series.of(flown.time_s, flown.local_m)
    assert series is not None
    found = series.at(np.array([99.9, 100.01, 102.5, 103.51, 104.1]))
    assert np.isnan(found[:, 0]).tolist() == [True, False, True, False, True]
    assert found[1] == pytest.approx((FLOWN.local_m[0] + FLOWN.local_m[1]) / 2)


def test_what_cannot_be_meant_is_refused() -> None:
    with pytest.raises(TelemetryError, match="vehicles 1, 7"):
        tlog.parse(vehicle_logs.tlog(FLOWN, systems=(1, 7)))
    again = Flown(
        np.r_[FLOWN.time_s, FLOWN.time_s],
        np.r_[FLOWN.angles, FLOWN.angles],
        np.r_[FLOWN.local_m, FLOWN.local_m],
    )
    with pytest.raises(TelemetryError, match="clock of the log goes back"):
        ulog.parse(vehicle_logs.ulog(again))
    with pytest.raises(TelemetryError, match="neither attitude nor height"):
        tlog.parse(b"").to_dict()
    with pytest.raises(SpecError, match="no number"):
        vehicle_table.parse(vehicle_logs.table(FLOWN) + b"\n1,2,x,4,5,6,7,8")


@pytest.mark.parametrize(
    "row",
    ["0.1,nan,0,-3,1,0,0,0", "0,1,0,-3,1,0,0,0", "-1,1,0,-3,1,0,0,0", "0.1,1,0,-3,0,0,0,0", ""],
)
def test_a_table_is_taken_whole_or_refused(row: str) -> None:
    header = ",".join(vehicle_table.COLUMNS)
    with pytest.raises(SpecError, match="rising times and unit quaternions"):
        vehicle_table.parse(f"{header}\n0,0,0,-3,1,0,0,0\n{row}\n".encode())
    with pytest.raises(SpecError, match="column time_s twice"):
        vehicle_table.parse(f"time_s,{header}\n9,0,0,0,-3,1,0,0,0\n".encode())
    found = vehicle_table.parse(f"{header}\n0,0,0,-3,2,0,0,0\n1,0,0,-3,0,0,0,2\n".encode())
    assert found.attitude is not None
    assert found.attitude.values.tolist() == [[1, 0, 0, 0], [0, 0, 0, 1]]


def test_a_position_that_is_not_valid_is_not_taken() -> None:
    data = bytearray(vehicle_logs.ulog(FLOWN))
    flags = struct.pack("<3f", *FLOWN.local_m[0]) + b"\x01\x01"
    place = data.index(flags) + len(flags) - 1
    data[place] = 0
    log = ulog.parse(bytes(data))
    assert log.local is not None
    assert log.height is not None
    assert len(log.local.time_s) == len(log.height.time_s) == len(FLOWN.time_s) - 1


@pytest.mark.parametrize("finite", [0, 1])
@pytest.mark.parametrize("count", [0, 1, 2, 9])
def test_of_fewer_than_two_finite_values_there_is_no_series(count: int, finite: int) -> None:
    values = np.full((count, 3), np.nan)
    values[:finite] = 1.0
    assert Series.of(np.arange(float(count)), values) is None
