"""Corners of a lattice that many noisy lines hold: their scatter over many draws is as stated."""

import numpy as np
import pytest
from paper_frames import grid_lines, lattice_view, small_camera

from padstudio.geometry.pose import look_at_pad
from padstudio.vision.baseline.grid_covariance import corners_covariance
from padstudio.vision.baseline.line_grid import find_line_grid

SQUARE = np.array([[-2, -2], [3, -2], [3, 3], [-2, 3]], float)
NOISE_PX = 0.4


def drawn(tilt_deg, columns, rows, seed):
    """How far a window's corners (8,) are off in one draw, plane pixels, and their covariance."""
    pose = look_at_pad(600.0, tilt_deg=tilt_deg, heading_deg=20.0, tilt_towards_deg=60.0)
    view = lattice_view(pose, small_camera(), 40.0)
    grid = find_line_grid(grid_lines(view, columns, rows, noise_px=NOISE_PX, seed=seed))
    h = np.column_stack([SQUARE, np.ones(4)]) @ view.T
    true = h[:, :2] / h[:, 2:]
    # Numbers of the found lattice: whole ones next to where the true corners fall.
    at = np.column_stack([true, np.ones(4)]) @ grid.lattice_from_plane.T
    corners = np.round(at[:, :2] / at[:, 2:])
    h = np.column_stack([corners, np.ones(4)]) @ np.linalg.inv(grid.lattice_from_plane).T
    return (h[:, :2] / h[:, 2:] - true).ravel(), corners_covariance(grid, corners)


@pytest.mark.parametrize("tilt_deg", [0.0, 35.0])
@pytest.mark.parametrize(
    ("columns", "rows"), [(range(-5, 6), range(-4, 5)), ((-3, -2, 0, 1, 3), (-3, -1, 0, 2, 3))]
)
def test_corners_scatter_as_stated(tilt_deg, columns, rows):
    draws = [drawn(tilt_deg, columns, rows, seed) for seed in range(150)]
    nees = [off @ np.linalg.solve(covariance, off) for off, covariance in draws]
    # Of few lines their own residuals tell the noise but roughly.
    assert 0.75 < np.median(nees) / 7.34 < 1.35
    stated = np.sqrt(np.mean([np.diag(covariance) for _, covariance in draws], axis=0))
    ratio = stated / np.sqrt(np.mean([off**2 for off, _ in draws], axis=0))
    assert ((ratio > 0.8) & (ratio < 1.3)).all()


def test_more_lines_hold_corners_better():
    few = drawn(20.0, range(-2, 4), range(-2, 4), 1)[1]
    many = drawn(20.0, range(-6, 7), range(-6, 7), 1)[1]
    assert np.trace(many) < 0.5 * np.trace(few)


def test_lines_without_any_residual_are_not_taken_to_be_perfect():
    pose = look_at_pad(600.0, tilt_deg=20.0)
    view = lattice_view(pose, small_camera(), 40.0)
    grid = find_line_grid(grid_lines(view, range(-5, 6), range(-4, 5)))
    sigma = np.sqrt(np.diag(corners_covariance(grid, SQUARE)))
    assert (sigma > 0.01).all()
    assert (sigma < 0.2).all()


def test_a_corner_far_outside_its_lines_is_less_sure():
    pose = look_at_pad(600.0)
    view = lattice_view(pose, small_camera(), 40.0)
    grid = find_line_grid(grid_lines(view, range(-3, 4), range(-3, 4), noise_px=0.2))
    variances = np.diag(corners_covariance(grid, np.array([[0.0, 0.0], [12.0, 12.0]])))
    assert variances[2:].min() > 9 * variances[:2].max()
