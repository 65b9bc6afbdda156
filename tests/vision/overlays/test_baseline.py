"""Pictures of the paper's stages."""

import numpy as np
import pytest
from paper_frames import (
    frame_of,
    grid_lines,
    lattice_view,
    paper_camera,
    sample_pad,
    small_camera,
)

from padstudio.geometry.pose import look_at_pad
from padstudio.vision.baseline.line_grid import LineGrid, find_line_grid
from padstudio.vision.detector import Detector
from padstudio.vision.overlays import canvas, stages
from padstudio.vision.overlays.baseline import PAINTERS
from padstudio.vision.overlays.result import result_picture


@pytest.fixture(scope="module")
def near():
    detector = Detector(sample_pad(), paper_camera(), method="paper")
    detection = detector.detect(
        frame_of(look_at_pad(500.0, tilt_deg=12, heading_deg=50)), trace=True
    )
    assert detection.layer == "blue"
    return detection


@pytest.fixture(scope="module")
def far():
    detector = Detector(sample_pad(), paper_camera(), method="paper")
    detection = detector.detect(frame_of(look_at_pad(2600.0, tilt_deg=12)), trace=True)
    assert detection.layer == "outline"
    return detection


def count(picture, color):
    return int((np.abs(picture.astype(int) - color).max(axis=2) < 12).sum())


def test_the_two_families_are_drawn_in_two_colours(near):
    picture = stages.stage_picture(near.trace, "lines", "blue")
    assert count(picture, canvas.FIRST) > 500
    assert count(picture, canvas.SECOND) > 500


def test_the_window_and_its_centre_point_are_drawn_where_they_are(near):
    picture = stages.stage_picture(near.trace, "grid", "blue")
    window = near.trace.get("grid", "blue").output
    x, y = np.round(window.plane.from_frame(window.centre_xy[None])[0]).astype(int)
    np.testing.assert_array_equal(picture[y, x], canvas.WRONG)
    assert count(picture, canvas.RIGHT) > 500


@pytest.mark.parametrize("name", ["decode", "choose", "pose"])
def test_read_cells_are_marked_over_the_frame(near, name):
    picture = stages.stage_picture(near.trace, name, "blue" if name == "decode" else None)
    assert picture.shape[1] == stages.MAX_WIDTH
    assert count(picture, canvas.RIGHT) > 1000
    assert count(picture, canvas.WRONG) < 50


def test_edges_stand_out_of_their_dilation(near):
    picture = stages.stage_picture(near.trace, "edges", "blue")
    edges = near.trace.get("edges", "blue").output
    assert (picture[edges.thin > 0] == 255).all()
    dilated = (edges.mask > 0) & (edges.thin == 0)
    assert set(np.unique(picture[dilated])) == {85}


def test_the_outline_is_drawn_and_the_result_shows_axes(far, near):
    assert count(stages.stage_picture(far.trace, "outline"), canvas.RIGHT) > 500
    for detection in (far, near):
        result = result_picture(detection.trace, [detection])
        plain = canvas.fit(detection.trace.image, stages.MAX_WIDTH)
        assert result.shape == plain.shape
        assert (result != plain).any(axis=2).sum() > 2000


def test_inserted_lines_are_dashed():
    view = lattice_view(look_at_pad(600.0, tilt_deg=5), small_camera(), 40.0)
    columns = range(-5, 6), [-5, -4, -2, -1, 1, 2, 3, 4, 5]
    lit = []
    for numbers in columns:
        grid = find_line_grid(grid_lines(view, numbers, range(-4, 5)))
        picture = PAINTERS[LineGrid](None, grid, None).astype(int)
        lit.append(int((picture[:, :, 2] - picture[:, :, 0] > 40).sum()))
    # Two of eleven lines are missing, and every other dash of theirs.
    assert 0.82 * lit[0] < lit[1] < 0.97 * lit[0]
