"""Numbered grid lines against the true corners."""

import numpy as np
import pytest
from dense_frames import edges_of, frame_of, random_pad, sample_pad, small_camera

from padstudio.geometry.pose import look_at_pad
from padstudio.simulate.render import corners_px
from padstudio.vision.search.lattice import _coarser, find_lattice
from padstudio.vision.search.line_spacing import find_lines
from padstudio.vision.search.plane_normals import find_axes


def lattice_in(image, channel, camera, *, level=0, steep=False):
    edges = edges_of(image, channel, level, camera)
    score, axes = find_axes(edges, steep=steep)[0]
    families = find_lines(edges, score, axes)
    return None if families is None else find_lattice(families)


def coordinates_of(lattice, rays):
    """Lattice coordinates (N, 2) of rays (N, 3)."""
    found = rays @ np.linalg.inv(lattice.ray_from_lattice).T
    return found[:, :2] / found[:, 2:]


@pytest.mark.parametrize(
    ("channel", "height_mm", "tilt_deg", "lens"),
    [
        ("red", 250.0, 0.0, (0.0,) * 4),
        ("red", 400.0, 35.0, (0.0,) * 4),
        ("blue", 900.0, 25.0, (0.0,) * 4),
        ("red", 300.0, 65.0, (0.0,) * 4),
        ("blue", 700.0, 10.0, (-0.28, 0.09, 0.001, -0.001)),
    ],
)
def test_whole_numbers_lie_on_corners(channel, height_mm, tilt_deg, lens):
    camera = small_camera(lens)
    level = 0 if channel == "red" else 1
    pose = look_at_pad(height_mm, tilt_deg=tilt_deg, heading_deg=25, tilt_towards_deg=300)
    lattice = lattice_in(
        frame_of(pose, camera=camera), channel, camera, level=level, steep=tilt_deg > 45
    )
    assert lattice is not None
    assert lattice.inlier_share > 0.75
    true = corners_px(camera, pose, sample_pad(), channel).reshape(-1, 2)
    inside = (true > 5).all(axis=1) & (true < [camera.width - 6, camera.height - 6]).all(axis=1)
    rays = np.column_stack([camera.normalize(true[inside]), np.ones(inside.sum())])
    at = coordinates_of(lattice, rays)
    off = np.abs(at - np.round(at))
    assert np.median(off) < 0.05
    assert np.percentile(off, 95) < 0.2
    low, high = at.min(axis=0), at.max(axis=0)
    if (true[~inside] > 0).any():
        return
    assert lattice.columns[0] == pytest.approx(low[0], abs=2)
    assert lattice.rows[1] == pytest.approx(high[1], abs=2)


def test_rays_and_lattice_coordinates_are_one_to_one():
    camera = small_camera()
    pose = look_at_pad(300.0, tilt_deg=20, heading_deg=50)
    lattice = lattice_in(frame_of(pose, camera=camera), "red", camera)
    assert lattice is not None
    at = np.random.default_rng(0).uniform(-5, 5, (50, 2))
    rays = np.column_stack([lattice.to_rays(at), np.ones(50)])
    np.testing.assert_allclose(coordinates_of(lattice, 3.7 * rays), at, atol=1e-8)


def test_noise_has_no_order():
    rng = np.random.default_rng(9)
    image = rng.integers(0, 255, (480, 640, 3), dtype=np.uint8)
    lattice = lattice_in(image, "red", small_camera())
    assert lattice is None or lattice.inlier_share < 0.6


@pytest.mark.parametrize("cells_across", [4.5, 5.0, 5.5, 6.0])
@pytest.mark.parametrize("heading_deg", [12.0, 71.0])
def test_few_large_cells_are_not_taken_for_many_small_ones(cells_across, heading_deg):
    """Parts of the spacing explain every edge, too."""
    pad = random_pad(3, cells=(25,), cell_mm=(50.0,), channels=("blue",))
    camera = small_camera()
    pose = look_at_pad(cells_across * 50 * 440 / 480, heading_deg=heading_deg, target_mm=(90, 70))
    image = frame_of(pose, pad=pad, camera=camera)
    lattice = lattice_in(image, "blue", camera, level=2)
    assert lattice is not None
    corners = lattice.to_rays(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]))
    cell_px = np.linalg.norm(camera.denormalize(corners[1:]) - camera.denormalize(corners[:1]))
    assert cell_px / np.sqrt(2) == pytest.approx(480 / cells_across, rel=0.1)


def test_lines_that_a_code_leaves_empty_are_no_spacing():
    everywhere = np.repeat(np.arange(12), 5).astype(float)
    assert _coarser(everywhere, everywhere) is None
    assert _coarser(everywhere, 2 * everywhere) is None
    for times in (2, 3, 5):
        wider = _coarser(times * everywhere, times * everywhere + 1)
        np.testing.assert_allclose(wider @ [2 * times, 3 * times + 1, 1], [2, 3, 1])
    few = np.repeat([0.0, 2.0], 20)
    assert _coarser(few, few) is None
