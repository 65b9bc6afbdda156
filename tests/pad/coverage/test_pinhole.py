"""What a pinhole camera shows of the ground, against rays met one by one."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from padstudio.errors import SpecError
from padstudio.pad.coverage.pinhole import View

PAPER_VIEW = View(width_px=2720, height_px=1530, focal_px=1886.0)


def test_the_papers_camera_sees_2_9_coarse_cells_at_18_cm():
    assert PAPER_VIEW.cells_across(50.0, 180.0) == pytest.approx(2.92, abs=0.005)


@pytest.mark.parametrize("tilt", [10.0, 35.0, 60.0])
def test_extent_and_cell_size_under_tilt_agree_with_rays(tilt):
    """Rays of the picture's middle lines, met with the ground one by one."""
    angle, height = math.radians(tilt), 700.0
    extents = []
    for along, across in ((2720, 1530), (1530, 2720)):
        edge = [math.atan(s * along / 2 / 1886.0) for s in (-1, 1)]
        if angle + edge[1] < math.pi / 2:
            near, far = (height * math.tan(angle + e) for e in edge)
            extents.append(far - near)
        extents.append(height / math.cos(angle) * across / 1886.0)
    assert PAPER_VIEW.cells_across(10.0, height, tilt) == pytest.approx(min(extents) / 10.0)
    step = math.atan((height * math.tan(angle) + 0.5) / height) - math.atan(
        (height * math.tan(angle) - 0.5) / height
    )
    along = 1886.0 * math.tan(step)
    across = 1886.0 / (height / math.cos(angle))
    width = PAPER_VIEW.cell_px(1.0, height, tilt)
    assert width == pytest.approx(math.sqrt(along * across), rel=1e-3)


def outline_px(side_mm, height_mm, tilt_deg, heading_deg):
    """Corners (4, 2) of a square round the optical axis, px from the picture's middle."""
    heading, tilt = np.radians([heading_deg, tilt_deg])
    turn = np.array([[np.cos(heading), -np.sin(heading)], [np.sin(heading), np.cos(heading)]])
    x, y = (np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * side_mm / 2 @ turn.T).T
    depth = height_mm / math.cos(tilt) + y * math.sin(tilt)
    return 1886.0 * np.column_stack([x, y * math.cos(tilt)]) / depth[:, None]


@given(side=st.floats(20, 3000), tilt=st.floats(0, 60))
def test_half_of_all_headings_show_the_whole_square(side, tilt):
    height = PAPER_VIEW.holds_from_mm(side, tilt)
    # The camera leans along the picture's shorter side here, so that the longer one has room.
    sides = [np.abs(outline_px(side, height, tilt, heading)) for heading in range(0, 90, 5)]
    held = [(each[:, 1] <= 765).all() and (each[:, 0] <= 1360).all() for each in sides]
    assert np.mean(held) >= 0.45
    if tilt == 0:
        assert np.mean(held) <= 0.55


@pytest.mark.parametrize("tilt", [0.0, 30.0, 55.0])
def test_the_shorter_side_of_a_square_lies_along_the_lean(tilt):
    small = outline_px(1.0, 900.0, tilt, 0.0)
    along = np.linalg.norm(small[2] + small[3] - small[0] - small[1]) / 2
    assert PAPER_VIEW.shorter_px(1.0, 900.0, tilt) == pytest.approx(along, rel=1e-3)


def test_refuses_what_is_no_view_or_tilt():
    with pytest.raises(SpecError, match="focal length"):
        View(width_px=100, height_px=100, focal_px=0.0)
    with pytest.raises(SpecError, match="0 … 89"):
        PAPER_VIEW.cells_across(10.0, 100.0, 90.0)
