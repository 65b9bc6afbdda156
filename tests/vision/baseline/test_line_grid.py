"""Numbering, misfits, missing lines: one fit for slope and spacing."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from paper_frames import grid_lines, lattice_view, small_camera

from padstudio.geometry.pose import look_at_pad
from padstudio.vision.baseline.line_grid import LineGrid, _places, find_line_grid
from padstudio.vision.stage.trace import Reason, StageFailure


def view_of(tilt_deg=30.0, heading_deg=20.0, towards_deg=60.0, height_mm=600.0):
    pose = look_at_pad(
        height_mm, tilt_deg=tilt_deg, heading_deg=heading_deg, tilt_towards_deg=towards_deg
    )
    return lattice_view(pose, small_camera(), 40.0)


def mapped(grid, view, lattice):
    """The found lattice coordinates of a true one."""
    h = grid.lattice_from_plane @ view @ (*lattice, 1.0)
    return h[:2] / h[2]


def off_whole(grid, view, points):
    """How far lattice points land from whole numbers of the found lattice."""
    at = np.array([mapped(grid, view, point) for point in points])
    return np.abs(at - np.round(at)).max()


@given(
    tilt_deg=st.floats(0, 45),
    heading_deg=st.floats(0, 360),
    towards_deg=st.floats(0, 360),
    noise_px=st.sampled_from([0.0, 0.15]),
)
def test_a_grid_is_found_from_every_side(tilt_deg, heading_deg, towards_deg, noise_px):
    view = view_of(tilt_deg, heading_deg, towards_deg)
    grid = find_line_grid(grid_lines(view, range(-5, 6), range(-4, 5), noise_px=noise_px))
    assert isinstance(grid, LineGrid)
    assert sorted([len(grid.columns.lines), len(grid.rows.lines)]) == [9, 11]
    assert not grid.columns.inserted.any()
    assert not grid.rows.inserted.any()
    points = np.array([(c, r) for c in (-5, 0, 5) for r in (-4, 0, 4)], float)
    assert off_whole(grid, view, points) < 0.05
    origin, right, down = (mapped(grid, view, xy) for xy in ((0, 0), (1, 0), (0, 1)))
    # Right-handed as the picture is: the map must not mirror.
    assert np.linalg.det(np.stack([right - origin, down - origin])) == pytest.approx(1, abs=0.1)


def test_missing_lines_are_inserted_where_they_are():
    view = view_of()
    columns, rows = [-5, -4, -1, 0, 1, 3, 4, 5], [-4, -3, -2, 0, 1, 2, 4]
    grid = find_line_grid(grid_lines(view, columns, rows, noise_px=0.1))
    missing = sorted([int(grid.columns.inserted.sum()), int(grid.rows.inserted.sum())])
    assert missing == [2, 3]
    assert sorted([len(grid.columns.lines), len(grid.rows.lines)]) == [9, 11]
    points = np.array([(c, r) for c in (-3, -2, 2) for r in (-1, 3)], float)
    assert off_whole(grid, view, points) < 0.05


def test_lines_that_cross_their_family_or_break_its_spacing_are_dropped():
    view = view_of(tilt_deg=10, heading_deg=0, towards_deg=0)
    lines = grid_lines(view, range(-5, 6), range(-4, 5))
    upright = np.flatnonzero(np.abs(lines.homogeneous[:, 0]) > 0.9)
    first = lines.ends[upright[0]]
    aside = np.array([18.0, 0.0])
    between = first + 0.7 * aside
    crossing = np.array([first[0] - aside, first[1] + aside])
    with_intruders = grid_lines(
        view, range(-5, 6), range(-4, 5), intruders=[between, crossing, [(30, 30), (600, 300)]]
    )
    grid = find_line_grid(with_intruders)
    dropped = with_intruders.ends[~grid.kept]
    assert len(dropped) == 3
    assert sorted([len(grid.columns.lines), len(grid.rows.lines)]) == [9, 11]


def test_evenly_spaced_noise_lines_do_not_stretch_a_grid_without_end():
    rng = np.random.default_rng(5)
    view = view_of(tilt_deg=0, heading_deg=0)
    random_lines = rng.uniform((0, 0), (639, 479), (60, 2, 2))
    found = find_line_grid(grid_lines(view, [0, 1], [0, 1], intruders=random_lines))
    if isinstance(found, LineGrid):
        assert len(found.columns.lines) < 60
        assert len(found.rows.lines) < 60
    else:
        assert found.reason is Reason.TOO_FEW_LINES


@pytest.mark.parametrize("rows", [[0], [0, 1]])
def test_too_few_lines_of_a_family_are_a_failure(rows):
    found = find_line_grid(grid_lines(view_of(), range(-5, 6), rows))
    assert isinstance(found, StageFailure)
    assert found.reason is Reason.TOO_FEW_LINES
    assert found.stage == "lines"


@pytest.mark.parametrize("axis", [0, 1])
def test_a_family_that_points_at_the_pictures_middle_has_places(axis):
    """Lines through (0, 0, 1), as of a camera that looks along the ground."""
    points = (np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0]))
    horizon = np.cross(*points)
    numbers = np.arange(-4, 5)
    other = np.cross(points[axis], horizon)
    lines = other + 0.1 * numbers[:, None] * horizon
    place = _places(3.0 * lines, points[axis], horizon)
    np.testing.assert_allclose(place, 0.1 * numbers, atol=1e-9)
