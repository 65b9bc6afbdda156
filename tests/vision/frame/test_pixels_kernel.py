"""The compiled looks at few pixels against their plain forms."""

import cv2
import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from padstudio.vision.frame import pixels_kernel
from padstudio.vision.frame.pyramid import NO_COLOURS, Pyramid, Window, halved


@given(
    height=st.integers(2, 40), width=st.integers(2, 40), more=st.integers(0, 9), seed=st.integers(0)
)
def test_planes_are_halved_as_pictures_are(height, width, more, seed):
    rows = np.random.default_rng(seed).integers(0, 256, (height, width + more)).astype(np.uint8)
    found = pixels_kernel.halved(rows, width)
    np.testing.assert_array_equal(found, halved(np.ascontiguousarray(rows[:, :width])))


def test_values_lie_between_those_of_four_pixels():
    rng = np.random.default_rng(3)
    frame = rng.integers(0, 256, (20, 30, 3)).astype(np.uint8)
    window = Pyramid(frame).window("blue", 0)
    for x, y in rng.uniform(0, 18, (200, 2)):
        found = pixels_kernel.between(window.values, window.step, window.first, x, y)
        c, r = int(x), int(y)
        part = frame[r : r + 2, c : c + 2, 0].astype(float)
        weights = np.outer([1 - y + r, y - r], [1 - x + c, x - c])
        np.testing.assert_allclose(found, (part * weights).sum(), atol=1e-9)


def test_impulses_of_a_blurred_picture_are_none():
    noise = np.random.default_rng(1).integers(0, 256, (120, 160, 3)).astype(np.uint8)
    smooth = cv2.GaussianBlur(noise, (0, 0), 3)
    corners = np.array([[0, 0], [60, 20]])
    for frame, some in ((smooth, False), (noise, True)):
        window = Pyramid(frame).brightness
        found = pixels_kernel.impulses(window, corners, 90, 8.0, 247.0, 60.0)
        assert (found > 0) == some


def test_impulses_are_counted_alike_in_every_form_of_a_picture():
    rng = np.random.default_rng(2)
    bright = rng.integers(60, 190, (80, 90)).astype(np.uint8)
    at = rng.integers(5, 75, (30, 2))
    bright[at[:, 0], at[:, 1]] = np.where(rng.random(30) < 0.5, 2, 253)
    spots = len(np.unique(at, axis=0))
    windows = [
        Pyramid(np.repeat(bright[:, :, None], 3, axis=2)).brightness,
        Window(bright, NO_COLOURS, 90, 1.0),
        # As of a video whose black is 16 and white 235.
        Window(
            np.round(bright.astype(float) * 219 / 255 + 16).astype(np.uint8),
            NO_COLOURS,
            90,
            1.0,
            gain=255 / 219,
            black=-16 * 255 / 219,
        ),
    ]
    for window in windows:
        found = pixels_kernel.impulses(window, np.array([[0, 0]]), 80, 8.0, 247.0, 30.0)
        assert 0.8 * spots <= found <= spots
