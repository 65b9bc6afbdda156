"""The plane of the grid and the directions of its lines, against the true plane."""

import numpy as np
import pytest
from dense_frames import edges_of, frame_of, pad_normal, small_camera

from padstudio.geometry.pose import look_at_pad
from padstudio.vision.search.plane_normals import find_axes


def angle_deg(a, b):
    return np.degrees(np.arccos(np.clip(a @ b, -1, 1)))


@pytest.mark.parametrize(
    ("tilt_deg", "steep"), [(0.0, False), (20.0, False), (38.0, False), (55.0, True), (70.0, True)]
)
def test_the_planes_normal_and_the_grids_turn(tilt_deg, steep):
    height_mm = 350 * np.cos(np.radians(tilt_deg))
    pose = look_at_pad(height_mm, tilt_deg=tilt_deg, heading_deg=33, tilt_towards_deg=205)
    edges = edges_of(frame_of(pose, camera=small_camera()), "red")
    found = find_axes(edges, steep=steep)
    assert [score for score, _ in found] == sorted((score for score, _ in found), reverse=True)
    # Steep planes have several candidates, of which the lattice decides.
    score, axes = min(found, key=lambda item: angle_deg(item[1][2], pad_normal(pose)))
    assert score > 0.3
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-9)
    assert np.linalg.det(axes) == pytest.approx(1)
    assert angle_deg(axes[2], pad_normal(pose)) < 2
    turns = [angle_deg(axes[0], sign * pose.rotation.T[:, k]) for k in (0, 1) for sign in (-1, 1)]
    assert min(turns) < 2


@pytest.mark.parametrize("towards_deg", [40, 160, 290])
def test_a_steep_plane_is_found_without_looking_for_steep_ones(towards_deg):
    """Coherence alone peaks many degrees off where cells shrink to a third over the picture."""
    pose = look_at_pad(330.0, tilt_deg=60, heading_deg=15, tilt_towards_deg=towards_deg)
    edges = edges_of(frame_of(pose, camera=small_camera()), "blue", 1)
    found = find_axes(edges, steep=False)
    assert min(angle_deg(axes[2], pad_normal(pose)) for _, axes in found) < 3


def test_edges_without_order_have_no_coherence():
    rng = np.random.default_rng(3)
    noise = rng.integers(0, 255, (480, 640, 3), dtype=np.uint8)
    edges = edges_of(noise)
    assert all(score < 0.3 for score, _ in find_axes(edges, steep=False))
