"""Compiled loops against their plain forms."""

import numpy as np
import pytest
from dense_frames import random_pose, sample_pad, small_camera
from hypothesis import given
from hypothesis import strategies as st

from padstudio.vision import kernels
from padstudio.vision.borders import layer_borders
from padstudio.vision.motion import MovingPose

CAMERA = small_camera()
BORDERS = layer_borders(sample_pad(), sample_pad().layers[1], (8, 17), (8, 17))


def moving_pose(seed):
    rng = np.random.default_rng(seed)
    pose = random_pose(rng, 700.0)
    return MovingPose(pose, rng.normal(0, 4, 3), rng.normal(0, 0.004, 3)), rng


def linearized(pose, rays, moment):
    return kernels.linearize(
        BORDERS.points_mm,
        BORDERS.along_mm,
        rays,
        moment,
        np.ascontiguousarray(pose.pose.rotation),
        pose.pose.position_mm,
        pose.shift_mm,
        pose.turn,
    )


@given(seed=st.integers(0, 10**6))
def test_the_jacobian_is_the_residuals_change(seed):
    pose, rng = moving_pose(seed)
    moment = rng.uniform(-0.5, 0.5, len(BORDERS.step))
    seen = pose.to_camera(BORDERS.points_mm, moment)
    rays = seen[:, :2] / seen[:, 2:]
    rows = linearized(pose, rays, moment)
    np.testing.assert_allclose(rows[:, 0], 0, atol=1e-12)
    # Measured on the border itself, its own turn with the pose does not count.
    steps = np.diag([1e-3] * 3 + [1e-6] * 3 + [1e-3] * 3 + [1e-6] * 3)
    for k, step in enumerate(steps):
        after, before = (linearized(pose.moved(sign * step), rays, moment) for sign in (1, -1))
        change = (after[:, 0] - before[:, 0]) / (2 * step[k])
        expected = -rows[:, 1 + k % 6] * (moment if k >= 6 else 1)
        size = np.abs(expected).max()
        np.testing.assert_allclose(change, expected, atol=3e-2 * size + 1e-9)


def test_normal_equations_are_the_plain_products():
    rng = np.random.default_rng(5)
    rows, moment = rng.normal(size=(40, 7)), rng.uniform(-0.5, 0.5, 40)
    weight = rng.uniform(0, 1, 40)
    weight[3] = 0
    for size in (6, 12):
        jacobian = np.column_stack([rows[:, 1:], rows[:, 1:] * moment[:, None]])[:, :size]
        normal, right = kernels.normal_equations(rows, moment, weight, size)
        np.testing.assert_allclose(normal, jacobian.T @ (jacobian * weight[:, None]), atol=1e-12)
        np.testing.assert_allclose(right, jacobian.T @ (weight * rows[:, 0]), atol=1e-12)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("shift_px", [-2.5, 0.0, 1.25])
def test_a_step_is_found_across_its_border(sign, shift_px):
    x = np.arange(60.0)
    values = np.tile(100 + sign * 60 * np.tanh((x - 30 - shift_px) / 1.2), (50, 1))
    middle = np.array([[30.0, 25.0]])
    found = kernels.find_steps(
        values.astype(np.float32),
        middle,
        np.array([[6.0, 0.0]]),
        np.array([[0.0, 3.0]]),
        np.array([sign]),
    )[0]
    assert found[0] * 6 == pytest.approx(shift_px, abs=0.05)
    assert found[1] == pytest.approx(found[2], rel=1e-6)
    assert found[1] == pytest.approx(120, rel=0.05)


def test_a_step_of_the_wrong_sign_is_none():
    values = np.tile(np.where(np.arange(60) > 30, 200, 20), (50, 1)).astype(np.float32)
    arguments = (np.array([[30.0, 25.0]]), np.array([[6.0, 0.0]]), np.array([[0.0, 3.0]]))
    found = kernels.find_steps(values, *arguments, np.array([-1.0]))[0]
    assert found[1] == 0
    assert found[2] > 100


@given(seed=st.integers(0, 10**6))
def test_projection_is_the_plain_one(seed):
    pose, rng = moving_pose(seed)
    camera = small_camera((-0.2, 0.05, 0.001, -0.001))
    points = np.column_stack([rng.uniform(-300, 300, (20, 2)), np.zeros(20)])
    pixels = pose.project(camera, points)
    seen = camera.project(MovingPose(pose.pose).to_camera(points))
    still = MovingPose(pose.pose).project(camera, points)
    np.testing.assert_allclose(still, seen, atol=1e-9)
    assert np.abs(pixels - still).max() < 20
