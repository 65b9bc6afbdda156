"""Compiled loops of the search."""

import cv2
import numpy as np
import pytest
from dense_frames import random_pose

from padstudio.vision.search import search_kernel as kernels


def test_coherence_is_whole_for_a_grid_seen_squarely_and_low_elsewhere():
    """Edges along two directions at right angles on a known plane."""
    rng = np.random.default_rng(8)
    pose = random_pose(rng, 500.0, tilt_deg=25.0)
    points = np.column_stack([rng.uniform(-150, 150, (300, 2)), np.zeros(300)])
    along = np.where(rng.random(300)[:, None] < 0.5, [1.0, 0, 0], [0, 1.0, 0])
    a, b = (pose.to_camera(points + side * along) for side in (-1, 1))
    lines = np.cross(a, b)
    lines /= np.linalg.norm(lines, axis=1, keepdims=True)
    rays = pose.to_camera(points)
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    true = -pose.rotation.T[:, 2]
    tilted = np.array([true + 0.35 * np.roll(np.eye(3)[0], k) for k in range(3)])
    normals = np.vstack([true, tilted / np.linalg.norm(tilted, axis=1, keepdims=True)])
    found = np.abs(kernels.coherence(normals, kernels.Edges(rays, lines)))
    assert found[0] > 0.95
    assert (found[1:] < found[0]).all()
    assert (found <= 1 + 1e-9).all()


def test_axes_are_turned_to_where_edges_point():
    rng = np.random.default_rng(11)
    true = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    true[2] = np.cross(true[0], true[1])
    rays = np.column_stack([rng.uniform(-0.5, 0.5, (600, 2)), np.ones(600)])
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    lines = np.cross(rays, true[rng.integers(0, 2, 600)]) + rng.normal(0, 0.01, (600, 3))
    # A third of the edges is clutter.
    lines[::3] = np.cross(rays[::3], rng.normal(size=(200, 3)))
    lines /= np.linalg.norm(lines, axis=1, keepdims=True)
    off = cv2.Rodrigues(np.array([0.12, -0.1, 0.08]))[0]
    found = kernels.turn_axes(true @ off, kernels.Edges(rays, lines))
    np.testing.assert_allclose(found @ found.T, np.eye(3), atol=1e-9)
    assert np.linalg.det(found) == pytest.approx(1)
    assert np.abs(found - true).max() < 0.01
