"""The compiled fits against their plain forms."""

import cv2
import numpy as np
from dense_frames import borders_amid, random_pose, sample_pad, seen_by
from hypothesis import given
from hypothesis import strategies as st

from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.vision.pose import least_squares_kernel
from padstudio.vision.pose.least_squares_kernel import Sightings

BORDERS = borders_amid(sample_pad(), sample_pad().layers[1], 4.5)


def moving_pose(seed):
    rng = np.random.default_rng(seed)
    pose = random_pose(rng, 700.0)
    return MovingPose(pose, rng.normal(0, 4, 3), rng.normal(0, 0.004, 3)), rng


def linearized(pose, rays, row_time):
    seen = Sightings(BORDERS.points_mm, BORDERS.along_mm, rays, row_time, np.ones(len(rays)))
    return least_squares_kernel.linearize(seen, pose.state)


@given(seed=st.integers(0, 10**6))
def test_the_jacobian_is_the_residuals_change(seed):
    pose, rng = moving_pose(seed)
    row_time = rng.uniform(-0.5, 0.5, len(BORDERS.step))
    seen = seen_by(pose, BORDERS.points_mm, row_time)
    rays = seen[:, :2] / seen[:, 2:]
    rows = linearized(pose, rays, row_time)
    np.testing.assert_allclose(rows[:, 0], 0, atol=1e-12)
    # Measured on the border itself, its own turn with the pose does not count.
    steps = np.diag([1e-3] * 3 + [1e-6] * 3 + [1e-3] * 3 + [1e-6] * 3)
    for k, step in enumerate(steps):
        after, before = (linearized(pose.moved(sign * step), rays, row_time) for sign in (1, -1))
        change = (after[:, 0] - before[:, 0]) / (2 * step[k])
        expected = -rows[:, 1 + k % 6] * (row_time if k >= 6 else 1)
        size = np.abs(expected).max()
        np.testing.assert_allclose(change, expected, atol=3e-2 * size + 1e-9)


def test_normal_equations_are_the_plain_products():
    rng = np.random.default_rng(5)
    rows, row_time = rng.normal(size=(40, 7)), rng.uniform(-0.5, 0.5, 40)
    weight = rng.uniform(0, 1, 40)
    weight[3] = 0
    for size in (6, 12):
        jacobian = np.column_stack([rows[:, 1:], rows[:, 1:] * row_time[:, None]])[:, :size]
        normal, right = least_squares_kernel.normal_equations(rows, row_time, weight, size)
        np.testing.assert_allclose(normal, jacobian.T @ (jacobian * weight[:, None]), atol=1e-12)
        np.testing.assert_allclose(right, jacobian.T @ (weight * rows[:, 0]), atol=1e-12)


@given(seed=st.integers(0, 10**6), size=st.sampled_from([1, 6, 12]))
def test_cholesky_solves_what_is_positive_definite(seed, size):
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(size, size)) * 10 ** rng.uniform(-3, 3, size)[:, None]
    matrix, right = root.T @ root + np.diag(np.full(size, 1e-3)), rng.normal(size=size)
    solved, found = least_squares_kernel.solve(matrix, right)
    assert solved
    np.testing.assert_allclose(matrix @ found, right, atol=1e-6)


def test_cholesky_refuses_what_leaves_a_parameter_open():
    assert not least_squares_kernel.solve(np.diag([1.0, 0.0, 2.0]), np.ones(3))[0]
    assert not least_squares_kernel.solve(np.full((2, 2), np.nan), np.ones(2))[0]


@given(seed=st.integers(0, 10**6), size=st.sampled_from([1e-9, 1e-3, 0.5, 3.0]))
def test_turns_are_those_of_rodrigues(seed, size):
    rng = np.random.default_rng(seed)
    turn = rng.normal(0, size, 3)
    rotation = random_pose(rng, 700.0).rotation
    expected = rotation @ cv2.Rodrigues(turn)[0]
    np.testing.assert_allclose(least_squares_kernel.turned(rotation, turn), expected, atol=1e-9)
