"""Profiles across a side, and lines through their steps, where both are known."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from padstudio.vision.outline import sides_kernel as kernel

STEPS = np.linspace(-1, 1, 25)


@given(st.floats(-0.3, 0.3), st.floats(1, 100), st.floats(-50, 50), st.floats(0.02, 0.12))
def test_a_rise_is_half_way_where_it_is(at: float, rise: float, low: float, width: float) -> None:
    rising = low + rise / (1 + np.exp(-(STEPS - at) / (width / 2)))
    shift, good = kernel.half_way(np.stack([rising, rising, rising[::-1]]))
    # Tails of the step count as pad and ground.
    assert shift[:2] == pytest.approx(at, abs=0.02)
    assert good.tolist() == [True, True, False]


def test_profiles_that_rise_like_no_others_do_not_count() -> None:
    step = (STEPS > 0).astype(float)
    heights = [1.0, 1.0, 1.0, 0.3, 3.0, -1.0]
    good = kernel.half_way(np.stack([height * step for height in heights]))[1]
    assert good.tolist() == [True, True, True, False, False, False]
    assert not kernel.half_way(np.zeros((4, 25)))[1].any()


def test_contrast_is_the_step_in_units_of_its_scatter() -> None:
    rng = np.random.default_rng(3)
    values = (STEPS > 0) * 8.0 + rng.normal(size=(400, 1)) * 2
    assert kernel.contrast(values) == pytest.approx(4, rel=0.15)
    assert kernel.contrast(np.zeros((4, 25))) == 0


@given(st.integers(0, 2**32 - 1), st.floats(0, np.pi))
def test_a_line_goes_through_most_points(seed: int, turn: float) -> None:
    rng = np.random.default_rng(seed)
    focal_px = 900.0
    normal = np.array([np.cos(turn), np.sin(turn)])
    along = np.array([-normal[1], normal[0]])
    off_px = rng.normal(0, 0.2, 80)
    off_px[:16] += rng.choice([-1, 1]) * rng.uniform(5, 15, 16)
    points = (
        np.linspace(-0.4, 0.4, 80)[:, None] * along + (0.1 + off_px / focal_px)[:, None] * normal
    )
    points = points[rng.permutation(80)]
    line, off, sigma = kernel.robust_line(points, focal_px)
    assert abs(line[:2] @ normal) == pytest.approx(1, abs=1e-5)
    assert abs(line[2]) * focal_px == pytest.approx(90, abs=0.3)
    assert off == pytest.approx((points @ line[:2] + line[2]) * focal_px)
    assert 0.1 < sigma < 0.6
