"""Axes by even spacing, where directions hardly show."""

from dataclasses import replace

import numpy as np
import pytest
from dense_frames import edges_of, frame_of, pad_normal, small_camera

from padstudio.geometry.pose import look_at_pad
from padstudio.vision.search.periodic_axes import find_periodic_axes


@pytest.mark.parametrize(("tilt_deg", "heading_deg"), [(3, 10), (14, 50), (24, 80)])
def test_axes_of_edges_whose_directions_are_noise(tilt_deg, heading_deg):
    camera, rng = small_camera(), np.random.default_rng(3)
    pose = look_at_pad(900.0, tilt_deg=tilt_deg, heading_deg=heading_deg)
    edges = edges_of(frame_of(pose, camera=camera), "blue", 1, camera)
    # Each edge turned by some 20 degrees about its ray.
    rays = edges.rays / np.linalg.norm(edges.rays, axis=1, keepdims=True)
    turn = rng.normal(0, np.radians(20), len(rays))[:, None]
    lines = edges.lines * np.cos(turn) + np.cross(rays, edges.lines) * np.sin(turn)
    contrast, axes = find_periodic_axes(replace(edges, lines=lines))
    assert contrast > 10
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-9)
    normal = pad_normal(pose)
    assert np.degrees(np.arccos(abs(axes[2] @ normal))) < 8
    along = pose.rotation.T @ np.array([1.0, 0, 0])
    off = np.degrees(np.arctan2(axes[1] @ along, axes[0] @ along))
    assert abs((off + 45) % 90 - 45) < 5
