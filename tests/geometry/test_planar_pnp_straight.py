"""The planar pose of a camera that looks straight down, and how sure its tilt is."""

import numpy as np
import pytest

from padstudio.geometry.planar_pnp import ambiguity, planar_pose
from padstudio.geometry.pose import look_at_pad, rotation_angle_deg


def seen_from(pose, side_mm, count):
    steps = np.linspace(-side_mm / 2, side_mm / 2, count)
    points = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    points = np.column_stack([points, np.zeros(len(points))])
    rays = (points - pose.position_mm) @ pose.rotation
    return points, rays[:, :2] / rays[:, 2:]


@pytest.mark.parametrize("count", [2, 5])
@pytest.mark.parametrize("heading", [0.0, 33.0, 90.0, 180.0])
def test_a_plane_seen_straight_on_has_its_pose(count, heading):
    pose = look_at_pad(800.0, heading_deg=heading, target_mm=(40.0, -25.0))
    found = planar_pose(*seen_from(pose, 400.0, count))
    assert found is not None
    assert np.allclose(found.pose.position_mm, pose.position_mm, atol=1e-3)
    assert rotation_angle_deg(found.pose.rotation, pose.rotation) < 1e-3


def test_the_mirrored_pose_is_doubtful_from_afar_and_not_nearby():
    sigma = 1e-4
    near = look_at_pad(500.0, tilt_deg=20.0)
    far = look_at_pad(40_000.0, tilt_deg=20.0)
    points, _ = seen_from(near, 400.0, 2)
    assert ambiguity(near, points, sigma) < 0.01
    assert ambiguity(far, points, sigma) > 0.5
