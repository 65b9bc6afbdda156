"""The shoot-out's boards and readers agree: a rival is not judged by a misprint."""

import sys
from pathlib import Path

import numpy as np
import pytest

from padstudio import Camera
from padstudio.geometry.pose import look_at_pad, rotation_angle_deg
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render

sys.path.insert(0, str(Path(__file__).parent / "benchmarks"))
import shootout_boards
import shootout_readers

CAMERA = Camera(1360, 765, np.array([[943.0, 0, 679.5], [0, 943.0, 382], [0, 0, 1]]), np.zeros(5))


@pytest.mark.parametrize(
    ("sheet", "reader", "height_mm"),
    [
        (shootout_boards.aruco_sheet, shootout_readers.aruco_board, 700.0),
        (shootout_boards.single_sheet, shootout_readers.single_marker, 3000.0),
    ],
)
def test_a_rival_reads_its_board(sheet, reader, height_mm):
    pose = look_at_pad(
        height_mm, tilt_deg=15, heading_deg=40, tilt_towards_deg=70, target_mm=(60, -25)
    )
    frame = render(Scene(pad=None, sheet=sheet()), CAMERA, pose, seed=1)
    found = reader(CAMERA)(frame.image)
    assert np.linalg.norm(found.position_mm - pose.position_mm) < 0.01 * height_mm
    assert rotation_angle_deg(found.rotation, pose.rotation) < 0.5
