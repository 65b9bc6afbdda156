"""Tests of padstudio.geometry.curvature: poses on an arc about the pad."""

import numpy as np
import pytest

from padstudio.geometry.curvature import with_curvature, without_curvature
from padstudio.geometry.pose import Pose, look_at_pad, rotation_from_vector


def drawn(tilt_deg, count=3000):
    """A pose whose attitude is known to so much, others that fit as well, and its covariance."""
    rng = np.random.default_rng(6)
    pose = look_at_pad(5000.0, tilt_deg=20.0, target_mm=(300.0, -200.0))
    sigma = np.array([1.0, 1.0, 10.0, *np.radians([tilt_deg, tilt_deg, 0.2])])
    errors = sigma * rng.standard_normal((count, 6))
    poses = []
    for error in errors:
        rotation = pose.rotation @ rotation_from_vector(error[3:])
        poses.append(Pose(-rotation @ (pose.tvec_mm + error[:3]), rotation))
    x, y, z = pose.tvec_mm
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    by_seen = np.eye(6)
    by_seen[:3, :3], by_seen[:3, 3:] = -pose.rotation, pose.rotation @ cross
    return pose, poses, by_seen @ np.diag(sigma**2) @ by_seen.T


def nees(pose, poses, covariance):
    errors = np.array([pose.step_to(other) for other in poses])
    return np.einsum("ni,ij,nj->n", errors, np.linalg.inv(covariance), errors).mean() / 6


def test_arcs_are_as_wide_as_said():
    pose, poses, covariance = drawn(tilt_deg=3.0)
    assert nees(pose, poses, covariance) > 2
    assert 0.7 < nees(pose, poses, with_curvature(covariance, pose)) < 1.5


def test_a_well_known_attitude_makes_no_arc():
    pose, poses, covariance = drawn(tilt_deg=0.01)
    bent = with_curvature(covariance, pose)
    np.testing.assert_allclose(bent, covariance, rtol=1e-3, atol=1e-3)
    assert nees(pose, poses, bent) == pytest.approx(1.0, abs=0.1)


def test_what_was_added_is_taken_away():
    pose, _, covariance = drawn(tilt_deg=5.0)
    np.testing.assert_allclose(
        without_curvature(with_curvature(covariance, pose), pose), covariance, rtol=1e-6
    )


def test_what_was_never_added_is_not_taken_away():
    pose, _, covariance = drawn(tilt_deg=5.0)
    np.testing.assert_array_equal(without_curvature(covariance, pose), covariance)
