"""The even and odd rule, the centre point, the central window."""

import numpy as np
import pytest
from paper_frames import edge_map, grid_lines, lattice_view, small_camera

from padstudio.geometry.pose import look_at_pad
from padstudio.vision.baseline.central_window import CentralWindow, central_window
from padstudio.vision.baseline.hough import Lines
from padstudio.vision.baseline.line_grid import Family, LineGrid, find_line_grid
from padstudio.vision.stage.trace import Reason, StageFailure

PITCH = 40.0


def upright_grid(columns, rows):
    """A grid parallel to the picture: column k at x = 40 k, row k at y = 40 k."""
    x = [(1.0, 0.0, -PITCH * k) for k in range(columns)]
    y = [(0.0, 1.0, -PITCH * k) for k in range(rows)]
    families = [Family(0, np.array(lines), np.zeros(len(lines), bool)) for lines in (x, y)]
    nothing = Lines(np.zeros((0, 2, 2)), np.zeros(0), np.zeros((0, 2, 2)), edge_map())
    to_lattice = np.diag([1 / PITCH, 1 / PITCH, 1.0])
    return LineGrid(families[0], families[1], to_lattice, 0.1, nothing, np.zeros(0, bool))


@pytest.mark.parametrize(
    ("columns", "rows", "centre", "start"),
    [
        (8, 8, (3.5, 3.5), (1, 1)),  # even: between the middle two, the window about them
        (7, 9, (3.0, 4.0), (0, 1)),  # odd: on the middle one, the window half a cell before it
        (6, 7, (2.5, 3.0), (0, 0)),
    ],
)
def test_even_and_odd_rule(columns, rows, centre, start):
    window = central_window(upright_grid(columns, rows), 5)
    np.testing.assert_allclose(window.centre_xy, PITCH * np.array(centre), atol=1e-9)
    assert (window.column, window.row) == start
    corners = PITCH * (np.array([[0, 0], [5, 0], [5, 5], [0, 5]]) + start)
    np.testing.assert_allclose(window.corners_xy, corners, atol=1e-9)
    assert window.area_px == pytest.approx((5 * PITCH) ** 2)
    assert window.cell_px == pytest.approx(PITCH)


@pytest.mark.parametrize("size", [2, 3, 4, 7])
def test_any_window_size(size):
    window = central_window(upright_grid(8, 8), size)
    middle = np.array([window.column, window.row]) + size / 2
    assert np.abs(middle - 3.5).max() <= 0.5
    assert window.size == size


def test_too_few_lines_for_a_window_say_so():
    found = central_window(upright_grid(6, 5), 5)
    assert isinstance(found, StageFailure)
    assert found.reason is Reason.CELLS_TOO_LARGE
    assert "6 x 5 lines" in found.detail
    assert found.advice


def test_window_of_a_tilted_view_lies_where_the_truth_has_it():
    pose = look_at_pad(700.0, tilt_deg=35, heading_deg=30, tilt_towards_deg=100)
    view = lattice_view(pose, small_camera(), 40.0)
    grid = find_line_grid(grid_lines(view, range(-4, 6), range(-3, 5)))
    window = central_window(grid, 5)
    assert isinstance(window, CentralWindow)
    corner = window.corners_xy
    h = np.column_stack([corner, np.ones(4)]) @ np.linalg.inv(view).T
    lattice = h[:, :2] / h[:, 2:]
    np.testing.assert_allclose(lattice, np.round(lattice), atol=0.02)
    middle = lattice.mean(axis=0)
    assert np.abs(middle - (0.5, 0.5)).max() <= 0.52


def test_a_middle_at_the_rim_gives_way_to_the_nearest_window_in_view():
    # Columns reach 16 cells wide over 640 px, rows 22 cells high over 480 px: the middle row is
    # line 11, at 440 px, and the cells beyond line 12 are out of the frame.
    window = central_window(upright_grid(17, 23), 5)
    assert window.column == 5
    assert window.row == 7
    assert window.corners_xy[:, 1].max() <= 12 * PITCH


def test_points_beyond_the_horizon_have_no_pixels():
    pose = look_at_pad(300.0, tilt_deg=40)
    view = lattice_view(pose, small_camera(), 40.0)
    window = central_window(find_line_grid(grid_lines(view, range(-3, 4), range(-3, 4))), 5)
    far = np.array([[0.0, 0.0], [0.0, 1e4], [0.0, -1e4], [1e4, 0.0], [-1e4, 0.0]])
    finite = np.isfinite(window.to_pixels(far)).all(axis=1)
    assert finite[0]
    assert not finite.all()
