from __future__ import annotations

import contextlib
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from export_records import POSES, on_an_arc, records

from padstudio.errors import StudioError
from padstudio.flights.exports.from_file import PosesFile, export_file
from padstudio.flights.exports.options import ExportChoices
from padstudio.flights.results.completed import completed
from padstudio.flights.results.poses_file import PosesFormatError, parse_record, read_poses
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
        ({"quality": "good"}, "quality"),
        ({"range_mm": "far"}, "range_mm"),
        ({"bearing": [0, 1]}, "bearing"),
        ({"position_sigma_mm": [1, 2, "3"]}, "position_sigma_mm"),
        ({"covariance": [1.0] * 36}, "covariance"),
        ({"position_mm": [0, 0, 0]}, "position_mm"),
    ],
)
def test_ill_formed_records_are_named(tmp_path: Path, change: dict[str, Any], said: str) -> None:
    path = tmp_path / "poses.jsonl"
    path.write_text(f"{json.dumps(GOOD)}\n{json.dumps(GOOD | change)}\n")
    with pytest.raises(PosesFormatError, match=rf"poses.jsonl, line 2: .*{said}"):
        list(read_poses(path))


ODD = (0.2, True, "x", "", [], [1], [None, None], {}, {"a": []}, [[1, 0, 0]] * 3, -1, 1e300)


@pytest.mark.parametrize("record", [GOOD, FAILED], ids=["ok", "failed"])
def test_whatever_a_field_holds_is_refused_or_written(
    tmp_path: Path, record: dict[str, Any]
) -> None:
    path, taken = tmp_path / "poses.jsonl", 0
    for key in {*GOOD, *FAILED, "flatness_mm", "frame_px", "estimate", "pad_id", "topic"}:
        for value in ODD:
            path.write_text(json.dumps(record | {key: value}) + "\n")
            with contextlib.suppress(PosesFormatError):
                list(read_poses(path))
                taken += 1
                for form in ("csv", "tum", "mcap"):
                    with contextlib.suppress(StudioError):
                        b"".join(export_file(PosesFile(path=path), ExportChoices(form=form)).blocks)
    assert taken


@pytest.mark.parametrize("half", [b"\\ud800", b"\xed\xa0\x80"], ids=["escaped", "raw"])
def test_halves_of_surrogate_pairs_are_refused(half: bytes) -> None:
    line = json.dumps(FAILED | {"detail": "HERE"}).encode().replace(b"HERE", half)
    with pytest.raises(PosesFormatError):
        parse_record(line)


def test_a_mark_of_the_encoding_is_no_fault() -> None:
    assert parse_record(b"\xef\xbb\xbf" + json.dumps(FAILED).encode()) == FAILED


FIELDS = ("range_mm", "bearing", "range_sigma_mm", "bearing_sigma_deg", "quality")


def older(record: dict[str, Any]) -> dict[str, Any]:
    """A record as it was before these fields came."""
    return {key: record[key] for key in record if key not in FIELDS}


def test_an_older_file_is_completed_as_far_as_it_tells(tmp_path: Path) -> None:
    told = records(bearing_at=(1,))[:2]
    bare = older(told[0]) | {"position_sigma_mm": None, "attitude_sigma_deg": None}
    path = tmp_path / "poses.jsonl"
    path.write_text("".join(json.dumps(record) + "\n" for record in [*map(older, told), bare]))
    *found, unknown = read_poses(path)
    for record, expected in zip(found, told, strict=True):
        assert record["range_mm"] == expected["range_mm"]
        assert record["bearing"] == expected["bearing"]
        assert record["quality"] == expected["quality"]
        # Without the covariance nobody knows how the errors cancel.
        assert record["range_sigma_mm"] is record["bearing_sigma_deg"] is None
    assert unknown["quality"] is None


def test_with_its_covariance_an_older_record_tells_all() -> None:
    told = records(bearing_at=(1,))[1]
    upper = on_an_arc(POSES[1])[np.triu_indices(6)].tolist()
    found = completed(older(told) | {"covariance": upper})
    assert found["range_sigma_mm"] == pytest.approx(told["range_sigma_mm"])
    assert found["bearing_sigma_deg"] == pytest.approx(told["bearing_sigma_deg"])
    bare = {"position_sigma_mm": None, "attitude_sigma_deg": None, "covariance": upper}
    assert completed(older(told) | bare)["quality"] == "bearing"


@pytest.mark.parametrize("text", ["pad", "[1]", "\x00\xff"])
def test_other_files_are_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "a.png"
    path.write_text(text)
    with pytest.raises(PosesFormatError, match="line 1"):
        list(read_poses(path))
