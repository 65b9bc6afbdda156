"""A camera calibrated from simulated pictures is the one that took them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from calibration_shots import (
    LENSES,
    charuco_board,
    charuco_camera,
    lens_error_px,
    poses_about,
    shots,
)
from dense_frames import random_pad

from padstudio.calibration.advice import findings, verdicts
from padstudio.calibration.calibrate import MOST_PICTURES, calibrate
from padstudio.errors import CalibrationError
from padstudio.geometry.camera import Camera
from padstudio.simulate.lay.relief import Relief, Wave
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render
from padstudio.simulate.sensor import Imaging

PAD, OTHER = (random_pad(seed, cells=(60, 12), cell_mm=(20.0, 100.0)) for seed in (3, 8))
SIDE_MM = max(PAD.size_mm)


@cache
def calibrated(lens: str):
    camera = LENSES[lens]
    return calibrate(PAD, shots(PAD, camera, poses_about(SIDE_MM, camera, 12, seed=1)))


def rms(values) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


@pytest.mark.parametrize("lens", LENSES)
def test_lens_is_nearer_than_charuco_of_the_same_poses(lens: str) -> None:
    camera = LENSES[lens]
    board, sheet = charuco_board(SIDE_MM)
    pictures = shots(sheet, camera, poses_about(SIDE_MM, camera, 12, seed=1))
    peer = charuco_camera(board, pictures, camera.model)
    found = calibrated(lens)
    assert found.camera.model == camera.model
    assert len(found.used) >= 11
    assert rms(lens_error_px(found.camera, camera)) < rms(lens_error_px(peer, camera))


@pytest.mark.parametrize("lens", LENSES)
def test_lens_is_within_its_stated_certainty(lens: str) -> None:
    true, found = LENSES[lens], calibrated(lens)
    places = [0, 1, 0, 1], [0, 1, 2, 2]
    off = (found.camera.matrix[places] - true.matrix[places]) / found.sigma.matrix
    coefficients = np.zeros(len(found.camera.distortion))
    coefficients[: len(true.distortion)] = true.distortion
    bends = (found.camera.distortion - coefficients) / found.sigma.distortion
    assert np.abs([*off, *bends]).max() < 4
    # Nor is it so unsure that this says nothing.
    sigma = found.sigma.picture_px
    assert rms(lens_error_px(found.camera, true)) > 0.2 * rms(sigma[np.isfinite(sigma)])
    assert rms(sigma[np.isfinite(sigma)]) < 1.0


def test_poses_are_those_of_the_pictures() -> None:
    camera = LENSES["straight"]
    true = poses_about(SIDE_MM, camera, 12, seed=1)
    for view, pose in zip(calibrated("straight").views, true, strict=True):
        assert view.pose is not None
        away = np.linalg.norm(view.pose.position_mm - pose.position_mm)
        assert away < 2e-3 * pose.range_mm


def test_a_picture_at_another_zoom_or_bent_is_left_out_or_told() -> None:
    camera = LENSES["straight"]
    poses = poses_about(SIDE_MM, camera, 9, seed=4)
    matrix = camera.matrix.copy()
    matrix[[0, 1], [0, 1]] *= 1.06
    zoomed = replace(camera, matrix=matrix, distortion=np.array([-0.08, 0, 0, 0]))
    pictures = [*shots(PAD, camera, poses[:8]), *shots(PAD, zoomed, poses[8:])]
    found = calibrate(PAD, pictures)
    states = [verdict.state for verdict in verdicts(found)]
    assert states[8] in ("contradicts", "rough")
    assert states[:8].count("good") >= 7
    assert rms(lens_error_px(found.camera, camera)) < 0.5


def test_pictures_without_the_pad_are_told_and_do_no_harm() -> None:
    camera = LENSES["straight"]
    poses = poses_about(SIDE_MM, camera, 8, seed=5)
    pictures = shots(PAD, camera, poses)
    bare = [
        np.full_like(pictures[0], 90),
        shots(OTHER, camera, poses[:1])[0],
    ]
    found = calibrate(PAD, [bare[0], *pictures, bare[1]])
    assert [view.is_used for view in found.views] == [False, *[True] * 8, False]
    told = verdicts(found)
    assert told[0].state == told[-1].state == "not_read"
    assert told[0].message.startswith("not read: ")
    assert rms(lens_error_px(found.camera, camera)) < 0.5


def test_what_is_missing_is_told() -> None:
    camera = LENSES["straight"]
    frontal = poses_about(SIDE_MM, camera, 4, seed=6, tilt_deg=6.0)
    codes = {finding.code for finding in findings(calibrate(PAD, shots(PAD, camera, frontal)))}
    assert {"few_pictures", "little_tilt"} <= codes
    assert not {"few_pictures", "little_tilt"} & {
        finding.code for finding in findings(calibrated("straight"))
    }


def test_the_part_of_the_picture_that_never_showed_the_pad_is_named() -> None:
    camera = LENSES["straight"]
    pictures = shots(PAD, camera, poses_about(0.6 * SIDE_MM, camera, 5, seed=7))
    for picture in pictures:
        picture[:, : 3 * camera.width // 10] = 128
    told = {finding.code: finding.message for finding in findings(calibrate(PAD, pictures))}
    assert "left" in told["unseen_parts"]


def test_progress_goes_up_to_the_end() -> None:
    told: list[tuple[int, int]] = []
    camera = LENSES["straight"]
    pictures = shots(PAD, camera, poses_about(SIDE_MM, camera, 3, seed=8), Imaging.ideal())
    calibrate(PAD, pictures, models=("radtan",), progress=lambda *step: told.append(step))
    done = [step[0] for step in told]
    assert done == sorted(done)
    assert told[-1][0] == told[-1][1]
    assert len({step[1] for step in told}) == 1


def test_what_tells_no_camera_is_refused() -> None:
    camera = LENSES["straight"]
    pictures = shots(PAD, camera, poses_about(SIDE_MM, camera, 3, seed=9))
    with pytest.raises(CalibrationError, match="2 pictures"):
        calibrate(PAD, pictures[:2])
    with pytest.raises(CalibrationError, match=f"{MOST_PICTURES + 1} pictures"):
        calibrate(PAD, pictures[:1] * (MOST_PICTURES + 1))
    with pytest.raises(CalibrationError, match=r"picture 2 is 540 x 960"):
        calibrate(PAD, [pictures[0], np.rot90(pictures[1]), pictures[2]])
    with pytest.raises(CalibrationError, match="read in 0 of 3 pictures"):
        calibrate(OTHER, pictures)


def test_the_camera_is_ready_for_use() -> None:
    again = Camera.loads(calibrated("bent").camera.to_ros_yaml())
    assert np.allclose(again.matrix, calibrated("bent").camera.matrix)
    assert np.allclose(again.distortion, calibrated("bent").camera.distortion)
    assert not again.nominal


def test_what_no_flat_pad_explains_is_told_and_makes_less_sure() -> None:
    camera = LENSES["straight"]
    bends = (Wave(amplitude_mm=4.0, length_mm=0.8 * SIDE_MM, toward_deg=30.0),)
    scene = Scene(pad=PAD, lay=Relief(bends=bends))
    poses = poses_about(SIDE_MM, camera, 8, seed=5)
    pictures = [render(scene, camera, pose, seed=k).image for k, pose in enumerate(poses)]
    found, flat = calibrate(PAD, pictures), calibrated("straight")
    assert "unexplained" in {finding.code for finding in findings(found)}
    assert "unexplained" not in {finding.code for finding in findings(flat)}
    assert found.excess > 2 > 1.2 > flat.excess
    sigma = rms(found.sigma.picture_px[np.isfinite(found.sigma.picture_px)])
    assert rms(lens_error_px(found.camera, camera)) < 2 * sigma
