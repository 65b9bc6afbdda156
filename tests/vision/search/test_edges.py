"""Edge points to a part of a pixel."""

import cv2
import numpy as np
import pytest
from dense_frames import small_camera

from padstudio.vision.frame.pyramid import Plane
from padstudio.vision.search import edges_kernel
from padstudio.vision.search.edges import find_edges, find_steps
from padstudio.vision.stage.params import SearchParams


def step_plane(angle_deg, offset_px, *, low=40.0, high=180.0, blur=1.0, level=0):
    """A straight step whose normal has an angle, offset from the middle."""
    side, over = 160, 8
    y, x = (np.mgrid[: side * over, : side * over] + 0.5) / over - 0.5
    normal = np.array([np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))])
    bright = (x - 80) * normal[0] + (y - 80) * normal[1] > offset_px
    fine = np.where(bright, high, low).astype(np.float32)
    values = cv2.resize(fine, (side, side), interpolation=cv2.INTER_AREA)
    return Plane(cv2.GaussianBlur(values, (0, 0), blur), "red", level, 20, 30), normal


@pytest.mark.parametrize("angle_deg", [0.0, 17.0, 45.0, 90.0, 133.0, 261.0])
@pytest.mark.parametrize("offset_px", [0.0, 0.3, -7.6])
def test_a_step_is_found_where_it_lies(angle_deg, offset_px):
    plane, normal = step_plane(angle_deg, offset_px)
    edges = find_edges(plane, small_camera(), SearchParams())
    local = plane.from_frame(edges.xy)
    inner = (np.abs(local - 80) < 60).all(axis=1)
    off = (local[inner] - 80) @ normal - offset_px
    assert inner.sum() > 80
    assert abs(off.mean()) < 0.06
    assert np.abs(off).max() < 0.25


@pytest.mark.parametrize("level", [0, 2])
@pytest.mark.parametrize("lens", [(0.0,) * 4, (-0.28, 0.09, 0.001, -0.001)])
def test_rays_and_tangent_planes_are_the_cameras(level, lens):
    camera = small_camera(lens)
    plane, normal = step_plane(28.0, 1.0, level=level)
    edges = find_edges(plane, camera, SearchParams())
    np.testing.assert_allclose(edges.rays[:, :2], camera.normalize(edges.xy), atol=2e-3)
    np.testing.assert_allclose(np.linalg.norm(edges.lines, axis=1), 1, atol=1e-9)
    np.testing.assert_allclose((edges.rays * edges.lines).sum(axis=1), 0, atol=1e-9)
    if not any(lens):
        # On a pinhole the tangent plane's normal shows the step's own.
        shown = edges.lines[:, :2] / np.linalg.norm(edges.lines[:, :2], axis=1, keepdims=True)
        assert np.median(np.abs(shown @ normal)) > 0.999


@pytest.mark.parametrize("beyond", range(0, 64, 12))
def test_steepness_is_the_same_wherever_it_lies_in_memory(beyond):
    """Each of square, sum and root is rounded once, as IEEE 754 has it."""
    rng = np.random.default_rng(beyond)
    raw = np.zeros(2 * 97 * 131 * 4 + 64, np.uint8)[beyond:][: 2 * 97 * 131 * 4]
    gx, gy = raw.view(np.float32).reshape(2, 97, 131)
    gx[:], gy[:] = rng.normal(0, 50, (2, 97, 131))
    np.testing.assert_array_equal(edges_kernel.steepness(gx, gy), np.sqrt(gx * gx + gy * gy))
    plane = Plane(rng.integers(0, 256, (97, 131)).astype(np.float32), "red", 0, 0, 0)
    smooth = cv2.GaussianBlur(plane.values, (3, 3), 0)
    gx, gy = (cv2.Scharr(smooth, cv2.CV_32F, *way, scale=1 / 32) for way in ((1, 0), (0, 1)))
    possible = np.sqrt(gx * gx + gy * gy)
    assert np.isin(find_steps(plane, SearchParams()).strength, possible).all()


def test_dim_parts_keep_their_edges():
    bright, _ = step_plane(0.0, 0.0, low=20, high=220)
    dim, _ = step_plane(0.0, 0.0, low=20, high=30)
    both = np.vstack([bright.values, dim.values])
    edges = find_edges(Plane(both, "red", 0, 0, 0), small_camera(), SearchParams())
    assert (edges.xy[:, 1] > 185).sum() > 100


def test_noise_alone_has_few_edges_and_a_flat_plane_none():
    flat = Plane(np.full((120, 160), 90, np.float32), "red", 0, 0, 0)
    assert len(find_edges(flat, small_camera(), SearchParams()).xy) == 0


def test_some_of_the_edges():
    plane, _ = step_plane(10.0, 0.0)
    edges = find_edges(plane, small_camera(), SearchParams())
    which = np.arange(len(edges.xy)) % 3 == 0
    some = edges.take(which)
    np.testing.assert_array_equal(some.xy, edges.xy[which])
    assert len(some.rays) == len(some.lines) == len(some.strength) == which.sum()
