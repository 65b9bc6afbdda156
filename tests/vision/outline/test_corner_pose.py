"""What four corners say of a pose."""

import cv2
import numpy as np
import pytest
from paper_frames import errors, paper_camera

from padstudio.geometry.planar_pnp import planar_pose
from padstudio.geometry.pose import Pose, look_at_pad
from padstudio.vision.outline.corner_pose import (
    corner_covariance,
    corner_residuals,
    unsure,
)
from padstudio.vision.stage.trace import Reason

SQUARE_MM = np.array([[-25, 25, 0], [25, 25, 0], [25, -25, 0], [-25, -25, 0]], float)


def seen(pose, points_mm=SQUARE_MM):
    return paper_camera().project((points_mm - pose.position_mm) @ pose.rotation)


def solved(xy):
    rays = paper_camera().normalize(xy)
    return planar_pose(SQUARE_MM, rays).pose


@pytest.mark.parametrize("tilt_deg", [0.5, 12.0, 40.0])
def test_exact_corners_give_the_exact_pose(tilt_deg):
    pose = look_at_pad(140.0, tilt_deg=tilt_deg, heading_deg=33, tilt_towards_deg=80)
    position, attitude = errors(solved(seen(pose)), pose)
    assert position < 1e-3
    assert attitude < 1e-3
    np.testing.assert_allclose(
        corner_residuals(pose, paper_camera(), SQUARE_MM, seen(pose)), 0, atol=1e-9
    )


def closed_form(xy):
    """The better of the two poses of infinitesimal plane-based pose estimation, by itself."""
    _, turns, shifts, errors_px = cv2.solvePnPGeneric(
        SQUARE_MM, paper_camera().normalize(xy), np.eye(3), None, flags=cv2.SOLVEPNP_IPPE
    )
    best = int(np.argmin(errors_px))
    return Pose.from_T_camera_pad(cv2.Rodrigues(turns[best])[0], shifts[best])


def test_least_squares_keep_a_good_pose_from_straight_above():
    """Foreshortening there is the square root of the corners' error; perspective tells more."""
    rng = np.random.default_rng(8)
    pose = look_at_pad(140.0, heading_deg=15)
    plain, found = [], []
    for _ in range(60):
        xy = seen(pose) + rng.normal(0, 0.4, (4, 2))
        plain.append(errors(closed_form(xy), pose)[0])
        found.append(errors(solved(xy), pose)[0])
    assert np.median(found) < 0.7 * np.median(plain)


@pytest.mark.parametrize("tilt_deg", [0.0, 30.0])
def test_covariance_is_that_of_many_trials(tilt_deg):
    rng = np.random.default_rng(2)
    pose = look_at_pad(140.0, tilt_deg=tilt_deg, heading_deg=60, tilt_towards_deg=20)
    trials = np.array(
        [
            solved(seen(pose) + rng.normal(0, 0.3, (4, 2))).position_mm - pose.position_mm
            for _ in range(400)
        ]
    )
    told = corner_covariance(pose, paper_camera(), SQUARE_MM, seen(pose), 0.3**2 * np.eye(8))
    ratio = np.sqrt(np.diag(told))[:3] / trials.std(axis=0)
    assert ((ratio > 0.7) & (ratio < 1.5)).all()


def test_scatter_may_differ_from_corner_to_corner():
    rng = np.random.default_rng(3)
    pose = look_at_pad(140.0, tilt_deg=25, heading_deg=60, tilt_towards_deg=20)
    # Two corners on one side move together, the others hardly at all.
    root = np.diag([0.5] * 4 + [0.05] * 4)
    root[2, 0] = root[3, 1] = 0.5
    trials = np.array(
        [
            solved(seen(pose) + (root @ rng.normal(0, 1, 8)).reshape(4, 2)).position_mm
            - pose.position_mm
            for _ in range(400)
        ]
    )
    told = corner_covariance(pose, paper_camera(), SQUARE_MM, seen(pose), root @ root.T)
    ratio = np.sqrt(np.diag(told))[:3] / trials.std(axis=0)
    assert ((ratio > 0.7) & (ratio < 1.5)).all()


def test_bent_squares_are_less_sure_than_their_sides():
    pose = look_at_pad(140.0, tilt_deg=20)
    bend = np.array([[1.0, 0.5], [-1.0, 0.5], [1.0, -0.5], [-1.0, -0.5]])
    scatter = 0.1**2 * np.eye(8)
    straight, bent = (
        corner_covariance(solved(xy), paper_camera(), SQUARE_MM, xy, scatter)
        for xy in (seen(pose), seen(pose) + bend)
    )
    # A bend of 0.6 px a coordinate beside a scatter of 0.1.
    assert 4 < np.sqrt(np.trace(bent[:3, :3]) / np.trace(straight[:3, :3])) < 12


def test_corners_bent_far_beyond_their_scatter_leave_a_wide_pose_but_a_finite_one():
    pose = look_at_pad(140.0, tilt_deg=20)
    xy = seen(pose) + 8 * np.array([[1.0, 0.5], [-1.0, 0.5], [1.0, -0.5], [-1.0, -0.5]])
    covariance = corner_covariance(solved(xy), paper_camera(), SQUARE_MM, xy, 1e-6 * np.eye(8))
    sigma_mm = np.sqrt(np.diag(covariance)[:3])
    assert ((sigma_mm > 0.1) & (sigma_mm < 20)).all()


def test_small_squares_leave_the_pose_open_and_are_refused():
    verdicts = []
    for height_mm in (140.0, 4000.0):
        pose = look_at_pad(height_mm, tilt_deg=3, heading_deg=20)
        covariance = corner_covariance(
            pose, paper_camera(), SQUARE_MM, seen(pose), 0.2**2 * np.eye(8)
        )
        verdicts.append(unsure(pose, covariance, 50 * 1886 / height_mm, 0.03, 3.0))
    assert verdicts[0] is None
    assert verdicts[1] is not None
    assert verdicts[1].reason is Reason.CELLS_TOO_SMALL
    assert "24 px apart" in verdicts[1].detail


def test_points_behind_the_camera_have_no_residual():
    pose = look_at_pad(140.0)
    behind = Pose(-pose.position_mm, pose.rotation)
    assert np.isnan(corner_residuals(behind, paper_camera(), SQUARE_MM, seen(pose))).all()
