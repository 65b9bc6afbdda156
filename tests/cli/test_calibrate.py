"""``padstudio calibrate`` from stills and from a clip."""

from __future__ import annotations

import json

import cv2
import numpy as np
import pytest
from calibration_shots import LENSES, lens_error_px, poses_about, shots
from dense_frames import random_pad
from typer.testing import CliRunner
from videos import write

from padstudio.cli.program import app
from padstudio.geometry.camera import Camera

PAD = random_pad(3, cells=(60, 12), cell_mm=(20.0, 100.0))
CAMERA = LENSES["straight"]


@pytest.fixture(scope="module")
def pictures():
    return shots(PAD, CAMERA, poses_about(1200.0, CAMERA, 6, seed=1))


@pytest.fixture
def folder(tmp_path, pictures):
    PAD.save(tmp_path / "pad.json")
    (tmp_path / "stills").mkdir()
    for number, picture in enumerate(pictures):
        cv2.imwrite(str(tmp_path / "stills" / f"{number}.png"), picture)
    return tmp_path


def run(folder, *words):
    options = ["--pad", str(folder / "pad.json"), "-o", str(folder / "camera.yaml")]
    return CliRunner().invoke(app, ["calibrate", *map(str, words), *options])


def test_stills_give_a_camera_file_and_a_report(folder) -> None:
    report = folder / "report.json"
    done = run(folder, folder / "stills", "--lens", "radtan", "--report", report)
    assert done.exit_code == 0, done.output
    assert "6 of 6 pictures used" in done.output
    camera = Camera.load(folder / "camera.yaml")
    assert np.sqrt(np.mean(lens_error_px(camera, CAMERA) ** 2)) < 0.5
    assert camera.name == "camera"
    said = json.loads(report.read_text())
    assert [each["name"] for each in said["pictures"]] == [f"{k}.png" for k in range(6)]
    assert said["intrinsics"][0]["value"] == pytest.approx(camera.matrix[0, 0])


def test_of_a_clip_the_sharpest_frames_are_taken(folder, pictures) -> None:
    soft = [cv2.GaussianBlur(picture, (0, 0), 4.0) for picture in pictures]
    # 24 pictures of a clip: of 120 frames each fifth; the sharp one stands at no fixed place.
    frames = []
    for number in range(24):
        group = [soft[number % 6]] * 5
        group[number % 5] = pictures[number % 6]
        frames += group
    size = (CAMERA.width, CAMERA.height)
    write(folder / "clip.mp4", len(frames), size=size, paint=lambda number, *_: frames[number])
    report = folder / "report.json"
    done = run(folder, folder / "clip.mp4", "--lens", "radtan", "--report", report)
    assert done.exit_code == 0, done.output
    names = [each["name"] for each in json.loads(report.read_text())["pictures"]]
    assert names == [f"clip.mp4 #{5 * number + number % 5}" for number in range(24)]


def test_nothing_is_written_where_the_pad_is_not_seen(folder) -> None:
    for number in range(6):
        cv2.imwrite(str(folder / "stills" / f"{number}.png"), np.full((540, 960, 3), 90, np.uint8))
    done = run(folder, folder / "stills")
    assert done.exit_code == 2
    assert "no_calibration" in done.output
    assert not (folder / "camera.yaml").exists()


def test_a_camera_file_is_not_written_over(folder) -> None:
    (folder / "camera.yaml").write_text("mine")
    done = run(folder, folder / "stills")
    assert done.exit_code == 2
    assert (folder / "camera.yaml").read_text() == "mine"
