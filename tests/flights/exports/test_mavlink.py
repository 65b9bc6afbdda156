"""Telemetry logs, read back by pymavlink's own log reader."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from export_records import PAD_SIZE_MM, POSES, pad_in_camera_m, records, rotation, times
from pymavlink import mavutil

from padstudio.autopilot.vehicle import Mount, VehicleTrack
from padstudio.errors import SpecError
from padstudio.flights.exports.forms import export
from padstudio.flights.exports.options import ExportOptions

START_S = 1_700_000_000.0
MAV = mavutil.mavlink


def _read(
    tmp_path: Path, form: str, bearing_at: tuple[int, ...] = (), **options: Any
) -> tuple[list[Any], list[str]]:
    path = tmp_path / "a.tlog"
    given = ExportOptions(pad_size_mm=PAD_SIZE_MM, start_unix_s=START_S, **options)
    path.write_bytes(b"".join(export(form, records(bearing_at), given)))
    log = mavutil.mavlink_connection(str(path), dialect="common")
    targets, texts = [], []
    while (message := log.recv_match()) is not None:
        assert message.get_type() != "BAD_DATA"
        if message.get_type() == "LANDING_TARGET":
            assert message._timestamp == pytest.approx(message.time_usec / 1e6, abs=1e-6)
            targets.append(message)
        else:
            texts.append(message.text)
    log.close()
    return targets, texts


def _xyz(message: Any) -> Any:
    return np.array([message.x, message.y, message.z])


def test_ardupilot_reads_metres_in_the_body_frame(tmp_path: Path) -> None:
    targets, texts = _read(tmp_path, "ardupilot")
    assert texts == ["LANDING_TARGET MAV_FRAME_BODY_FRD m"]
    assert len(targets) == len(POSES)
    for message, pose, time_s in zip(targets, POSES, times(), strict=True):
        assert (message.frame, message.position_valid) == (MAV.MAV_FRAME_BODY_FRD, 1)
        assert message.type == MAV.LANDING_TARGET_TYPE_VISION_FIDUCIAL
        assert message.time_usec == round((START_S + time_s) * 1e6)
        right, down, ahead = pad_in_camera_m(pose)
        # The camera looks down, and up in the picture is forward.
        assert _xyz(message) == pytest.approx([-down, right, ahead], rel=1e-6, abs=1e-6)
        assert message.distance == pytest.approx(np.linalg.norm(_xyz(message)), rel=1e-6)
        assert message.angle_x == pytest.approx(math.atan2(right, ahead), abs=1e-6)
        assert message.angle_y == pytest.approx(math.atan2(down, ahead), abs=1e-6)
        assert message.size_x == pytest.approx(2 * math.atan(0.2 / message.distance), rel=1e-6)


@pytest.mark.parametrize("form", ["ardupilot", "px4"])
def test_range_and_bearing_are_enough_for_a_target(tmp_path: Path, form: str) -> None:
    vehicle = _track(np.zeros(3), np.diag([1.0, -1.0, -1.0])) if form == "px4" else None
    full = _read(tmp_path, form, vehicle=vehicle)[0]
    told = _read(tmp_path, form, bearing_at=(1, 3), vehicle=vehicle)[0]
    assert len(told) == len(POSES)
    for k, (found, expected) in enumerate(zip(told, full, strict=True)):
        assert _xyz(found) == pytest.approx(_xyz(expected), abs=1e-6)
        assert found.distance == expected.distance
        assert (found.angle_x, found.angle_y) == (expected.angle_x, expected.angle_y)
        # No attitude is told that is not known.
        assert found.q == ([0, 0, 0, 0] if k in (1, 3) else expected.q)


def test_a_pad_right_below_a_level_vehicle(tmp_path: Path) -> None:
    first = _read(tmp_path, "ardupilot")[0][0]
    assert _xyz(first) == pytest.approx([0, 0, 1.2], abs=1e-6)
    assert first.q == pytest.approx([1, 0, 0, 0], abs=1e-6)


def test_the_mount_counts(tmp_path: Path) -> None:
    # The picture's up is to the right of the vehicle, the camera 10 cm ahead and 5 cm below it.
    mount = Mount.downward(90.0, np.array([0.1, 0, 0.05]))
    assert mount.rotation == pytest.approx(np.diag([-1.0, -1, 1]))
    targets, _ = _read(tmp_path, "ardupilot", mount=mount)
    for message, pose in zip(targets, POSES, strict=True):
        right, down, ahead = pad_in_camera_m(pose)
        expected = [-right + 0.1, -down, ahead + 0.05]
        assert _xyz(message) == pytest.approx(expected, rel=1e-6, abs=1e-6)


def test_a_mount_is_a_rotation() -> None:
    with pytest.raises(SpecError, match="rotation"):
        Mount(np.diag([1.0, 1, -1]))


def _track(pad_local_m: Any, R_local_pad: Any) -> VehicleTrack:
    """The track of a vehicle whose downward camera had exactly `POSES`, found the other way."""
    R_camera_body = np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]])
    places, turns = [], []
    for pose in POSES:
        places.append(pad_local_m + R_local_pad @ pose.position_mm / 1000)
        R = R_local_pad @ pose.rotation @ R_camera_body
        w = math.sqrt(max(0.0, 1 + np.trace(R))) / 2
        vector = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / (4 * w)
        turns.append([w, *vector])
    return VehicleTrack(np.array(times()), np.array(places), np.array(turns))


def test_px4_finds_one_place_in_the_local_frame(tmp_path: Path) -> None:
    pad_local_m = np.array([12.0, -7.0, -3.0])
    # The pad lies flat; up the page is north-east.
    c = math.sqrt(0.5)
    R_local_pad = np.array([[-c, c, 0], [c, c, 0], [0, 0, -1]])
    targets, texts = _read(tmp_path, "px4", vehicle=_track(pad_local_m, R_local_pad))
    assert texts == ["LANDING_TARGET MAV_FRAME_LOCAL_NED m"]
    assert len(targets) == len(POSES)
    for message in targets:
        assert (message.frame, message.position_valid) == (MAV.MAV_FRAME_LOCAL_NED, 1)
        assert _xyz(message) == pytest.approx(pad_local_m, abs=1e-5)
        assert rotation(message.q)[:, 0] == pytest.approx([c, c, 0], abs=1e-5)


def test_px4_without_the_vehicle_is_refused() -> None:
    with pytest.raises(SpecError, match="needs the vehicle's own poses") as caught:
        export("px4", records())
    assert caught.value.error_code == "vehicle_pose_required"


def test_frames_without_a_vehicle_pose_are_left_out(tmp_path: Path) -> None:
    stay = np.tile([1.0, 0, 0, 0], (3, 1))
    track = VehicleTrack(np.array([0.05, 0.3, 0.9]), np.zeros((3, 3)), stay)
    targets, _ = _read(tmp_path, "px4", vehicle=track)
    # 0 is before the first pose; 0.4 and 0.5 lie in a gap of 0.6 s.
    assert [round(m.time_usec / 1e6 - START_S, 3) for m in targets] == [0.1, 0.3]
