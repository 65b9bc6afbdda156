"""Canny, dilation, and edge points to a part of a pixel."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from paper_frames import HEIGHT, WIDTH, edge_map, small_camera

from padstudio.vision.baseline.edges import find_edge_map
from padstudio.vision.baseline.hough_kernel import BINS
from padstudio.vision.frame.block_mean import Binary
from padstudio.vision.frame.pyramid import Box, Plane
from padstudio.vision.frame.regions import Region
from padstudio.vision.stage.params import PaperParams
from padstudio.vision.stage.trace import Reason, StageFailure

WHOLE = Region(Box(0, 0, WIDTH, HEIGHT), None, 0)


def step_plane(at_px, low=40.0, high=200.0):
    """A plane that is dark left of x = at_px, with a column that is partly so."""
    x = np.arange(WIDTH)
    share = np.clip(x + 0.5 - at_px, 0, 1)
    values = np.tile(low + (high - low) * share, (HEIGHT, 1)).astype(np.float32)
    return Plane(values, "red", 0, 0, 0)


def threshold(plane, at=120.0):
    mask = (plane.values > at).astype(np.uint8) * 255
    return Binary(mask, plane, float((mask > 0).mean()))


@given(st.floats(200.0, 400.0))
def test_a_step_is_found_to_a_part_of_a_pixel(at_px):
    edges = find_edge_map(threshold(step_plane(at_px)), WHOLE, small_camera(), 2, PaperParams())
    assert np.abs(edges.points[:, 0] - at_px).max() < 0.2


def test_dilation_covers_the_edge_and_its_neighbours():
    edges = find_edge_map(threshold(step_plane(300.0)), WHOLE, small_camera(), 2, PaperParams())
    row = np.flatnonzero(edges.thin[HEIGHT // 2])
    assert len(row) == 1
    assert np.flatnonzero(edges.mask[HEIGHT // 2]).tolist() == [row[0] - 1, row[0], row[0] + 1]


@given(st.floats(0, math.pi), st.sampled_from([(40.0, 200.0), (200.0, 40.0)]))
def test_each_pixel_of_an_edge_knows_its_normal(angle, grey):
    x, y = np.meshgrid(np.arange(WIDTH) - WIDTH / 2, np.arange(HEIGHT) - HEIGHT / 2)
    share = np.clip(x * math.cos(angle) + y * math.sin(angle) + 0.5, 0, 1)
    values = (grey[0] + (grey[1] - grey[0]) * share).astype(np.float32)
    plane = Plane(values, "red", 0, 0, 0)
    edges = find_edge_map(threshold(plane), WHOLE, small_camera(), 2, PaperParams())
    assert len(edges.normals) == np.count_nonzero(edges.mask)
    off = (edges.normals - angle / math.pi * BINS + BINS / 2) % BINS - BINS / 2
    # Half of what they may be off to vote for their line; the ends lie at the picture's borders.
    assert np.percentile(np.abs(off), 95) < 10


def test_edges_off_the_pads_colour_are_dropped():
    mask = np.zeros((HEIGHT, WIDTH), bool)
    mask[: HEIGHT // 2] = True
    region = Region(Box(0, 0, WIDTH, HEIGHT), mask, 0)
    edges = find_edge_map(threshold(step_plane(300.0)), region, small_camera(), 2, PaperParams())
    rows = np.nonzero(edges.thin)[0]
    assert rows.min() < 5
    assert rows.max() == HEIGHT // 2 - 1


def test_nothing_to_see_is_a_failure_with_figures():
    flat = Plane(np.full((HEIGHT, WIDTH), 90, np.float32), "blue", 0, 0, 0)
    found = find_edge_map(threshold(flat), WHOLE, small_camera(), 2, PaperParams())
    assert isinstance(found, StageFailure)
    assert found.reason is Reason.NO_EDGES
    assert "0 edge pixels in blue" in found.detail


def test_with_more_levels_steps_between_bright_levels_count():
    plane = step_plane(320.0, 150.0, 250.0)
    plane.values[:, :100] = 0.0
    binary = threshold(plane)
    columns = [
        set(
            np.nonzero(find_edge_map(binary, WHOLE, small_camera(), levels, PaperParams()).thin)[1]
            // 10
        )
        for levels in (2, 3)
    ]
    assert 9 in columns[1] or 10 in columns[1]
    assert 31 in columns[1] or 32 in columns[1]
    assert len(columns[1]) > len(columns[0])


@pytest.mark.parametrize("distortion", [(0.0, 0.0, 0.0, 0.0), (-0.28, 0.09, 6e-4, -4e-4)])
def test_straightening_and_bending_are_inverse(distortion):
    edges = edge_map(small_camera(distortion))
    xy = np.random.default_rng(3).uniform((0, 0), (WIDTH - 1, HEIGHT - 1), (200, 2))
    np.testing.assert_allclose(edges.bend(edges.straighten(xy)), xy, atol=1e-6)


def test_a_line_that_the_lens_bends_comes_out_straight():
    camera = small_camera((-0.28, 0.09, 6e-4, -4e-4))
    rays = np.column_stack([np.linspace(-0.6, 0.6, 50), np.full(50, 0.42)])
    straight = edge_map(camera).straighten(camera.denormalize(rays))
    assert np.ptp(camera.denormalize(rays)[:, 1]) > 5
    assert np.ptp(straight[:, 1]) < 1e-6
