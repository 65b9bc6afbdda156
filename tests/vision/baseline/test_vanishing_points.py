"""Vanishing points of the two families."""

import numpy as np
import pytest
from paper_frames import grid_lines, lattice_view, small_camera

from padstudio.geometry.pose import look_at_pad
from padstudio.vision.baseline.vanishing_points import aligned, two_vanishing_points


def unit(lines):
    """Ends in coordinates of about unit size."""
    return (lines.ends - (320, 240)) / 320


@pytest.mark.parametrize("heading_deg", [0.0, 20.0, 77.0])
def test_vanishing_points_of_a_tilted_grid(heading_deg):
    pose = look_at_pad(600.0, tilt_deg=35, heading_deg=heading_deg, tilt_towards_deg=50)
    view = lattice_view(pose, small_camera(), 40.0)
    found = two_vanishing_points(
        *(lambda x: (unit(x), x.support))(grid_lines(view, range(-5, 6), range(-5, 6)))
    )
    to_unit = np.array([[1 / 320, 0, -1], [0, 1 / 320, -0.75], [0, 0, 1]])
    for true in (to_unit @ view)[:, :2].T:
        true = true / np.linalg.norm(true)
        likeness = max(abs(point @ true) for point in found)
        assert likeness > 1 - 1e-9


def test_lines_of_one_direction_are_no_two_families():
    view = lattice_view(look_at_pad(600.0, tilt_deg=10), small_camera(), 40.0)
    lines = grid_lines(view, range(-5, 6), range(-5, 6))
    upright = np.abs(lines.homogeneous[:, 0]) > 0.7
    assert two_vanishing_points(unit(lines)[upright], lines.support[upright]) is None


def test_a_point_within_the_picture_is_no_vanishing_point():
    angles = np.radians(np.arange(0, 180, 10))
    out = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    star = np.stack([-out, out], axis=1) * 0.9
    found = two_vanishing_points(star, np.full(len(star), 1.8))
    for point in found or ():
        assert not (np.abs(point[:2]) < 0.85 * abs(point[2])).all()


def test_aligned_is_about_the_direction_of_a_line():
    ends = np.array([[[0.0, 0.0], [0.5, 0.0]], [[0.0, 0.1], [0.5, 0.3]]])
    assert aligned(np.array([1.0, 0.0, 0.0]), ends).tolist() == [True, False]
