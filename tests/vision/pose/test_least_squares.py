"""Least squares for the pose: accuracy, outliers, motion, and what it says of itself."""

import numpy as np
import pytest
from dense_frames import all_borders, errors, random_pose, sample_pad, small_camera

from padstudio.geometry.rolling_shutter import KnownMotion, MovingPose
from padstudio.vision.pose.edge_points import EdgePoints
from padstudio.vision.pose.least_squares import MOVING, STILL, MotionModel, better_of, fit_pose

CAMERA = small_camera()


def measured_by(pose, *, noise_px=0.0, seed=0, layer=1):
    """Borders measured along their normals as a camera of a moving pose would show them."""
    rng = np.random.default_rng(seed)
    pad = sample_pad()
    borders = all_borders(pad, pad.layers[layer])
    xy = pose.project(CAMERA, borders.points_mm)
    keep = (xy > 0).all(axis=1) & (xy < [CAMERA.width - 1, CAMERA.height - 1]).all(axis=1)
    which = np.flatnonzero(keep)
    noisy = xy[which] + rng.normal(0, noise_px, (len(which), 2)) if noise_px else xy[which]
    ones = np.ones(len(which))
    return EdgePoints(borders.take(which), noisy, ones, 0 * ones)


def nudged(pose, seed=1, mm=6.0, rad=0.01):
    rng = np.random.default_rng(seed)
    return MovingPose(pose).moved(np.concatenate([rng.normal(0, mm, 3), rng.normal(0, rad, 3)]))


@pytest.mark.parametrize("seed", range(4))
def test_exact_borders_give_the_exact_pose(seed):
    pose = random_pose(np.random.default_rng(seed), 900.0, tilt_deg=50.0)
    fit = fit_pose(nudged(pose), measured_by(MovingPose(pose)), CAMERA, STILL, iterations=8)
    assert fit is not None
    position, attitude = errors(fit.pose.pose, pose)
    assert position < 1e-3
    assert attitude < 1e-3
    assert fit.inliers.all()


def test_a_fifth_of_wild_borders_does_not_matter():
    pose = random_pose(np.random.default_rng(7), 900.0)
    edge_points = measured_by(MovingPose(pose), noise_px=0.1)
    wild = np.arange(len(edge_points.xy)) % 5 == 0
    edge_points.xy[wild] += np.random.default_rng(2).uniform(-9, 9, (wild.sum(), 2))
    fit = fit_pose(nudged(pose), edge_points, CAMERA, STILL, iterations=8)
    assert fit is not None
    assert errors(fit.pose.pose, pose)[0] < 0.1
    assert fit.inliers[~wild].mean() > 0.95
    assert fit.inliers[wild].mean() < 0.4


def test_the_covariance_is_true_for_a_shutter_that_does_not_roll():
    pose = random_pose(np.random.default_rng(5), 900.0, tilt_deg=30.0)
    squares = []
    for seed in range(60):
        edge_points = measured_by(MovingPose(pose), noise_px=0.3, seed=seed)
        fit = fit_pose(
            MovingPose(pose),
            edge_points,
            CAMERA,
            MotionModel(moving=False, rolling=False),
            iterations=4,
        )
        assert fit is not None
        error = fit.pose.step_to(MovingPose(pose))
        squares.append(error @ np.linalg.solve(fit.covariance, error) / 6)
    assert 1 / 1.5 < np.mean(squares) < 1.5


def test_a_shutter_that_rolls_while_the_camera_drifts_leaves_height_against_tilt_in_doubt():
    pose = random_pose(np.random.default_rng(5), 900.0, tilt_deg=5.0)
    drifting = MovingPose(pose, np.array([2.0, -1.0, 0.0]), np.array([0.001, 0.002, 0.003]))
    edge_points = measured_by(drifting, noise_px=0.1)
    sure, unsure = (
        fit_pose(drifting, edge_points, CAMERA, MotionModel(moving=True, rolling=rolling))
        for rolling in (False, True)
    )
    assert sure is not None
    assert unsure is not None
    # One direction alone is in doubt.
    root = np.linalg.inv(np.linalg.cholesky(sure.covariance))
    ratio = np.linalg.eigvalsh(root @ unsure.covariance @ root.T)
    assert ratio[-1] > 100
    assert (ratio[:-1] < 20).all()
    # Sinking by 1.2 % of the height in a frame moves the pose by about as much.
    moved = np.sqrt(np.diag(unsure.covariance)[:3].sum()) / 900
    assert 0.005 < moved < 0.03


def test_a_shutter_that_may_roll_leaves_no_such_doubt_where_nothing_moves():
    pose = random_pose(np.random.default_rng(5), 900.0, tilt_deg=5.0)
    fit = fit_pose(MovingPose(pose), measured_by(MovingPose(pose), noise_px=0.1), CAMERA, STILL)
    assert fit is not None
    assert np.sqrt(np.trace(fit.covariance[:3, :3])) / 900 < 0.001


def test_motion_within_a_frame_is_found_and_chosen():
    pose = random_pose(np.random.default_rng(3), 900.0, tilt_deg=10.0)
    true = MovingPose(pose, np.array([5.0, -4.0, 0.0]), np.array([0.002, 0.001, 0.004]))
    edge_points = measured_by(true, noise_px=0.1)
    still = fit_pose(nudged(pose), edge_points, CAMERA, STILL, iterations=6)
    assert still is not None
    moving = fit_pose(still.pose, edge_points, CAMERA, MOVING, iterations=6)
    assert moving is not None
    assert better_of(still, moving) is moving
    assert errors(moving.pose.pose, pose)[0] < errors(still.pose.pose, pose)[0]
    points = np.column_stack([np.random.default_rng(0).uniform(-250, 250, (50, 2)), np.zeros(50)])
    shown, found = (p.project(CAMERA, points) for p in (true, moving.pose))
    assert np.abs(shown - found).max() < 0.3


def test_a_still_camera_stays_still_and_the_other_model_is_doubt():
    pose = random_pose(np.random.default_rng(3), 900.0)
    edge_points = measured_by(MovingPose(pose), noise_px=0.3)
    still = fit_pose(nudged(pose), edge_points, CAMERA, STILL, iterations=6)
    assert still is not None
    moving = fit_pose(still.pose, edge_points, CAMERA, MOVING, iterations=6)
    chosen = better_of(still, moving)
    assert chosen.pose is still.pose
    assert np.linalg.eigvalsh(chosen.covariance - still.covariance)[0] > -1e-9
    assert better_of(still, None) is still


def test_a_known_climb_is_told_from_tilt():
    pose = random_pose(np.random.default_rng(9), 900.0, tilt_deg=5.0)
    true = MovingPose(pose, np.array([2.0, 1.0, -9.0]), np.array([0.001, -0.001, 0.002]))
    edge_points = measured_by(true, noise_px=0.1)
    known = KnownMotion(true.shift_mm, true.rotvec, 0.5)
    blind = fit_pose(MovingPose(pose), edge_points, CAMERA, MOVING, iterations=6)
    told = fit_pose(
        MovingPose(pose), edge_points, CAMERA, MotionModel(moving=True, known=known), iterations=6
    )
    assert blind is not None
    assert told is not None
    assert errors(told.pose.pose, pose)[0] < 0.3 * errors(blind.pose.pose, pose)[0]
    assert np.trace(told.covariance[:3, :3]) < 0.1 * np.trace(blind.covariance[:3, :3])
    for fit in (blind, told):
        error = fit.pose.step_to(MovingPose(pose))
        assert error @ np.linalg.solve(fit.covariance, error) / 6 < 4


def test_too_few_borders_are_no_fit():
    pose = random_pose(np.random.default_rng(3), 900.0)
    edge_points = measured_by(MovingPose(pose))
    borders = edge_points.borders.take(np.arange(11))
    few = EdgePoints(borders, edge_points.xy[:11], edge_points.weight[:11], np.zeros(11))
    assert fit_pose(MovingPose(pose), few, CAMERA, STILL) is None
