"""Boards and their readers agree: no board loses by a misprint."""

from __future__ import annotations

import numpy as np
import pytest

from padstudio import Camera
from padstudio.experiments.shootout import reading
from padstudio.experiments.shootout.boards.catalogue import BOARDS
from padstudio.experiments.shootout.boards.sheets import Page
from padstudio.experiments.shootout.reader_process import ReaderProcess
from padstudio.geometry.pose import look_at_pad, rotation_angle_deg
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render

CAMERA = Camera(680, 382, np.array([[471.0, 0, 339.5], [0, 471.0, 190.5], [0, 0, 1]]), np.zeros(5))
#: Wider than high, and no whole number of the boards' places high.
PAGE = Page(1250.0, 990.0)
#: From where a board is read; nested ones also where their outermost marker is not in view.
HEIGHTS_MM = {
    "aruco-board": [400.0],
    "aruco-single": [3000.0],
    "aruco-nested": [3000.0, 280.0],
    "charuco": [400.0],
    "apriltag-nested": [3000.0, 280.0],
    "puzzleboard": [300.0],
    "puzzleboard-fine": [150.0],
}


@pytest.mark.parametrize("board", BOARDS)
def test_a_board_is_read_as_it_is_printed(board: str) -> None:
    if BOARDS[board].missing:
        pytest.skip(f"{BOARDS[board].missing} is not installed")
    with ReaderProcess() as process:
        sheet = process.call(60, reading.print_board, board, PAGE)
        assert (sheet.page_width_mm, sheet.page_height_mm) == (PAGE.width_mm, PAGE.height_mm)
        for height_mm in HEIGHTS_MM.get(board, [3000.0]):
            pose = look_at_pad(
                height_mm, tilt_deg=15, heading_deg=40, tilt_towards_deg=70, target_mm=(6, -5)
            )
            frame = render(Scene(pad=None, sheet=sheet), CAMERA, pose, seed=1)
            for setting in (reading.FAST, reading.THOROUGH):
                process.call(60, reading.prepare, board, setting, PAGE, CAMERA, frame.encoded)
                found = process.call(60, reading.read, frame.encoded, False).pose
                assert np.linalg.norm(found.position_mm - pose.position_mm) < 0.02 * height_mm
                assert rotation_angle_deg(found.rotation, pose.rotation) < 1.5


def test_places_fit_on_any_page() -> None:
    assert Page(1250.0, 990.0).places(25) == (25, 19, 50.0)
    assert Page(300.0, 600.0).places(25) == (12, 25, 24.0)


def test_a_board_without_its_reader_says_what_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    assert BOARDS["apriltag-36h11"].missing == "pupil-apriltags"
    assert BOARDS["charuco"].missing is None
