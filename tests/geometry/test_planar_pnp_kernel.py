"""The compiled poses from points."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from padstudio.geometry import planar_pnp_kernel
from padstudio.geometry.planar_pnp import planar_pose
from padstudio.geometry.pose import look_at_pad, rotation_angle_deg
from padstudio.geometry.rolling_shutter import MovingPose

CORNERS = np.array([[x, y, 0.0] for x in (-300.0, 300.0) for y in (-250.0, 250.0)])


@given(seed=st.integers(0, 10**6))
def test_points_lead_back_to_their_pose(seed):
    rng = np.random.default_rng(seed)
    truth = look_at_pad(800.0, tilt_deg=rng.uniform(10, 60), heading_deg=rng.uniform(0, 360))
    points = np.column_stack([rng.uniform(-300, 300, (9, 2)), np.zeros(9)])
    seen = (points - truth.position_mm) @ truth.rotation
    start = MovingPose(truth).moved(np.append(rng.normal(0, 20, 3), rng.normal(0, 0.03, 3))).pose
    squares, rotation, centre = planar_pnp_kernel.fit_points(
        points, seen[:, :2] / seen[:, 2:], start.rotation, start.position_mm, 30
    )
    assert squares < 1e-16
    np.testing.assert_allclose(centre, truth.position_mm, atol=1e-3)
    np.testing.assert_allclose(rotation, truth.rotation, atol=1e-6)


def test_points_behind_the_camera_are_no_picture():
    pose = look_at_pad(500.0)
    behind = np.array([[0.0, 0, 900.0], [10, 0, 900], [0, 10, 900], [10, 10, 900]])
    assert np.isinf(
        planar_pnp_kernel.fit_points(behind, np.zeros((4, 2)), pose.rotation, pose.position_mm, 5)[
            0
        ]
    )


@pytest.mark.parametrize("tilt_deg", [8.0, 20.0, 40.0])
@pytest.mark.parametrize("height_mm", [900.0, 6000.0])
def test_the_mirrored_pose_is_the_other_answer_of_the_closed_form(tilt_deg, height_mm):
    pose = look_at_pad(height_mm, tilt_deg=tilt_deg, heading_deg=70, tilt_towards_deg=200)
    seen = (CORNERS - pose.position_mm) @ pose.rotation
    rays = seen[:, :2] / seen[:, 2:]
    both = planar_pose(CORNERS, rays)
    squares, rotation = planar_pnp_kernel.fit_mirrored(CORNERS, pose.rotation, pose.position_mm, 30)
    if both.other is None:
        assert rotation_angle_deg(rotation, pose.rotation) < 0.05
        return
    assert rotation_angle_deg(rotation, both.other.rotation) < 0.05
    assert np.sqrt(squares / 4) == pytest.approx(both.error / both.ambiguity, rel=1e-3, abs=1e-9)


def test_a_plane_seen_straight_on_is_its_own_mirror_image():
    pose = look_at_pad(2000.0, heading_deg=30)
    squares, rotation = planar_pnp_kernel.fit_mirrored(CORNERS, pose.rotation, pose.position_mm, 30)
    assert squares < 1e-16
    assert rotation_angle_deg(rotation, pose.rotation) < 0.05
