"""Expected against read, with true poses, with corners, and with a pad that lies otherwise."""

from __future__ import annotations

import json

import numpy as np
import pytest
from dense_frames import random_pad
from paper_frames import frame_of, small_camera

from padstudio.geometry.pose import look_at_pad, rotation_angle_deg
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.layout import outline_mm
from padstudio.vision.cells.comparison import compare_cells, pose_of_corners
from padstudio.vision.frame.pyramid import Pyramid

CAMERA = small_camera()
POSE = look_at_pad(1900.0, tilt_deg=12, heading_deg=130)


def view(pad, pose=POSE):
    return Pyramid(frame_of(pose, pad=pad, camera=CAMERA))


@pytest.mark.parametrize("levels", [2, 4])
def test_thresholds_tell_the_levels_that_are_read(levels):
    pad = random_pad(3, levels=levels, cells=(25, 10), cell_mm=(40.0, 100.0))
    for found in compare_cells(view(pad), CAMERA, pad, POSE):
        cells = found.read.cells
        above = (cells.values[..., None] > found.thresholds).sum(axis=-1)
        differ = (above != found.levels) & cells.seen
        # Only where a value lies on a threshold may rounding decide.
        near = np.abs(cells.values[..., None] - found.thresholds).min(axis=-1)
        assert (near[differ] < 0.01).all()
        assert found.read.evidence.wrong < 0.03 * found.read.evidence.read


def test_the_answer_has_one_entry_a_seen_cell():
    pad = random_pad(3, cells=(25, 10), cell_mm=(40.0, 100.0))
    red, blue = (found.to_dict() for found in compare_cells(view(pad), CAMERA, pad, POSE))
    json.dumps([red, blue])
    assert len(red["x"]) == len(red["grey"]) == len(red["expected"]) == 25 * 25
    wrong = sum(a != b for a, b in zip(red["expected"], red["level"], strict=True))
    assert (wrong, len(red["x"])) == (red["wrong"], red["read"])
    row, column = blue["row"][7], blue["column"][7]
    assert blue["expected"][7] == pad.layers[1].field[row, column]


@pytest.mark.parametrize("turn", range(4))
@pytest.mark.parametrize("backwards", [False, True])
def test_corners_give_the_pose_in_any_order_of_the_clicks(turn, backwards):
    pad = random_pad(5, cells=(25, 10), cell_mm=(40.0, 100.0))
    corners = MovingPose(POSE).project(CAMERA, outline_mm(pad))
    clicked = np.roll(corners, turn, axis=0)[:: -1 if backwards else 1]
    clicked = clicked + np.random.default_rng(turn).normal(0, 0.5, (4, 2))
    found = pose_of_corners(view(pad), CAMERA, pad, clicked)
    assert rotation_angle_deg(found.rotation, POSE.rotation) < 3
    assert np.linalg.norm(found.position_mm - POSE.position_mm) < 60


def test_corners_on_a_line_give_none():
    pad = random_pad(5, cells=(25, 10), cell_mm=(40.0, 100.0))
    line = np.array([[100.0, 100.0], [200.0, 100.0], [300.0, 100.0], [400.0, 100.0]])
    assert pose_of_corners(view(pad), CAMERA, pad, line) is None
    # Nobody clicks a line to the last digit, nor a pad of three pixels.
    nearly = np.array([[100, 100.4], [200, 199.7], [300, 300.1], [400, 400]])
    tiny = np.array([[10.0, 10], [13, 10], [13, 13], [10, 13]])
    twice = np.array([[100.0, 100], [100, 100], [300, 300], [100, 300]])
    for corners in (nearly, tiny, twice):
        assert pose_of_corners(view(pad), CAMERA, pad, corners) is None


def test_a_mirrored_pad_is_told_by_its_cells():
    pad = random_pad(7, cells=(25, 10), cell_mm=(40.0, 100.0))
    straight = look_at_pad(1900.0)
    pyramid = Pyramid(np.ascontiguousarray(view(pad, straight).level(0)[:, ::-1]))
    for found in compare_cells(pyramid, CAMERA, pad, straight):
        best = max(found.fits, key=lambda fit: fit.share)
        assert (best.mirrored, best.quarter_turns) == (True, 0)
        assert best.share > 0.95
        assert found.fits[0].share < 0.7
