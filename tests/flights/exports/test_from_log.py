"""The vehicle's track from its log, on the clock of the flight."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import vehicle_logs
from command_line import assert_one_line_error, run
from pymavlink import mavutil
from two_motions import TwoMotions

from padstudio.errors import SpecError
from padstudio.flights.exports.from_log import has_track, track_of
from padstudio.geometry.pose import Pose
from padstudio.media.telemetry import reading
from padstudio.vision.stage.detection import Detection, Uncertainty

MOTIONS = TwoMotions(3, climb_m=2.0)
OFFSET_S = 312.25


def records(motions: TwoMotions = MOTIONS) -> list[dict[str, Any]]:
    time_s = np.arange(0, 20, 0.05)
    heights, turns = motions.height_m(time_s), motions.camera(time_s, 0.2)
    sigma = np.diag([1.0] * 3 + [1e-6] * 3)
    found = []
    for k, (height, turned) in enumerate(zip(heights, turns, strict=True)):
        pose = Pose(np.array([0.0, 0.0, 1000 * height]), turned)
        detection = Detection(pose, layer="red", uncertainty=Uncertainty.of(pose, sigma))
        found.append(detection.to_record("a.mp4", frame=k, time_s=float(time_s[k])))
    return found


def flown(motions: TwoMotions = MOTIONS) -> vehicle_logs.Flown:
    time_s = np.arange(-15, 35, 0.1)
    local = np.column_stack([0.1 * time_s, np.cos(time_s), -motions.height_m(time_s)])
    return vehicle_logs.Flown(time_s + OFFSET_S, motions.angles(time_s), local)


@pytest.mark.parametrize("write", [vehicle_logs.ulog, vehicle_logs.dataflash, vehicle_logs.tlog])
def test_a_track_is_put_on_the_flights_clock(write: Any) -> None:
    columns = reading.parse(write(flown()))
    assert has_track(columns)
    track = track_of(columns, records())
    for time_s in (0.3, 7.77, 19.4):
        found = track.at(time_s)
        assert found is not None
        position, rotation = found
        true = [0.1 * time_s, np.cos(time_s), -MOTIONS.height_m(np.array([time_s]))[0]]
        assert position == pytest.approx(true, abs=0.06)
        assert rotation == pytest.approx(MOTIONS.body(np.array([time_s]))[0], abs=0.03)


def test_what_tells_no_track_is_refused() -> None:
    with pytest.raises(SpecError) as caught:
        track_of(reading.parse(vehicle_logs.ulog(flown(TwoMotions(44)))), records())
    assert caught.value.error_code == "clock_not_matched"
    columns = reading.parse(vehicle_logs.ulog(flown()))
    columns["north_m"] = [None] * len(columns["time_s"])
    with pytest.raises(SpecError, match="local position"):
        track_of(columns, records())
    assert not has_track(None)
    assert not has_track({"time_s": [0.0], "height_m": [1.0]})


def test_the_command_line_takes_a_log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("poses.jsonl").write_text("\n".join(map(json.dumps, records())))
    Path("log.bin").write_bytes(vehicle_logs.dataflash(flown()))
    Path("other.bin").write_bytes(vehicle_logs.dataflash(flown(TwoMotions(44))))
    arguments = ("export", "poses.jsonl", "--form", "px4", "-o", "a.tlog", "--vehicle")
    assert_one_line_error(run(*arguments, "other.bin"), "clock_not_matched")
    result = run(*arguments, "log.bin")
    assert result.exit_code == 0, result.stderr
    log = mavutil.mavlink_connection("a.tlog", dialect="common")
    count = 0
    while log.recv_match(type="LANDING_TARGET") is not None:
        count += 1
    log.close()
    assert count == len(records())
