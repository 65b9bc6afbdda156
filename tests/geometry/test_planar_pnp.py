"""First poses from points of the plane."""

import numpy as np
import pytest
from dense_frames import errors, random_pose
from hypothesis import given
from hypothesis import strategies as st

from padstudio.geometry.planar_pnp import least_squares, mirrored, planar_pose, spread_of
from padstudio.geometry.pose import look_at_pad

POINTS = np.column_stack([np.random.default_rng(2).uniform(-100, 100, (25, 2)), np.zeros(25)])


def rays_of(pose, points=POINTS):
    seen = (points - pose.position_mm) @ pose.rotation
    return seen[:, :2] / seen[:, 2:]


@pytest.mark.parametrize("seed", range(12))
def test_exact_points_give_the_exact_pose(seed):
    pose = random_pose(np.random.default_rng(seed), 400.0, tilt_deg=70.0)
    found = planar_pose(POINTS, rays_of(pose))
    assert found is not None
    position, attitude = errors(found.pose, pose)
    assert position < 1e-3
    assert attitude < 1e-3
    assert found.error < 1e-6
    assert 0 <= found.ambiguity <= 1


def test_a_small_far_pad_has_two_answers_of_which_one_is_right():
    pose = look_at_pad(4000.0, tilt_deg=35, heading_deg=20, tilt_towards_deg=110)
    noise = np.random.default_rng(3).normal(0, 2e-4, (25, 2))
    found = planar_pose(POINTS, rays_of(pose) + noise)
    assert found is not None
    assert found.other is not None
    assert found.ambiguity > 0.5
    answers = [errors(item, pose)[1] for item in (found.pose, found.other)]
    assert min(answers) < 12


def test_a_near_tilted_pad_has_one_clear_answer():
    pose = look_at_pad(250.0, tilt_deg=40, tilt_towards_deg=60)
    found = planar_pose(POINTS, rays_of(pose))
    assert found is not None
    assert found.ambiguity < 0.05


def test_points_on_a_line_give_no_pose_that_is_wrong():
    line = POINTS.copy()
    line[:, 1] = 0
    found = planar_pose(line, rays_of(look_at_pad(400.0), line))
    assert found is None or np.isfinite(found.pose.position_mm).all()


def test_a_mirrored_pose_shows_a_small_plane_alike():
    pose = look_at_pad(40_000.0, tilt_deg=9.0, heading_deg=50, target_mm=(900.0, -2000.0))
    other = mirrored(pose)
    np.testing.assert_allclose(other.rotation @ other.rotation.T, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(other.tvec_mm, pose.tvec_mm, atol=1e-6)
    size = np.ptp(rays_of(pose), axis=0).max()
    assert np.abs(rays_of(other) - rays_of(pose)).max() < 0.003 * size
    assert errors(other, pose)[1] > 10
    np.testing.assert_allclose(mirrored(other).rotation, pose.rotation, atol=1e-12)


@given(st.integers(0, 2**32 - 1))
def test_the_spread_is_that_of_poses_found_anew(seed: int) -> None:
    rng = np.random.default_rng(seed)
    tilt, heading = rng.uniform(5, 40), rng.uniform(0, 360)
    pose = look_at_pad(900.0, tilt_deg=tilt, heading_deg=heading)
    points = np.array([[-150.0, -150, 0], [150, -150, 0], [150, 150, 0], [-150, 150, 0]])
    rays = rays_of(pose, points)
    moves = rng.normal(0, 3e-4, (5, 4, 2))
    moved = rays + np.concatenate([moves, -moves])
    covariance, unexplained = spread_of(points, rays, moved, pose)
    found = [least_squares(points, each, pose)[1] for each in moved]
    steps = [pose.step_to(each) for each in found]
    assert covariance == pytest.approx(sum(np.outer(s, s) for s in steps) / 2, rel=1e-4, abs=1e-9)
    off = [each - rays_of(new, points) for each, new in zip(moved, found, strict=True)]
    assert unexplained == pytest.approx((np.array(off) ** 2).sum() / 2, rel=1e-3, abs=1e-12)
