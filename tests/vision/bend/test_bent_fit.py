"""A pose and a sheet's heights found together, from borders of a sheet that is known."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from dense_frames import sample_pad

from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import look_at_pad
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.vision.bend.bent_fit import (
    USUAL,
    BentFit,
    amplitude_of,
    bent_covariance,
    first_bent,
    fit_bent,
)
from padstudio.vision.bend.sheet import Sheet
from padstudio.vision.bend.smooth_field import Cosines
from padstudio.vision.pose.edge_points import EdgePoints, visible_borders
from padstudio.vision.pose.row_motion import MotionBounds

CAMERA = Camera(1360, 765, np.array([[1000.0, 0, 679.5], [0, 1000.0, 382.0], [0, 0, 1]]))
PAD = sample_pad()
TRUE = look_at_pad(900.0, tilt_deg=20, heading_deg=25, tilt_towards_deg=100)
NOISE_PX = 0.1


@cache
def seen(seed=0, amplitude_mm=4.0):
    """Borders of a bent sheet as a camera sees them, and the sheet."""
    rng = np.random.default_rng(seed)
    borders = visible_borders(PAD, PAD.layer("red"), CAMERA, MovingPose(TRUE), 1500)
    box = np.stack([f(borders.points_mm[:, :2], axis=0) for f in (np.min, np.max)])
    cosines = Cosines.over(box, 250.0)
    drawn = amplitude_mm * np.sqrt(cosines.variance) * rng.normal(size=len(cosines.modes))
    sheet = Sheet(cosines, drawn, box)
    xy = MovingPose(TRUE).project(CAMERA, sheet.laid(borders.points_mm))
    xy += NOISE_PX * rng.normal(size=xy.shape)
    return EdgePoints(borders, xy, np.ones(len(xy)), np.zeros(len(xy))), sheet


def best_fit(fit, points_mm):
    return fit.sheet.relative(fit.pose.pose, points_mm)


def test_the_pose_is_found_with_the_sheet():
    edge_points, sheet = seen()
    fit, log_odds = first_bent(edge_points, CAMERA, TRUE, max(PAD.size_mm), USUAL)
    points = edge_points.borders.points_mm
    found, expected = best_fit(fit, points), sheet.relative(TRUE, points)
    assert log_odds > 1000
    assert np.linalg.norm(found.position_mm - expected.position_mm) < 0.9
    heights = fit.sheet.flattened(points)[0][:, 2] - sheet.flattened(points)[0][:, 2]
    assert np.sqrt(np.mean(heights**2)) < 0.3


def test_the_covariance_holds_the_plane_about_which_heights_are_expected():
    squares = []
    for seed in range(12):
        edge_points, sheet = seen(seed)
        start = BentFit(MovingPose(TRUE), Sheet.flat(sheet.cosines, sheet.box), 4.0)
        fit = fit_bent(edge_points, CAMERA, start, 4)
        bounds = replace(MotionBounds.unknown(900.0, 0.01, None, rolling=False), at_rest=True)
        covariance = bent_covariance(edge_points, CAMERA, fit, bounds)
        error = fit.pose.step_to(MovingPose(TRUE))
        squares.append(error @ np.linalg.solve(covariance, error) / 6)
    # It holds what lens and sensor leave over, too, which is not drawn here.
    assert 0.3 < np.mean(squares) < 1.6


def test_the_amplitude_is_that_of_the_sheet():
    edge_points, sheet = seen()
    fit = BentFit(MovingPose(TRUE), sheet, 1.0)
    assert amplitude_of(edge_points, CAMERA, fit) == pytest.approx(4.0, rel=0.5)
