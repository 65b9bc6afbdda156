"""Range and bearing of the pad, and how sure they are."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from padstudio.geometry.pose import Pose, look_at_pad, rotation_from_vector
from padstudio.geometry.range_bearing import (
    MOST_ATTITUDE_DEG,
    MOST_POSITION_SHARE,
    bearing_sigma_deg,
    quality_of,
    range_sigma_mm,
)


def seen_from(pose):
    """The covariance (6, 6) of a pose from a grid of points, by least squares with f = 800 px.

    Each coordinate is off by 0.3 px.
    """
    places = np.array([[x, y, 0.0] for x in (-300, 0, 300) for y in (-300, 0, 300)])

    def project(step):
        moved = stepped(pose, step)
        points = moved.to_camera(places)
        return 800 * (points[:, :2] / points[:, 2:]).ravel()

    sizes = np.array([1e-3 * pose.range_mm] * 3 + [1e-3] * 3)
    columns = [(project(s) - project(-s)) / 2 for s in np.diag(sizes)]
    jacobian = np.column_stack(columns) / sizes
    return 0.3**2 * np.linalg.inv(jacobian.T @ jacobian)


def stepped(pose, step):
    """The pose after a step (6,) of the centre, mm, and a rotation vector, camera frame."""
    return Pose(pose.position_mm + step[:3], pose.rotation @ rotation_from_vector(step[3:]))


POSES = {
    "near": look_at_pad(700, tilt_deg=10, heading_deg=70, target_mm=(100, -50)),
    "oblique": look_at_pad(900, tilt_deg=60, heading_deg=200, tilt_towards_deg=30),
    "far": look_at_pad(12_000, tilt_deg=8, heading_deg=20, target_mm=(900, 400)),
}


@pytest.mark.parametrize("name", POSES)
def test_sigmas_are_those_of_many_trials(name):
    pose = POSES[name]
    covariance = seen_from(pose)
    # Small steps, as the propagation is of the first order.
    small = covariance / 1e4
    steps = np.random.default_rng(1).multivariate_normal(np.zeros(6), small, 4000)
    trials = [stepped(pose, step) for step in steps]
    spread_mm = 100 * np.std([trial.range_mm for trial in trials])
    assert range_sigma_mm(pose, covariance) == pytest.approx(spread_mm, rel=0.05)
    off = np.array([trial.bearing - pose.bearing for trial in trials])
    worst = 100 * np.degrees(np.sqrt(np.linalg.eigvalsh(np.cov(off.T))[-1]))
    assert bearing_sigma_deg(pose, covariance) == pytest.approx(worst, rel=0.05)


def test_far_away_range_and_bearing_are_known_far_better_than_the_position():
    pose = POSES["far"]
    covariance = seen_from(pose)
    position_mm = np.sqrt(np.trace(covariance[:3, :3]))
    attitude_deg = np.degrees(np.sqrt(np.trace(covariance[3:, 3:])))
    assert range_sigma_mm(pose, covariance) < position_mm / 10
    assert bearing_sigma_deg(pose, covariance) < attitude_deg / 500
    sigma = np.sqrt(np.diag(covariance))
    assert quality_of(pose.range_mm, sigma[:3], np.degrees(sigma[3:])) == "bearing"


@given(st.tuples(*[st.floats(-3, 3)] * 3), st.tuples(*[st.floats(-3, 3)] * 3))
def test_no_frame_is_preferred(pad_turn, camera_turn):
    """Sigmas stay when the pad's or the camera's frame is turned, and the bearing turns along."""
    pose, covariance = POSES["oblique"], seen_from(POSES["oblique"])
    pad, camera = (
        rotation_from_vector(np.array(pad_turn)),
        rotation_from_vector(np.array(camera_turn)),
    )
    turned = Pose(pad @ pose.position_mm, pad @ pose.rotation @ camera)
    both = np.zeros((6, 6))
    both[:3, :3], both[3:, 3:] = pad, camera.T
    again = both @ covariance @ both.T
    np.testing.assert_allclose(turned.bearing, camera.T @ pose.bearing, atol=1e-12)
    assert turned.range_mm == pytest.approx(pose.range_mm)
    assert range_sigma_mm(turned, again) == pytest.approx(range_sigma_mm(pose, covariance))
    expected = bearing_sigma_deg(pose, covariance)
    assert bearing_sigma_deg(turned, again) == pytest.approx(expected, rel=1e-6)


def test_a_pose_is_full_where_both_sigmas_are_small():
    share, degrees = 1000 * MOST_POSITION_SHARE, MOST_ATTITUDE_DEG
    assert quality_of(1000, [share * 0.9, 0, 0], [degrees * 0.9, 0, 0]) == "full"
    assert quality_of(1000, [share * 0.8] * 3, [0, 0, 0]) == "bearing"
    assert quality_of(1000, [0, 0, 0], [degrees * 0.8] * 3) == "bearing"
    assert quality_of(1000, [0, np.nan, 0], [0, 0, 0]) == "bearing"


def test_bearing_points_at_the_pads_centre_and_range_says_how_far():
    pose = POSES["near"]
    (centre,) = pose.to_camera(np.zeros((1, 3)))
    np.testing.assert_allclose(pose.range_mm * pose.bearing, centre)
