"""The compiled reading of cells against its plain form."""

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from padstudio.vision.cells import cells_kernel
from padstudio.vision.frame.pyramid import Pyramid


@pytest.mark.parametrize("level", [0, 1, 2])
def test_values_are_those_between_the_pixels(level):
    rng = np.random.default_rng(level)
    frame = rng.integers(0, 256, (120, 160, 3)).astype(np.uint8)
    pyramid = Pyramid(frame)
    window = pyramid.window("red", level)
    xy = rng.uniform(8, 110, (9, 11, 2))
    seen = rng.random((9, 11)) < 0.8
    found = cells_kernel.sample(window, xy, seen)
    at = window.from_frame(xy.reshape(-1, 2)).reshape(xy.shape).astype(np.float32)
    picture = pyramid.plane("red", level).values
    # OpenCV rounds places to 1/32 of a pixel.
    plain = cv2.remap(picture, at[..., 0], at[..., 1], cv2.INTER_LINEAR)
    np.testing.assert_allclose(found[seen], plain[seen], atol=255 * 2 / 32)
    assert np.abs(found[seen] - plain[seen]).mean() < 3
    assert not found[~seen].any()


@given(st.integers(1, 30), st.integers(1, 30), st.integers(2, 5))
def test_what_changes_evenly_is_spread_exactly(rows, cols, every):
    r, c = np.meshgrid(np.arange(rows), np.arange(cols), indexing="ij")
    plain = np.stack([3 * c - 2 * r + 5.0, 0.5 * r * c], axis=-1)
    r, c = np.meshgrid(
        np.arange(0, rows + every - 1, every), np.arange(0, cols + every - 1, every), indexing="ij"
    )
    nodes = np.stack([3 * c - 2 * r + 5.0, 0.5 * r * c], axis=-1)
    found = cells_kernel.spread(nodes, every, (rows, cols))
    np.testing.assert_allclose(found, plain, atol=1e-9)


def test_cells_are_as_wide_as_their_shorter_side():
    x, y = np.meshgrid(np.arange(40) * 12.0, np.arange(30) * 7.0)
    xy = np.stack([x, y], axis=-1)
    seen = np.ones(x.shape, bool)
    assert cells_kernel.width_px(xy, seen) == pytest.approx(7.0)
    assert cells_kernel.width_px(xy.swapaxes(0, 1).copy(), seen.T.copy()) == pytest.approx(7.0)
    assert cells_kernel.width_px(xy[:1], seen[:1]) == pytest.approx(12.0)
    assert cells_kernel.width_px(xy, np.zeros_like(seen)) == 1.0


def test_cells_far_smaller_than_others_are_left_out():
    """A plane toward the horizon: rows of cells that shrink upward."""
    height = np.cumsum(np.geomspace(0.5, 12, 30))
    x, y = np.meshgrid(np.arange(25) * 8.0, height)
    xy = np.stack([x, y], axis=-1)
    seen = np.ones(x.shape, bool)
    cells_kernel.leave_out_small(xy, seen, 2.0, 60)
    steps = np.append(np.diff(height), np.diff(height)[-1])
    np.testing.assert_array_equal(seen, np.repeat((steps >= 2.0)[:, None], 25, axis=1))
    few = np.ones(x.shape, bool)
    cells_kernel.leave_out_small(xy, few, 2.0, 10_000)
    assert few.all()


@given(
    rows=st.integers(1, 14),
    cols=st.integers(1, 14),
    block=st.sampled_from([3, 9]),
    seed=st.integers(0, 1000),
)
def test_blocks_are_those_cut_out(rows, cols, block, seed):
    rng = np.random.default_rng(seed)
    values = rng.uniform(0, 255, (rows, cols)).astype(np.float32)
    seen = rng.random((rows, cols)) < 0.7
    found, half = cells_kernel.relative(values, seen, block), block // 2
    for r, c in np.ndindex(rows, cols):
        part = np.s_[max(r - half, 0) : r + half + 1, max(c - half, 0) : c + half + 1]
        there = values[part][seen[part]].astype(float)
        plain = (values[r, c] - there.mean()) / max(there.std(), 0.5) if seen[r, c] else 0.0
        assert abs(found[r, c] - plain) < 1e-4
