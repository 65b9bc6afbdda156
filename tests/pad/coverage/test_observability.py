"""How surely a picture of a flat sign tells its lean: closed forms against pictures of points."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from padstudio.pad.coverage.observability import (
    Hold,
    hold_of_borders,
    hold_of_corners,
    share_known,
)

FOCAL_PX = 900.0


def seen(points, tilt, lean=(0.0, 0.0), *, distance=9.0):
    """Points (N, 2) of a sign that leans, as a camera sees them from a distance, pixels."""
    normal = np.array([math.sin(tilt) + lean[0], lean[1]])
    normal = np.append(normal, math.sqrt(1 - normal @ normal))
    # The least turn from the line of sight to the normal.
    axis = np.cross([0.0, 0.0, 1.0], normal)
    sine = np.linalg.norm(axis)
    axis, angle = (axis / sine, math.asin(sine)) if sine else (np.array([1.0, 0, 0]), 0.0)
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    turn = np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    there = np.column_stack([points, np.zeros(len(points))]) @ turn.T
    return FOCAL_PX * there[:, :2] / (distance - there[:, 2:])


def least_apart(one, other):
    """Sum of squares between two pictures after the best shift, scale and turn of one of them."""
    a, b = (complex_of - complex_of.mean() for complex_of in (one @ [1, 1j], other @ [1, 1j]))
    return float((np.abs(b - np.vdot(a, b) / np.vdot(a, a) * a) ** 2).sum())


@pytest.mark.parametrize(
    ("tilt", "lean"),
    [(0.0, (0.05, 0.0)), (0.0, (0.0, 0.2)), (0.2, (0.03, 0.0)), (0.2, (0.0, 0.03))],
)
def test_corners_tell_leans_apart_as_pictures_of_them_do(tilt, lean):
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * 0.5
    side_px = FOCAL_PX / 9.0
    hold = hold_of_corners(side_px, FOCAL_PX, noise_px=1.0)
    chi2 = hold.apart((math.sin(tilt), 0.0), (math.sin(tilt) + lean[0], lean[1]))
    pictures = least_apart(seen(square, tilt), seen(square, tilt, lean))
    assert chi2 == pytest.approx(pictures, rel=0.2)


def test_borders_tell_what_as_many_points_would():
    """Sharp cells of 1 px: every pixel has a border, of which each tells one coordinate."""
    side_px, rng = 120.0, np.random.default_rng(2)
    hold = hold_of_borders(side_px, [1.0], FOCAL_PX, noise_px=1.0, blur_px=1e-6)
    points = rng.uniform(-0.5, 0.5, (4000, 2)) * side_px / FOCAL_PX * 9.0
    apart = least_apart(seen(points, 0.0), seen(points, 0.0, (0.1, 0.0)))
    # Two coordinates a point, one a border.
    expected = apart / len(points) / 2 * side_px**2
    assert hold.apart((0.0, 0.0), (0.1, 0.0)) == pytest.approx(expected, rel=0.1)


def test_blur_wipes_out_small_cells_first():
    def stretch(cell_px, blur_px):
        return hold_of_borders(100.0, [cell_px], 900.0, noise_px=1.0, blur_px=blur_px).stretch

    assert stretch(20.0, 0.8) / stretch(20.0, 1e-6) > 0.9
    assert stretch(1.0, 0.8) / stretch(1.0, 1e-6) < 0.2
    two = hold_of_borders(100.0, [20.0, 4.0], 900.0, noise_px=1.0, blur_px=0.8).stretch
    assert two == pytest.approx(stretch(20.0, 0.8) + stretch(4.0, 0.8))


def test_shares_are_those_of_drawn_errors():
    """Leans drawn from the Gaussian that χ² stands for, straight down and tilted."""
    rng = np.random.default_rng(3)
    straight = Hold(stretch=0.0, keystone=9000.0)
    drawn = np.hypot(*rng.normal(0, 9000.0**-0.5, (2, 200_000)))
    assert share_known(straight, 0.0, 0.012) == pytest.approx((drawn < 0.012).mean(), abs=0.01)
    tilt, within = math.radians(40), 0.02
    leaning = Hold(stretch=40_000.0, keystone=1000.0)
    sine, cosine = math.sin(tilt), math.cos(tilt)
    along = leaning.apart((sine, 0.0), (sine + cosine * 1e-3, 0.0)) / 1e-6
    across = leaning.apart((sine, 0.0), (sine, 1e-3)) / 1e-6
    drawn = np.hypot(rng.normal(0, along**-0.5, 200_000), rng.normal(0, across**-0.5, 200_000))
    assert share_known(leaning, tilt, within) == pytest.approx((drawn < within).mean(), abs=0.01)


def test_of_two_mirrored_leans_one_is_guessed():
    """A stretch tells the size of a lean, the keystone alone its side."""
    tilt = math.radians(30)
    assert share_known(Hold(1e9, 0.0), tilt, 0.02) == pytest.approx(0.5)
    assert share_known(Hold(1e9, 1e3), tilt, 0.02) == pytest.approx(1.0, abs=1e-3)
    assert share_known(Hold(1e12, 0.0), 0.005, 0.02) > 0.9


@given(
    side=st.floats(20, 500),
    cell=st.floats(1, 50),
    tilt=st.floats(0, 1.4),
    within=st.floats(1e-3, 0.05),
)
def test_shares_grow_with_what_is_seen(side, cell, tilt, within):
    few = hold_of_borders(side, [cell], FOCAL_PX, noise_px=0.5, blur_px=0.8)
    many = hold_of_borders(1.2 * side, [1.2 * cell], FOCAL_PX, noise_px=0.5, blur_px=0.8)
    assert 0 <= share_known(few, tilt, within) <= 1
    assert share_known(many, tilt, within) >= share_known(few, tilt, within) - 1e-9
    assert share_known(few, tilt, 1.1 * within) >= share_known(few, tilt, within) - 0.02
