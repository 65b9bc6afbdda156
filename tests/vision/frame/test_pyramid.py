"""Halved frames and the pixels of their parts."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from padstudio.vision.frame.pyramid import Box, Plane, Pyramid

RNG = np.random.default_rng(5)
IMAGE = RNG.integers(0, 256, (101, 150, 3), dtype=np.uint8)


@given(
    level=st.integers(0, 5),
    x0=st.integers(0, 400),
    y0=st.integers(0, 400),
    x=st.floats(-50, 4000),
    y=st.floats(-50, 4000),
)
def test_plane_pixels_and_frame_pixels_are_one_to_one(level, x0, y0, x, y):
    plane = Plane(np.zeros((4, 4), np.float32), "red", level, x0, y0)
    xy = np.array([[x, y]])
    np.testing.assert_allclose(plane.to_frame(plane.from_frame(xy)), xy, atol=1e-9)


def test_a_plane_pixel_is_the_mean_of_the_frame_pixels_that_it_says():
    plane = Pyramid(IMAGE).plane("green", 2, Box(8, 12, 80, 90))
    x, y = plane.to_frame(np.array([[3.0, 5.0]]))[0]
    part = IMAGE[round(y - 1.5) : round(y + 2.5), round(x - 1.5) : round(x + 2.5), 1]
    assert part.shape == (4, 4)
    assert plane.values[5, 3] == pytest.approx(part.mean(), abs=1.0)


def test_a_part_covers_its_box_at_every_level():
    pyramid = Pyramid(IMAGE)
    box = Box(13, 7, 95, 66)
    for level in range(4):
        plane = pyramid.plane("red", level, box)
        h, w = plane.values.shape
        corners = plane.from_frame(np.array([[box.x0, box.y0], [box.x1 - 1, box.y1 - 1]], float))
        assert (corners >= -0.5).all()
        assert (corners <= [w - 0.5, h - 0.5]).all()


@pytest.mark.parametrize(("channel", "index"), [("blue", 0), ("green", 1), ("red", 2)])
def test_channels_are_bgr(channel, index):
    values = Pyramid(IMAGE).plane(channel, 0).values
    assert values.dtype == np.float32
    np.testing.assert_array_equal(values, IMAGE[:, :, index])


def test_levels_never_vanish():
    pyramid = Pyramid(np.zeros((16, 40, 3), np.uint8))
    assert pyramid.level(7).shape == (1, 1, 3)
    assert (pyramid.width, pyramid.height, pyramid.box.side) == (40, 16, 40)
