"""Compiled loops against their plain forms."""

import numpy as np
import pytest
from dense_frames import random_pose, small_camera
from hypothesis import given
from hypothesis import strategies as st

from padstudio.vision import kernels
from padstudio.vision.motion import MovingPose


def moving_pose(seed):
    rng = np.random.default_rng(seed)
    pose = random_pose(rng, 700.0)
    return MovingPose(pose, rng.normal(0, 4, 3), rng.normal(0, 0.004, 3)), rng


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


def test_a_step_in_one_channel_of_a_frame_is_found_where_it_lies():
    x = np.arange(60.0)
    frame = np.zeros((50, 60, 3), np.uint8)
    frame[:, :, 2] = np.round(100 + 60 * np.tanh((x - 30.5) / 1.2))
    found = kernels.find_steps(
        frame[:, :, 2],
        np.array([[30.0, 25.0]]),
        np.array([[6.0, 0.0]]),
        np.array([[0.0, 3.0]]),
        np.array([1.0]),
    )[0]
    assert found[0] * 6 == pytest.approx(0.5, abs=0.05)
