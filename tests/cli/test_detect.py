import json
import subprocess
import sys
from pathlib import Path

import pytest
import recordings
from command_line import assert_one_line_error, run
from places import ROOT

from padstudio.flights import batch
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import look_at_pad
from padstudio.pad.identity import pad_id
from padstudio.vision.stage.detection import Detection
from padstudio.vision.stage.trace import Reason, StageFailure

SAMPLES = ROOT / "samples"
GIVEN = ("--pad", SAMPLES / "pad.json", "--camera", SAMPLES / "camera.yaml")


class BrightnessDetector:
    """Answers by the picture's mean, so that every branch can be asked for."""

    def detect(self, bgr):
        if bgr.mean() < 1:
            failure = StageFailure("stretch", Reason.UNDEREXPOSED, "all dark", "more light")
            return Detection(None, failure, elapsed_ms={"total": 2.0})
        if bgr.mean() > 254:
            raise ZeroDivisionError
        return Detection(look_at_pad(500), layer="red", cells_read=40, elapsed_ms={"total": 3.0})


@pytest.fixture
def frames(tmp_path, monkeypatch):
    """A folder of a bright, a dark, a grey, and a damaged picture, and a fake detector."""
    import cv2
    import numpy as np

    monkeypatch.setattr(batch, "detector_for", lambda _: BrightnessDetector())
    for name, value in (("f2", 0), ("f10", 128), ("f1", 255)):
        cv2.imwrite(str(tmp_path / f"{name}.png"), np.full((45, 80, 3), value, np.uint8))
    (tmp_path / "f3.jpg").write_bytes((tmp_path / "f2.png").read_bytes()[:90])
    (tmp_path / "notes.txt").write_text("no frame")
    return tmp_path


def detect(*arguments):
    return run("detect", *GIVEN, *arguments)


def records(text):
    return [json.loads(line) for line in text.splitlines()]


def test_every_picture_of_a_folder_gives_a_line_in_order(frames):
    result = detect(frames, "--jobs", "1")
    lines = records(result.stdout)
    assert [Path(line["source"]).name for line in lines] == [
        "f1.png",
        "f2.png",
        "f3.jpg",
        "f10.png",
    ]
    assert [line["status"] for line in lines] == ["failed", "failed", "failed", "ok"]
    assert [(line["stage"], line["reason"]) for line in lines[:3]] == [
        ("read", "internal_error"),
        ("stretch", "underexposed"),
        ("read", "truncated_image"),
    ]
    assert lines[3]["position_mm"] == [0, 0, 500]
    assert all({"source", "frame", "time_s", "elapsed_ms"} <= set(line) for line in lines)
    assert result.exit_code == 0


def test_frames_that_cannot_be_read_are_named_on_stderr(frames):
    errors = [
        line for line in detect(frames, "-j", "1", "-q").stderr.splitlines() if "error:" in line
    ]
    assert len(errors) == 2
    assert "f1.png: a defect of the program: ZeroDivisionError()" in errors[0]
    assert "f3.jpg" in errors[1]
    assert errors[1].endswith("(truncated_image)")


def test_the_summary_counts_outcomes(frames):
    summary = detect(frames, "-j", "1").stderr
    assert "pose by red" in summary
    assert "failed at stretch" in summary
    assert "25.0 %" in summary
    # Of 2 ms and 3 ms.
    assert "median 2 ms a frame" in summary
    assert "failed at stretch" not in detect(frames, "-j", "1", "--quiet").stderr


def test_a_poses_file(frames):
    path = frames / "poses.jsonl"
    result = detect(frames / "f10.png", "-o", path, "-j", "1")
    assert (result.exit_code, result.stdout) == (0, "")
    assert len(records(path.read_text(encoding="utf-8"))) == 1
    assert_one_line_error(detect(frames / "f10.png", "-o", path), "file_exists")
    assert detect(frames / "f2.png", "-o", path, "-j", "1", "--force").exit_code == 1
    assert records(path.read_text(encoding="utf-8"))[0]["status"] == "failed"


def test_a_run_that_was_broken_off_goes_on(frames):
    path = frames / "poses.jsonl"
    whole = detect(frames, "-o", path, "-j", "1")
    text = path.read_text(encoding="utf-8")
    lines = text.splitlines(keepends=True)
    # Killed while it wrote the third line.
    path.write_text("".join(lines[:2]) + lines[2][:50], encoding="utf-8")
    resumed = detect(frames, "-o", path, "-j", "1", "--resume")
    assert path.read_text(encoding="utf-8") == text
    assert [line for line in resumed.stderr.splitlines() if "f1.png" in line] == []
    assert whole.stderr.endswith(resumed.stderr[resumed.stderr.index("┏") :])
    assert detect(frames, "-o", path, "-j", "1", "--resume").exit_code == 0
    assert path.read_text(encoding="utf-8") == text


def test_resume_begins_where_there_is_nothing(frames):
    path = frames / "poses.jsonl"
    assert detect(frames / "f10.png", "-o", path, "-j", "1", "--resume").exit_code == 0
    assert len(records(path.read_text(encoding="utf-8"))) == 1


def test_resume_leaves_other_files_alone(frames):
    for text in ('{"format": "padstudio.pad"}', "a,b\n1,2\n"):
        path = frames / "other"
        path.write_text(text)
        result = detect(frames / "f10.png", "-o", path, "-j", "1", "--resume")
        assert_one_line_error(result, "invalid_poses_file")
        assert path.read_text() == text


def test_resume_takes_the_arguments_of_the_first_run(frames):
    path = frames / "poses.jsonl"
    assert detect(frames, "-o", path, "-j", "1").exit_code == 0
    before = path.read_text(encoding="utf-8")
    result = detect(frames / "f10.png", "-o", path, "-j", "1", "--resume")
    assert_one_line_error(result, "another_run")
    assert path.read_text(encoding="utf-8") == before


@pytest.mark.parametrize("more", [(), ("-o", "x.jsonl", "--force")])
def test_resume_needs_a_file(more):
    assert_one_line_error(detect(SAMPLES, "--resume", *more), "usage")


def test_videos_and_stills_side_by_side(tmp_path):
    footage = ROOT / "tests" / "footage"
    landing = footage / "flights" / "landing.mp4"
    given = ("--pad", footage / "pad_a.json", "--camera", footage / "camera_drone_2k7.yaml")
    path = tmp_path / "poses.jsonl"
    arguments = ("detect", *given, landing, SAMPLES / "truth.json", "--stride", "30", "-j", "1")
    result = run(*arguments, "-o", path, "--no-apply-rotation")
    found = records(path.read_text(encoding="utf-8"))
    assert [(line["frame"], line["status"]) for line in found] == [
        (0, "ok"),
        (30, "ok"),
        (60, "failed"),
    ]
    assert found[1]["time_s"] == pytest.approx(1.0, abs=1e-6)
    assert "66.7 %" in result.stderr


def test_no_pose_at_all_is_exit_code_1(frames):
    assert detect(frames / "f2.png", "-j", "1").exit_code == 1


def test_a_preset_is_told_to_be_nominal(frames):
    result = run(
        *("detect", "--pad", SAMPLES / "pad.json", "--camera", "preset-dji-mini-27k"),
        *(frames / "f10.png", "-j", "1"),
    )
    assert result.stderr.startswith("camera DJI Mini 2, 2.7K video: nominal, calibrate")


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (("gone.jpg",), "no_such_file"),
        (("gone/*.jpg",), "no_such_file"),
        (("x.jpg", "--method", "magic"), "usage"),
        ((SAMPLES / "height_450mm.jpg", "--topic", "/image"), "usage"),
        (("x.jpg", "--jobs", "-1"), "usage"),
        ((), "usage"),
    ],
)
def test_wrong_arguments_are_one_line(arguments, code):
    assert_one_line_error(detect(*arguments), code)


@pytest.mark.parametrize(
    ("option", "value", "code"),
    [
        ("--pad", "gone.json", "invalid_pad_file"),
        ("--pad", SAMPLES / "camera.yaml", "invalid_pad_file"),
        ("--camera", "gone.yaml", "invalid_camera_file"),
        ("--camera", SAMPLES / "truth.json", "invalid_camera_file"),
        ("--camera", "preset-of-nobody", "not_found"),
    ],
)
def test_wrong_files_are_one_line(option, value, code):
    assert_one_line_error(detect(SAMPLES, option, value), code)


def test_a_frame_of_another_aspect_is_named(tmp_path):
    import cv2
    import numpy as np

    path = tmp_path / "square.png"
    cv2.imwrite(str(path), np.zeros((300, 300, 3), np.uint8))
    line = records(detect(path, "-j", "1").stdout)[0]
    assert (line["stage"], line["reason"]) == ("read", "camera_size_mismatch")


def test_a_reader_that_goes_away_is_no_error():
    program = Path(sys.executable).with_name("padstudio")
    command = [program, "detect", *GIVEN, SAMPLES / "truth.json", "-j", "1", "-q"]
    with subprocess.Popen(
        list(map(str, command)), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        process.stdout.close()
        errors = process.stderr.read()
    assert (process.returncode, errors) == (1, "")


@pytest.fixture
def two_pads(tmp_path):
    """The sample pad's file, another one's, and a still that shows both; with the camera's file."""
    import cv2
    from dense_frames import random_pad

    from padstudio.geometry.camera import Camera
    from padstudio.pad.spec import Pad
    from padstudio.simulate.radiance.scene import Neighbour, Scene
    from padstudio.simulate.render import render

    sample, other = Pad.load(SAMPLES / "pad.json"), random_pad(7, cells=(60, 12))
    other.save(tmp_path / "other.json")
    scene = Scene(pad=sample, neighbours=(Neighbour(pad=other, x_mm=1000.0, y_mm=0.0),))
    pose = look_at_pad(1600.0, tilt_deg=8, target_mm=(350.0, 0.0))
    camera = Camera.load(SAMPLES / "camera.yaml")
    camera = camera.for_frame(camera.width // 2, camera.height // 2)
    cv2.imwrite(str(tmp_path / "both.png"), render(scene, camera, pose).image)
    return tmp_path, (pad_id(sample), pad_id(other))


def test_several_pads_give_a_line_each(two_pads):
    folder, ids = two_pads
    poses = folder / "poses.jsonl"
    result = detect("--pad", folder / "other.json", folder / "both.png", "-j", "1", "-o", poses)
    assert result.exit_code == 0
    lines = records(poses.read_text())
    assert {line["pad_id"] for line in lines} == set(ids)
    assert {line["source"] for line in lines} == {(folder / "both.png").as_posix()}
    # Each pose is in its own pad's frame, so a trajectory of one pad does not hold them.
    assert "pad_id" in run("export", poses, "--form", "csv").stdout.splitlines()[0]
    assert_one_line_error(run("export", poses, "--form", "tum"), "several_pads")
    chosen = run("export", poses, "--form", "tum", "--pad-id", ids[1]).stdout
    assert len([line for line in chosen.splitlines() if not line.startswith("#")]) == 1
    unknown = run("export", poses, "--form", "tum", "--pad-id", "NOSUCHPD")
    assert_one_line_error(unknown, "unknown_pad")


def test_pads_that_cannot_be_told_apart_leave_no_file(tmp_path):
    poses = tmp_path / "poses.jsonl"
    arguments = ("--pad", SAMPLES / "pad.json", SAMPLES / "height_450mm.jpg", "-o", poses)
    assert_one_line_error(detect(*arguments), "pads_alike")
    assert not poses.exists()


def test_two_processes_give_what_one_gives():
    pictures = [SAMPLES / "height_450mm.jpg", SAMPLES / "truth.json", SAMPLES / "height_150mm.jpg"]
    alone = records(detect(*pictures, "-j", "1", "-q").stdout)
    shared = records(detect(*pictures, "-j", "2", "-q").stdout)
    assert [line["status"] for line in alone] == ["ok", "failed", "ok"]
    for one, other in zip(alone, shared, strict=True):
        assert [one[key] for key in ("source", "status")] == [
            other[key] for key in ("source", "status")
        ]
        if one["status"] == "ok":
            # Sums of parallel code differ in their last digits from run to run.
            assert other["position_mm"] == pytest.approx(one["position_mm"], rel=1e-9)
            assert other["cells_read"] == one["cells_read"]


def test_a_recording_brings_its_camera(tmp_path):
    matrix = [[200.0, 0, 96], [0, 200, 64], [0, 0, 1]]
    camera = Camera(recordings.videos.WIDTH, recordings.videos.HEIGHT, matrix)
    scene = recordings.Scene(recordings.shots(2), camera=camera)
    bag = recordings.write_bag1(tmp_path / "a.bag", scene)
    result = run("detect", "--pad", SAMPLES / "pad.json", "-q", bag)
    assert "camera cam: the calibration in the recording" in result.stderr
    lines = [json.loads(line) for line in result.stdout.splitlines()]
    assert [line["topic"] for line in lines] == [recordings.TOPIC] * 2
    assert [line["stage"] == "read" for line in lines] == [False, False]


def test_a_recording_without_a_camera_or_with_several_topics(tmp_path):
    scene = recordings.Scene(recordings.shots(2), "compressed", topics=("/a/image", "/b/image"))
    path = recordings.write_mcap(tmp_path / "a.mcap", scene)
    pad = ("--pad", SAMPLES / "pad.json")
    assert_one_line_error(run("detect", *pad, path), "several_topics")
    assert_one_line_error(run("detect", *pad, "--topic", "/a/image", path), "camera_required")
    assert_one_line_error(run("detect", *pad, SAMPLES / "height_1300mm.jpg"), "usage")
    assert_one_line_error(run("detect", *pad, "--no-distortion", path), "usage")
    result = run("detect", *GIVEN, path)
    (line,) = (json.loads(line) for line in result.stdout.splitlines())
    assert (line["stage"], line["reason"]) == ("read", "several_topics")
