from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from padstudio.flights.results.poses_file import PosesFormatError, read_poses
from padstudio.geometry.pose import look_at_pad
from padstudio.vision.stage.detection import Detection
from padstudio.vision.stage.trace import Reason, StageFailure

GOOD = Detection(look_at_pad(500), layer="red").to_record("a.mp4", frame=3, time_s=0.1)
FAILED = Detection(None, StageFailure("lines", Reason.NO_LATTICE, "")).to_record("a.jpg")


def test_what_the_detector_writes_is_read(tmp_path: Path) -> None:
    path = tmp_path / "poses.jsonl"
    path.write_text(f"{json.dumps(GOOD)}\n\n{json.dumps(FAILED)}\n")
    assert list(read_poses(path)) == [GOOD, FAILED]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"source": None}, "source"),
        ({"frame": -1}, "frame"),
        ({"frame": True}, "frame"),
        ({"time_s": "0"}, "time_s"),
        ({"time_s": float("nan")}, "time_s"),
        ({"status": "maybe"}, "status"),
        ({"status": "failed"}, "stage"),
        ({"position_mm": [1, 2]}, "position_mm"),
        ({"position_mm": [1, 2, None]}, "position_mm"),
        ({"quaternion_xyzw": [0, 0, float("inf"), 1]}, "quaternion_xyzw"),
        ({"rotation": [[1, 0, 0], [0, 1, 0]]}, "rotation"),
        ({"rotation": "R"}, "rotation"),
    ],
)
def test_ill_formed_records_are_named(tmp_path: Path, change: dict[str, Any], said: str) -> None:
    path = tmp_path / "poses.jsonl"
    path.write_text(f"{json.dumps(GOOD)}\n{json.dumps(GOOD | change)}\n")
    with pytest.raises(PosesFormatError, match=rf"poses.jsonl, line 2: .*{said}"):
        list(read_poses(path))


@pytest.mark.parametrize("text", ["pad", "[1]", "\x00\xff"])
def test_other_files_are_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "a.png"
    path.write_text(text)
    with pytest.raises(PosesFormatError, match="line 1"):
        list(read_poses(path))
