import io
import json
import shutil
import zipfile
from pathlib import Path

import cv2
import numpy as np
import pytest
from command_line import assert_one_line_error, run
from mcap.reader import make_reader
from places import ROOT

from padstudio.geometry.pose import look_at_pad
from padstudio.vision.stage.detection import Detection, Uncertainty
from padstudio.vision.stage.trace import Reason, StageFailure

SAMPLES = ROOT / "samples"
LANDING = ROOT / "tests" / "footage" / "flights" / "landing.mp4"
HEIGHTS = (900.0, 700.0, 500.0)
FRAME_PX = (2720, 1530)


def full(height):
    pose = look_at_pad(height)
    sigma = Uncertainty.of(pose, 1e-6 * np.eye(6))
    return Detection(pose, layer="red", uncertainty=sigma, frame_px=FRAME_PX)


@pytest.fixture
def poses(tmp_path, monkeypatch):
    """A poses file of a failed frame and three full poses, in the working folder."""
    monkeypatch.chdir(tmp_path)
    failure = StageFailure("lines", Reason.NO_LATTICE, "3 lines", "go closer")
    found = [Detection(None, failure, frame_px=FRAME_PX)]
    found += [full(height) for height in HEIGHTS]
    lines = [
        json.dumps(detection.to_record("landing.mp4", frame=2 * k, time_s=k / 15))
        for k, detection in enumerate(found)
    ]
    path = tmp_path / "poses.jsonl"
    path.write_text("\n".join(lines) + "\n")
    return path


def export(*arguments):
    return run("export", *arguments)


def test_a_trajectory_goes_to_stdout(poses):
    result = export(poses, "--form", "tum", "--start-unix-s", "100")
    table = np.loadtxt(io.StringIO(result.stdout))
    assert (table[:, 3] * 1000).tolist() == pytest.approx(HEIGHTS)
    assert table[0, 0] == pytest.approx(100 + 1 / 15, abs=1e-6)


@pytest.mark.parametrize(
    "option",
    [
        ("--start-unix-s", "inf"),
        ("--start-unix-s", "nan"),
        ("--turned-deg", "inf"),
        ("--down-m", "nan"),
        ("--forward-m", "101"),
    ],
)
def test_numbers_that_are_none_are_refused(poses, option):
    assert_one_line_error(export(poses, "--form", "ardupilot", *option), "usage")


def test_a_file_without_frames_and_two_in_one_are_refused(poses):
    twice = Path("twice.jsonl")
    twice.write_text(2 * poses.read_text())
    for form in ("tum", "mcap", "ros2", "ardupilot"):
        assert_one_line_error(export(twice, "--form", form, "-o", "x"), "several_clocks")
    twice.write_text("")
    for form in ("csv", "jsonl", "tum"):
        assert_one_line_error(export(twice, "--form", form, "-o", "x"), "empty_export")
    assert not Path("x").exists()


def test_what_a_form_leaves_out_is_said(poses):
    lines = [json.loads(line) for line in poses.read_text().splitlines()]
    lines[1] |= {"quality": "bearing"}
    lines[2] |= {"quality": None}
    poses.write_text("\n".join(map(json.dumps, lines)))
    result = export(poses, "--form", "tum")
    assert len(np.atleast_2d(np.loadtxt(io.StringIO(result.stdout)))) == 1
    assert "1 pose of quality bearing is left out" in result.stderr
    assert "1 pose of unknown quality is left out" in result.stderr
    assert "left out" not in export(poses, "--form", "csv").stderr


def test_a_model_goes_to_a_file(poses):
    result = export(poses, "--form", "colmap", "--camera", SAMPLES / "camera.yaml", "-o", "a.zip")
    assert "a.zip: 4 frames as colmap" in result.stderr
    with zipfile.ZipFile("a.zip") as archive:
        assert "landing/000002.png" in archive.read("images.txt").decode()
    again = export(poses, "--form", "csv", "-o", "a.zip")
    assert_one_line_error(again, "file_exists")
    assert export(poses, "--form", "csv", "-o", "a.zip", "--force").exit_code == 0
    assert Path("a.zip").read_text().startswith("source,frame")


def test_frames_of_a_video_go_into_a_log(poses):
    shutil.copy(LANDING, "landing.mp4")
    camera = ROOT / "tests" / "footage" / "camera_drone_2k7.yaml"
    arguments = ("--camera", camera, "--pad", SAMPLES / "pad.json", "--images", "-o", "a.mcap")
    assert export(poses, "--form", "mcap", *arguments).exit_code == 0
    with open("a.mcap", "rb") as file:
        found = [
            (json.loads(message.data), message.log_time)
            for _, _, message in make_reader(file).iter_messages(topics=["/camera/image"])
        ]
    assert [time for _, time in found] == [round(k / 15 * 1e9) for k in range(4)]
    assert {message["format"] for message, _ in found} == {"jpeg"}
    assert len({message["data"] for message, _ in found}) == 4


def test_stills_go_into_a_log_as_far_as_they_are_there(poses):
    cv2.imwrite("a.png", np.zeros((18, 32, 3), np.uint8))
    names = ("a.png", "missing.png")
    lines = [full(500.0).to_record(name) for name in names]
    poses.write_text("\n".join(map(json.dumps, lines)))
    arguments = ("--form", "mcap", "--camera", SAMPLES / "camera.yaml", "--images")
    assert export(poses, *arguments, "-o", "a.mcap").exit_code == 0
    with open("a.mcap", "rb") as file:
        topics = [channel.topic for _, channel, _ in make_reader(file).iter_messages()]
    assert (topics.count("/camera/image"), topics.count("/tf")) == (1, 2)


def test_landing_targets(poses):
    assert_one_line_error(export(poses, "--form", "px4"), "vehicle_pose_required")
    sparse = Path("sparse.csv")
    sparse.write_text(
        "time_s,north_m,east_m,down_m,qw,qx,qy,qz\n0,0,0,-3,1,0,0,0\n1,9,0,-3,1,0,0,0\n"
    )
    arguments = ("--form", "px4", "--vehicle", sparse, "-o", "none.tlog")
    assert_one_line_error(export(poses, *arguments), "empty_export")
    assert not Path("none.tlog").exists()
    track = "time_s,north_m,east_m,down_m,qw,qx,qy,qz\n0,0,0,-1,1,0,0,0\n0.3,0,0,-1,1,0,0,0\n"
    Path("v.csv").write_text(track)
    arguments = ("--vehicle", "v.csv", "--forward-m", "0.1", "-o", "a.tlog")
    assert export(poses, "--form", "px4", *arguments).exit_code == 0
    assert Path("a.tlog").stat().st_size > 100


def test_a_fault_in_the_last_line_leaves_no_file(poses):
    with poses.open("a") as file:
        file.write("{}\n")
    result = export(poses, "--form", "csv", "-o", "a.csv")
    assert_one_line_error(result, "invalid_poses_file")
    assert not Path("a.csv").exists()


def test_what_is_not_there(poses):
    assert_one_line_error(export("no.jsonl", "--form", "csv"), "os_error")
    assert_one_line_error(export(poses, "--form", "kml"), "usage")
    assert_one_line_error(export(poses, "--form", "mcap"), "camera_required")


def test_the_size_of_frames_is_told_or_refused(poses):
    lines = [json.loads(line) for line in poses.read_text().splitlines()]
    for line in lines:
        del line["frame_px"]
    poses.write_text("\n".join(map(json.dumps, lines)))
    arguments = ("--form", "colmap", "--camera", SAMPLES / "camera.yaml", "-o", "a.zip")
    assert_one_line_error(export(poses, *arguments), "frame_size_unknown")
    assert not Path("a.zip").exists()
    assert_one_line_error(export(poses, *arguments, "--frame-size", "2720"), "usage")
    assert export(poses, *arguments, "--frame-size", "680x382").exit_code == 0
    with zipfile.ZipFile("a.zip") as archive:
        assert "1 PINHOLE 680 382 " in archive.read("cameras.txt").decode()
    # Or the file itself tells.
    shutil.copy(LANDING, "landing.mp4")
    assert export(poses, *arguments, "--force").exit_code == 0
    with zipfile.ZipFile("a.zip") as archive:
        assert "1 PINHOLE 2720 1530 " in archive.read("cameras.txt").decode()


def test_what_was_put_on_one_clock_is_said(poses):
    text = poses.read_text()
    poses.write_text(text + text.replace("landing.mp4", "two/landing.mp4"))
    result = export(poses, "--form", "tum")
    table = np.loadtxt(io.StringIO(result.stdout))
    assert (np.diff(table[:, 0]) > 0).all()
    assert "the times of two/landing.mp4 begin again" in result.stderr
    track = "time_s,north_m,east_m,down_m,qw,qx,qy,qz\n0,0,0,-1,1,0,0,0\n0.3,0,0,-1,1,0,0,0\n"
    Path("v.csv").write_text(track)
    matched = export(poses, "--form", "px4", "--vehicle", "v.csv")
    assert_one_line_error(matched, "several_clocks")


def test_pictures_that_are_not_there_are_counted(poses):
    arguments = ("--form", "mcap", "--camera", SAMPLES / "camera.yaml", "--images", "-o", "a.mcap")
    assert "4 frames are without a picture" in export(poses, *arguments).stderr
