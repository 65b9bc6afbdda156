"""The ROS 2 bag of poses, read back by `rosbags`."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from export_records import POSES, SURE, records, rotation, times
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_typestore

from padstudio.flights.exports.forms import export
from padstudio.flights.exports.options import ExportOptions
from padstudio.flights.exports.ros2_bag import FOLDER, POSE_TOPIC, TF_TOPIC, ros_covariance
from padstudio.geometry.pose import Pose

STORE = get_typestore(Stores.ROS2_HUMBLE)
START_S = 1_750_000_000.25


def _read(told: list[dict[str, Any]], folder: Path, **options: Any) -> dict[str, list[Any]]:
    """Times of recording and messages by topic."""
    data = b"".join(export("ros2", told, ExportOptions(**options)))
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        archive.extractall(folder)
    found: dict[str, list[Any]] = {}
    with Reader(folder / FOLDER) as reader:
        for connection, time_ns, raw in reader.messages(reader.connections):
            message = STORE.deserialize_cdr(raw, connection.msgtype)
            found.setdefault(connection.topic, []).append((time_ns, message))
    return found


def _stamp_ns(header: Any) -> int:
    return int(header.stamp.sec) * 10**9 + int(header.stamp.nanosec)


def _vector(value: Any) -> list[float]:
    return [value.x, value.y, value.z]


def test_poses_and_transforms_are_those_of_the_flight(tmp_path: Path) -> None:
    found = _read(records(), tmp_path, start_unix_s=START_S)
    assert set(found) == {POSE_TOPIC, TF_TOPIC}
    for (log_ns, told), (_, tf), pose, time_s in zip(
        found[POSE_TOPIC], found[TF_TOPIC], POSES, times(), strict=True
    ):
        assert log_ns == _stamp_ns(told.header) == pytest.approx((START_S + time_s) * 1e9, abs=500)
        assert told.header.frame_id == "pad"
        (transform,) = tf.transforms
        assert (transform.header.frame_id, transform.child_frame_id) == ("pad", "camera")
        assert _stamp_ns(transform.header) == log_ns
        for place, turn in (
            (told.pose.pose.position, told.pose.pose.orientation),
            (transform.transform.translation, transform.transform.rotation),
        ):
            assert _vector(place) == pytest.approx(pose.position_mm / 1000, abs=1e-12)
            wxyz = [turn.w, *_vector(turn)]
            assert rotation(wxyz) == pytest.approx(pose.rotation, abs=1e-12)


def test_poses_of_which_the_bearing_alone_counts_are_left_out(tmp_path: Path) -> None:
    found = _read(records(bearing_at=(1, 3)), tmp_path)
    assert len(found[POSE_TOPIC]) == len(found[TF_TOPIC]) == len(POSES) - 2


def _turned(pose: Pose, turn: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """The rotation after a small turn about the camera's own axes."""
    x, y, z = turn
    return np.asarray(pose.rotation @ (np.eye(3) + np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])))


def test_the_covariance_is_in_metres_about_the_pads_axes(tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    root = np.tril(rng.normal(size=(6, 6))) * [[1], [2], [3], [1e-3], [2e-3], [3e-3]]
    covariance = root @ root.T
    told = [
        record | {"covariance": covariance[np.triu_indices(6)].tolist()}
        if record["status"] == "ok"
        else record
        for record in records()
    ]
    found = _read(told, tmp_path)
    draws = rng.normal(size=(4000, 6)) @ root.T
    for (_, message), pose in zip(found[POSE_TOPIC], POSES, strict=True):
        got = message.pose.covariance.reshape(6, 6)
        assert got == pytest.approx(got.T, rel=1e-9)
        # What drawn poses do about the pad's axes: R' R^T is the turn that ROS means.
        spins = [_turned(pose, draw[3:]) @ pose.rotation.T for draw in draws]
        about = np.array([[s[2, 1], s[0, 2], s[1, 0]] for s in spins])
        expected = np.cov(np.c_[draws[:, :3] / 1000, about], rowvar=False)
        scale = np.sqrt(np.outer(np.diag(got), np.diag(got)))
        assert np.abs((got - expected) / scale).max() < 0.07


def test_without_a_covariance_the_deviations_count() -> None:
    record = {"position_sigma_mm": [1.0, 2, 3], "attitude_sigma_deg": [0.1, 0.2, 0.3]}
    pose = POSES[2]
    got = ros_covariance(record, pose)
    assert np.sqrt(np.diag(got)[:3]) == pytest.approx([1e-3, 2e-3, 3e-3])
    back = pose.rotation.T @ got[3:, 3:] @ pose.rotation
    assert np.degrees(np.sqrt(np.diag(back))) == pytest.approx([0.1, 0.2, 0.3])
    assert not got[:3, 3:].any()
    assert ros_covariance({"covariance": SURE[np.triu_indices(6)].tolist()}, pose)[0, 0] == 1e-6


@pytest.mark.parametrize("form", ["ros2", "tum"])
def test_frames_of_recordings_keep_their_stamps(form: str, tmp_path: Path) -> None:
    stamps = [1_750_000_000_123_456_789 + 40_000_001 * n for n in range(len(records()))]
    told = [record | {"stamp_ns": stamp} for record, stamp in zip(records(), stamps, strict=True)]
    kept = [r["stamp_ns"] for r in told if r["status"] == "ok"]
    if form == "ros2":
        assert [log_ns for log_ns, _ in _read(told, tmp_path)[POSE_TOPIC]] == kept
        moved = _read(told, tmp_path / "moved", start_unix_s=START_S)
        assert moved[POSE_TOPIC][0][0] == pytest.approx((START_S + times()[0]) * 1e9, abs=500)
        return
    text = b"".join(export("tum", told)).decode()
    assert "timestamp: seconds of Unix time" in text
    table = np.loadtxt(io.StringIO(text))
    assert table[:, 0] == pytest.approx(np.array(kept) / 1e9, abs=1e-6)


def test_the_same_poses_are_the_same_file() -> None:
    first, second = (b"".join(export("ros2", records())) for _ in range(2))
    assert first == second
