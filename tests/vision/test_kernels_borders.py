"""The compiled search for steps across borders."""

import math

import numpy as np
import pytest

from padstudio.vision import kernels_borders


def step_in(values, sign):
    """Of a border at (30, 25), found within 6 pixels to its left and right."""
    return kernels_borders.find_step(values, 30.0, 25.0, 6.0, 0.0, 0.0, 3.0, sign)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("shift_px", [-2.5, 0.0, 1.25])
def test_a_step_is_found_across_its_border(sign, shift_px):
    x = np.arange(60.0)
    values = np.tile(100 + sign * 60 * np.tanh((x - 30 - shift_px) / 1.2), (50, 1))
    shift, rise, spent = step_in(values.astype(np.float32), sign)
    assert shift * 6 == pytest.approx(shift_px, abs=0.05)
    assert rise == pytest.approx(spent, rel=1e-6)
    assert rise == pytest.approx(120, rel=0.05)


def test_a_step_of_the_wrong_sign_is_none():
    values = np.tile(np.where(np.arange(60) > 30, 200, 20), (50, 1)).astype(np.float32)
    _, rise, spent = step_in(values, -1.0)
    assert rise == 0
    assert spent > 100


def test_a_step_in_one_channel_of_a_frame_is_found_where_it_lies():
    x = np.arange(60.0)
    frame = np.zeros((50, 60, 3), np.uint8)
    frame[:, :, 2] = np.round(100 + 60 * np.tanh((x - 30.5) / 1.2))
    assert step_in(frame[:, :, 2], 1.0)[0] * 6 == pytest.approx(0.5, abs=0.05)


def test_steps_that_lean_toward_the_dark_are_told_from_a_shift():
    rng = np.random.default_rng(4)
    upright, rising = rng.random(400) < 0.5, rng.random(400) < 0.5
    off = np.where(rising, 0.3, -0.3) * np.where(upright, 1.0, 0.5) + 0.8
    off += rng.normal(0, 0.01, 400)
    left = off - kernels_borders.lean(off, upright, rising)
    np.testing.assert_allclose(left, 0.8, atol=0.05)
    few = np.arange(400) < 20
    np.testing.assert_array_equal(kernels_borders.lean(off[few], upright[few], rising[few]), 0)


@pytest.mark.parametrize("blur_px", [0.5, 0.8, 1.2])
def test_sharp_steps_are_not_drawn_to_the_pixels(blur_px):
    """Wherever between two pixels a step lies, it is found there."""
    for at in np.linspace(30, 31, 9):
        edge = [math.erf((x - at) / (blur_px * math.sqrt(2))) for x in range(60)]
        values = np.tile(100 + 60 * np.array(edge, np.float32), (50, 1))
        shift, _, _ = kernels_borders.find_step(values, at, 25.0, 6.0, 0.0, 0.0, 3.0, 1.0)
        assert shift * 6 == pytest.approx(0, abs=0.1 if blur_px < 0.8 else 0.025)
