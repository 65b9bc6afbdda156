"""Heights and attitudes of a log beside those of poses."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from two_motions import TwoMotions, quaternion_wxyz

from padstudio.flights.vehicle.comparison import compare
from padstudio.flights.vehicle.ours import OurPoses

SCALE = 1.05


def _ours(motions: TwoMotions, seconds: float = 20.0) -> OurPoses:
    time_s = np.arange(0, seconds, 0.05)
    height = SCALE * (motions.height_m(time_s) - 3) + 0.001 * np.sin(40 * time_s)
    q = quaternion_wxyz(motions.camera(time_s, 0.2))
    return OurPoses(np.arange(len(time_s)), time_s, height, q)


def _columns(motions: TwoMotions, kind: str, offset_s: float) -> dict[str, Any]:
    time_s = np.arange(-10, 40, 0.1)
    q = quaternion_wxyz(motions.body(time_s))
    return {
        "kind": kind,
        "time_s": (time_s + offset_s).tolist(),
        "height_m": motions.height_m(time_s).tolist(),
        "altitude_m": [None] * len(time_s),
        **{name: q[:, k].tolist() for k, name in enumerate(("qw", "qx", "qy", "qz"))},
    }


@pytest.mark.parametrize(("kind", "offset_s"), [("ulog", 500.0), ("csv", 0.0)])
def test_a_log_beside_poses(kind: str, offset_s: float) -> None:
    motions = TwoMotions(3, climb_m=2.0)
    found = compare(_ours(motions), _columns(motions, kind, offset_s))
    assert json.loads(json.dumps(found)) == found
    assert found["clock"]["is_flights"] == (kind == "csv")
    assert found["clock"]["offset_s"] == pytest.approx(offset_s, abs=0.02)
    assert found["mount"]["rotation"] == pytest.approx(motions.mount, abs=0.02)
    error = found["scale_error"]
    assert error["low"] < SCALE - 1 < error["high"] or error["value"] == pytest.approx(
        SCALE - 1, abs=0.003
    )
    columns = found["columns"]
    assert len({len(values) for values in columns.values()}) == 1
    assert np.median(np.abs(columns["residual_mm"])) < 20
    assert np.median(np.abs(np.subtract(columns["vehicle_m"], columns["pose_m"]))) < 0.2
    assert np.median(np.abs(columns["attitude_residual_deg"])) < 1
    tilt = np.subtract(columns["tilt_deg"], columns["vehicle_tilt_deg"])
    assert np.median(np.abs(tilt)) < 0.5


def test_subtitles_have_heights_alone() -> None:
    motions = TwoMotions(3, climb_m=2.0)
    told = _columns(motions, "srt", 0.0)
    columns = {name: told[name] for name in ("time_s", "altitude_m")} | {
        "height_m": [None] * len(told["time_s"]),
        "altitude_m": told["height_m"],
    }
    found = compare(_ours(motions), columns)
    assert (found["kind"], found["mount"]) == ("srt", None)
    assert found["mount_reason"] == "the log holds no attitude"
    assert found["scale_error"]["value"] == pytest.approx(SCALE - 1, abs=0.003)
    assert "vehicle_tilt_deg" not in found["columns"]


def test_what_is_not_told_is_left_out() -> None:
    found = compare(_ours(TwoMotions(3)), _columns(TwoMotions(50), "tlog", 9.0))
    assert (found["clock"]["offset_s"], found["mount"], found["fit"]) == (None, None, None)
    assert found["columns"] == {}
    assert found["mount_reason"]
    empty = OurPoses(np.zeros(0, np.int64), np.zeros(0), np.zeros(0), np.zeros((0, 4)))
    for kind in ("srt", "ulog"):
        assert compare(empty, _columns(TwoMotions(3), kind, 0.0))["columns"] == {}
