"""Compiled loops against their plain forms."""

import numpy as np
from dense_frames import random_pose, seen_by, small_camera
from hypothesis import given
from hypothesis import strategies as st

from padstudio.geometry.rolling_shutter import MovingPose


def moving_pose(seed):
    rng = np.random.default_rng(seed)
    pose = random_pose(rng, 700.0)
    return MovingPose(pose, rng.normal(0, 4, 3), rng.normal(0, 0.004, 3)), rng


@given(seed=st.integers(0, 10**6))
def test_projection_is_the_plain_one(seed):
    pose, rng = moving_pose(seed)
    camera = small_camera((-0.2, 0.05, 0.001, -0.001))
    points = np.column_stack([rng.uniform(-300, 300, (20, 2)), np.zeros(20)])
    pixels = pose.project(camera, points)
    seen = camera.project(seen_by(MovingPose(pose.pose), points))
    still = MovingPose(pose.pose).project(camera, points)
    np.testing.assert_allclose(still, seen, atol=1e-9)
    assert np.abs(pixels - still).max() < 20
