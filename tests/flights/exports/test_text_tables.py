"""CSV, JSON lines, TUM and COLMAP, read back by readers of their own."""

from __future__ import annotations

import csv
import io
import json
import zipfile
from typing import Any

import cv2
import numpy as np
import pytest
from export_records import CAMERA, FAILED_AT, POSES, records, rotation, times

from padstudio.autopilot.vehicle import VehicleTrack
from padstudio.errors import EmptyExportError, NotFoundError, SpecError
from padstudio.flights.exports.forms import FORMS, export
from padstudio.flights.exports.options import ExportOptions
from padstudio.geometry.camera import Camera


def _text(form: str, **options: Any) -> str:
    return b"".join(export(form, records(), ExportOptions(**options))).decode()


def test_csv_has_a_row_a_frame_and_the_same_doubles() -> None:
    told = [record | {"position_sigma_mm": [1.0] * 3} for record in records(bearing_at=(1,))]
    text = b"".join(export("csv", told)).decode()
    rows = list(csv.DictReader(io.StringIO(text, newline="")))
    assert [row["quality"] for row in rows] == ["full", "bearing", "", *["full"] * 3]
    for row, record in zip(rows, told, strict=True):
        assert row["status"] == record["status"]
        assert float(row["time_s"]) == record["time_s"]
        if record["status"] == "ok":
            position = [float(row[f"camera_in_pad_{axis}_mm"]) for axis in "xyz"]
            quaternion = [float(row[f"pad_from_camera_q{axis}"]) for axis in "xyzw"]
            assert position == record["position_mm"]
            assert quaternion == record["quaternion_xyzw"]
            assert (row["layer"], row["cells_read"], row["sigma_x_mm"]) == ("red", "90", "1.0")
            assert [float(row[f"bearing_{axis}"]) for axis in "xyz"] == record["bearing"]
            for name in ("range_mm", "range_sigma_mm", "bearing_sigma_deg"):
                assert float(row[name]) == record[name]
            assert row["quality"] == record["quality"]
        else:
            assert (row["stage"], row["reason"]) == ("lines", "no_lattice")
            assert row["camera_in_pad_x_mm"] == ""


@pytest.mark.parametrize(
    "source",
    [
        *("=cmd|' /C calc'!A0", "+1.jpg", "-1.jpg", "@x", "\tx", " =1", "\u00a0=1", "\u200b=1"),
        *("\uff1d1", "\uff0b1", "\uff0d1", "\uff20x", "\ufe661", "\u22121", "\x00=1"),
    ],
)
@pytest.mark.parametrize("column", ["source", "layer", "pad_id"])
def test_csv_has_no_formulas(column: str, source: str) -> None:
    record = records()[0] | {column: source}
    (row,) = csv.DictReader(io.StringIO(b"".join(export("csv", [record])).decode(), newline=""))
    assert row[column] == "'" + source


def test_other_texts_of_csv_stay_as_they_are() -> None:
    record = records()[0] | {"source": "a=b - c+d@e.jpg"}
    (row,) = csv.DictReader(io.StringIO(b"".join(export("csv", [record])).decode(), newline=""))
    assert row["source"] == record["source"]


def test_jsonl_is_the_poses_file() -> None:
    for line, record in zip(_text("jsonl").splitlines(), records(), strict=True):
        told = json.loads(line)
        # Which follows from the quaternion.
        if record["status"] == "ok":
            turn = np.array(record.pop("rotation"))
            assert np.array(told.pop("rotation")) == pytest.approx(turn, abs=1e-15)
        assert told == record


def test_tum_read_by_numpy() -> None:
    text = _text("tum", start_unix_s=1_700_000_000.0)
    assert "pad frame, metres" in text
    assert "Unix time" in text.split("\n")[3]
    table = np.loadtxt(io.StringIO(text))
    assert table.shape == (len(POSES), 8)
    assert table[:, 0] == pytest.approx(np.array(times()) + 1_700_000_000.0, abs=1e-6)
    for row, pose in zip(table, POSES, strict=True):
        assert row[1:4] * 1000 == pytest.approx(pose.position_mm, abs=1e-5)
        # Quaternions stand scalar last.
        assert rotation(row[[7, 4, 5, 6]]) == pytest.approx(pose.rotation, abs=1e-9)


def test_trajectories_and_models_hold_full_poses_only() -> None:
    flight = records(bearing_at=(1, 4))
    # Nothing tells how sure the first one is.
    flight[0] |= {"quality": None}
    table = np.loadtxt(io.StringIO(b"".join(export("tum", flight)).decode()))
    assert table[:, 0] == pytest.approx([times()[k] for k in (2, 3)])
    data = b"".join(export("colmap", flight, ExportOptions(camera=CAMERA)))
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        lines = archive.read("images.txt").decode().splitlines()
    assert [line.split()[0] for line in lines if "a_flight" in line] == ["1", "2"]


def test_stills_have_times_of_their_own() -> None:
    stills = [
        record | {"source": f"{number}.jpg", "time_s": None, "frame": number}
        for number, record in enumerate(records())
    ]
    table = np.loadtxt(io.StringIO(b"".join(export("tum", stills)).decode()))
    assert table[:, 0].tolist() == [k for k in range(6) if k != FAILED_AT]


def _model(camera: Camera) -> dict[str, list[str]]:
    data = b"".join(export("colmap", records(), ExportOptions(camera=camera)))
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        assert archive.testzip() is None
        return {
            name: [
                line
                for line in archive.read(name).decode().splitlines()
                if not line.startswith("#")
            ]
            for name in archive.namelist()
        }


def test_colmap_takes_pad_points_to_pixels() -> None:
    model = _model(CAMERA)
    assert model["points3D.txt"] == []
    (line,) = model["cameras.txt"]
    number, name, width, height, *params = line.split()
    assert (number, name, width, height) == ("1", "PINHOLE", "640", "480")
    fx, fy, cx, cy = map(float, params)
    lines = model["images.txt"]
    assert lines[1::2] == [""] * len(POSES)
    for k, (line, pose) in enumerate(zip(lines[::2], POSES, strict=True)):
        image, *numbers, camera_id, file = line.split()
        assert (image, camera_id) == (str(k + 1), "1")
        assert file == f"a_flight/{round(times()[k] * 10):06d}.png"
        values = np.array(numbers, float)
        point = rotation(values[:4]) @ [0.1, -0.05, 0] + values[4:]
        pixel = np.array([fx, fy]) * point[:2] / point[2] + (cx, cy)
        seen = CAMERA.project((np.array([[100.0, -50, 0]]) - pose.position_mm) @ pose.rotation)
        # COLMAP counts pixels from the corner of the first one, we from its centre.
        assert pixel - 0.5 == pytest.approx(seen[0], abs=1e-6)


@pytest.mark.parametrize(
    ("lens", "coefficients", "name", "params"),
    [
        ("radtan", [-0.2, 0.05, 0.001, 0.002], "OPENCV", [-0.2, 0.05, 0.001, 0.002]),
        ("radtan", [-0.2, 0.05, 0.001, 0.002, 0], "OPENCV", [-0.2, 0.05, 0.001, 0.002]),
        (
            "radtan",
            [-0.2, 0.05, 0.001, 0.002, 0.01],
            "FULL_OPENCV",
            [-0.2, 0.05, 0.001, 0.002, 0.01, 0, 0, 0],
        ),
        ("radtan", [1, 2, 3, 4, 5, 6, 7, 8], "FULL_OPENCV", [1, 2, 3, 4, 5, 6, 7, 8]),
        ("fisheye", [0.1, 0.2, 0.3, 0.4], "OPENCV_FISHEYE", [0.1, 0.2, 0.3, 0.4]),
        ("fisheye", [], "OPENCV_FISHEYE", [0, 0, 0, 0]),
    ],
)
def test_colmap_cameras(lens: Any, coefficients: list[float], name: str, params: Any) -> None:
    camera = Camera(640, 480, CAMERA.matrix, np.array(coefficients, float), lens)
    (line,) = _model(camera)["cameras.txt"]
    assert line.split()[1] == name
    assert [float(value) for value in line.split()[8:]] == params


@pytest.mark.parametrize("form", ["colmap", "mcap"])
def test_what_is_missing_is_told_before_the_first_byte(form: str) -> None:
    with pytest.raises(SpecError) as caught:
        export(form, records())
    assert caught.value.error_code == "camera_required"


def test_unknown_forms_are_refused_by_name() -> None:
    with pytest.raises(NotFoundError, match="csv, jsonl, tum"):
        export("kml", records())


@pytest.mark.parametrize("form", FORMS)
def test_a_form_that_would_hold_nothing_is_refused_before_it_begins(form: str) -> None:
    failed = [records()[FAILED_AT]]
    track = VehicleTrack(np.arange(3.0), np.zeros((3, 3)), np.tile([1.0, 0, 0, 0], (3, 1)))
    options = ExportOptions(camera=CAMERA, vehicle=track)
    if form in ("csv", "jsonl", "mcap"):
        # These say of a failed frame why.
        assert b"".join(export(form, failed, options))
        return
    with pytest.raises(EmptyExportError, match="was written"):
        export(form, failed, options)


def test_long_flights_come_in_blocks() -> None:
    many = (record for _ in range(2000) for record in records())
    blocks = list(export("csv", many))
    assert len(blocks) > 10
    assert max(map(len, blocks)) < 80_000


def test_rotations_of_this_test_agree_with_opencv() -> None:
    turned, _ = cv2.Rodrigues(np.array([0.0, 0.0, np.pi / 2]))
    assert rotation([np.sqrt(0.5), 0, 0, np.sqrt(0.5)]) == pytest.approx(turned)


@pytest.mark.parametrize("estimate", ["frame", "filtered", "smoothed"])
def test_poses_are_told_apart_by_what_they_rest_on(estimate):
    told = [
        record | ({"estimate": estimate} if record["status"] == "ok" else {})
        for record in records()
    ]
    text = b"".join(export("tum", told)).decode()
    rest = {"frame": "alone", "filtered": "filtered", "smoothed": "smoothed"}[estimate]
    (line,) = [line for line in text.splitlines() if line.startswith("# poses")]
    assert rest in line
    rows = list(csv.DictReader(io.StringIO(b"".join(export("csv", told)).decode())))
    assert {row["estimate"] for row in rows} == {estimate, ""}
