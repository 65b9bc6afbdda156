"""Directions and spacing of the grid lines, against the true plane."""

import numpy as np
import pytest
from dense_frames import edges_of, frame_of, pad_normal, small_camera

from padstudio.geometry.pose import look_at_pad
from padstudio.vision.directions import find_axes, find_lines


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
    assert angle_deg(axes[2], pad_normal(pose)) < 6
    turns = [angle_deg(axes[0], sign * pose.rotation.T[:, k]) for k in (0, 1) for sign in (-1, 1)]
    assert min(turns) < 6


@pytest.mark.parametrize(("channel", "cell_mm", "level"), [("red", 10.0, 0), ("blue", 50.0, 1)])
def test_the_spacing_is_the_cells(channel, cell_mm, level):
    height_mm = 300.0 if channel == "red" else 900.0
    pose = look_at_pad(height_mm, tilt_deg=15, heading_deg=70, tilt_towards_deg=20)
    edges = edges_of(frame_of(pose, camera=small_camera()), channel, level)
    score, axes = find_axes(edges, steep=False)[0]
    lines = find_lines(edges, score, axes)
    assert lines is not None
    # For a plane at distance 1 along the normal; the camera's distance is its height.
    assert lines.pitch == pytest.approx(cell_mm / height_mm, rel=0.02)
    assert lines.contrast > 1
    both = lines.on_u | lines.on_v
    assert not (lines.on_u & lines.on_v).any()
    assert both.mean() > 0.7


def test_edges_without_order_have_no_coherence():
    rng = np.random.default_rng(3)
    noise = rng.integers(0, 255, (480, 640, 3), dtype=np.uint8)
    edges = edges_of(noise)
    assert all(score < 0.3 for score, _ in find_axes(edges, steep=False))


def test_too_few_edges_give_no_spacing():
    edges = edges_of(frame_of(look_at_pad(600.0), camera=small_camera()))
    few = edges.take(np.arange(len(edges.xy)) < 9)
    assert find_lines(few, 1.0, np.eye(3)) is None
