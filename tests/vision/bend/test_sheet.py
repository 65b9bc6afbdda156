"""Where points of a bent sheet lie: lengths kept, and the plane that fits it best."""

import numpy as np
import pytest

from padstudio.geometry.pose import look_at_pad
from padstudio.vision.bend.sheet import Sheet
from padstudio.vision.bend.smooth_field import Cosines

BOX = np.array([[-400.0, -300.0], [400.0, 300.0]])


def sheet_of(height, length_mm=100.0):
    """The sheet whose heights are nearest to a function of x and y."""
    cosines = Cosines.over(BOX, length_mm)
    at = points(41)
    coefficients = np.linalg.lstsq(cosines.at(at[:, :2]), height(at[:, 0], at[:, 1]), rcond=1e-6)[0]
    return Sheet(cosines, coefficients, BOX)


def points(count):
    x, y = np.meshgrid(*(np.linspace(*BOX[:, axis], count) for axis in (0, 1)))
    return np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])


def test_a_flat_sheet_lies_where_the_pad_does():
    sheet = Sheet.flat(Cosines.over(BOX, 200.0), BOX)
    assert sheet.laid(points(5)) == pytest.approx(points(5), abs=1e-12)
    assert sheet.flatness_mm(points(5)) == pytest.approx(0.0, abs=1e-9)


def test_a_rolled_sheet_is_as_long_as_a_flat_one():
    along = np.array([0.6, 0.8])
    sheet = sheet_of(lambda x, y: ((along[0] * x + along[1] * y) / 100) ** 2)
    way = np.column_stack([np.outer(np.linspace(-350, 350, 701), along), np.zeros(701)])
    laid = sheet.laid(way)
    length = np.linalg.norm(np.diff(laid, axis=0), axis=1).sum()
    straight = np.linalg.norm(laid[-1] - laid[0])
    assert length == pytest.approx(700.0, abs=0.1)
    assert straight == pytest.approx(700.0 - 0.57, abs=0.1)


def test_flatness_is_measured_over_the_plane_that_fits_best():
    sheet = sheet_of(lambda x, y: 0.02 * x - 0.01 * y + 5 + 3 * np.sin(x / 80))
    assert sheet.flatness_mm(points(41)) == pytest.approx(6.0, abs=1.0)


def test_a_sheet_that_lies_aslant_but_flat_is_a_turn_of_the_pose():
    sheet = sheet_of(lambda x, y: 0.03 * x + 12, length_mm=400.0)
    pose = look_at_pad(800.0, tilt_deg=10, heading_deg=30)
    found = sheet.relative(pose, points(11))
    assert found.position_mm[2] == pytest.approx(
        pose.position_mm[2] - 12 - 0.03 * pose.position_mm[0], abs=1.0
    )
    turn = np.degrees(np.arccos((np.trace(found.rotation.T @ pose.rotation) - 1) / 2))
    assert turn == pytest.approx(np.degrees(np.arctan(0.03)), abs=0.1)
