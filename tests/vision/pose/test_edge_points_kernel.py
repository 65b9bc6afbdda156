"""The compiled search for steps across borders."""

import math

import numpy as np
import pytest

from padstudio.vision.frame.pyramid import NO_COLOURS, Pyramid, Window
from padstudio.vision.pose import edge_points_kernel


def step_in(values, sign, at=30.0):
    """Of a border at (at, 25), found within 6 pixels to its left and right."""
    values = np.round(values).astype(np.uint8)
    return step_of(Window(values, NO_COLOURS, values.shape[1], 1.0), sign, at)


def step_of(window, sign, at=30.0):
    profile = edge_points_kernel.Profile((at, 25.0), (6.0, 0.0), (0.0, 3.0))
    samples = np.empty((7, edge_points_kernel._SAMPLES))
    return edge_points_kernel.find_step(window, profile, sign, samples)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("shift_px", [-2.5, 0.0, 1.25])
def test_a_step_is_found_across_its_border(sign, shift_px):
    x = np.arange(60.0)
    values = np.tile(100 + sign * 60 * np.tanh((x - 30 - shift_px) / 1.2), (50, 1))
    shift, _, rise, spent = step_in(values, sign)
    assert shift * 6 == pytest.approx(shift_px, abs=0.05)
    assert rise == pytest.approx(spent, rel=1e-6)
    assert rise == pytest.approx(120, rel=0.05)


@pytest.mark.parametrize("blur_px", [1.0, 1.5, 2.0])
def test_the_width_of_a_step_is_that_of_its_blur(blur_px):
    x = np.arange(60.0)
    blurred = [math.erf((place - 30.3) / blur_px / math.sqrt(2)) for place in x]
    values = np.tile(110 + 70 * np.array(blurred), (50, 1))
    _, width, _, _ = step_in(values, 1.0)
    assert width * 36 == pytest.approx(blur_px**2 + edge_points_kernel._SMOOTHED * 36, rel=0.15)


def test_a_step_of_the_wrong_sign_is_none():
    values = np.tile(np.where(np.arange(60) > 30, 200, 20), (50, 1))
    _, _, rise, spent = step_in(values, -1.0)
    assert rise == 0
    assert spent > 100


def test_a_step_in_one_channel_of_a_frame_is_found_where_it_lies():
    x = np.arange(60.0)
    frame = np.zeros((50, 60, 3), np.uint8)
    frame[:, :, 2] = np.round(100 + 60 * np.tanh((x - 30.5) / 1.2))
    window = Pyramid(frame).window("red", 0)
    assert step_of(window, 1.0)[0] * 6 == pytest.approx(0.5, abs=0.05)


@pytest.mark.parametrize("level", [0, 1])
def test_a_step_in_brightness_and_colour_is_found_where_both_have_it(level):
    """Colours lie at half the scale of the frame's own brightness."""
    x = np.arange(60.0)
    wide, half = np.tanh((x - 30.8) / 1.4), np.tanh((2 * x[:30] + 0.5 - 30.8) / 1.4)
    bright = np.tile(np.round(90 + 15 * wide), (50, 1)).astype(np.uint8)
    colours = np.tile(np.round(120 + 40 * (half if level == 0 else wide)), (50, 1))
    scale, shift = (0.5, -0.25) if level == 0 else (1.0, 0.0)
    window = Window(bright, colours.astype(np.uint8), 60, 1.0, weight=1.4, scale=scale, shift=shift)
    found, _, rise, spent = step_of(window, 1.0)
    assert found * 6 == pytest.approx(0.8, abs=0.06)
    assert rise == pytest.approx(2 * (15 + 1.4 * 40), rel=0.1)
    assert spent == pytest.approx(rise, rel=0.02)


def test_an_edge_bias_toward_the_dark_is_told_from_a_shift():
    rng = np.random.default_rng(4)
    upright, rising = rng.random(400) < 0.5, rng.random(400) < 0.5
    off = np.where(rising, 0.3, -0.3) * np.where(upright, 1.0, 0.5) + 0.8
    off += rng.normal(0, 0.01, 400)
    bias = edge_points_kernel.edge_bias
    left = off - bias(off, upright, rising)
    np.testing.assert_allclose(left, 0.8, atol=0.05)
    few = np.arange(400) < 20
    np.testing.assert_array_equal(bias(off[few], upright[few], rising[few]), 0)


@pytest.mark.parametrize("blur_px", [0.5, 0.8, 1.2])
def test_sharp_steps_are_not_drawn_to_the_pixels(blur_px):
    """Wherever between two pixels a step lies, it is found there."""
    for at in np.linspace(30, 31, 9):
        edge = [math.erf((x - at) / (blur_px * math.sqrt(2))) for x in range(60)]
        values = np.tile(100 + 60 * np.array(edge), (50, 1))
        shift, *_ = step_in(values, 1.0, at)
        assert shift * 6 == pytest.approx(0, abs=0.1 if blur_px < 0.8 else 0.025)
