"""Levels are told apart however bright the middle ones are, in any even or uneven light."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from padstudio.vision.cells import cells_kernel, levels_kernel

BLOCK = 9


def read(values, seen, count):
    relative = cells_kernel.relative(values.astype(np.float32), seen, BLOCK)
    cuts = levels_kernel.cuts(relative, seen, count, BLOCK)
    return levels_kernel.to_levels(relative, seen, cuts), relative, cuts


@pytest.mark.parametrize("count", [2, 3, 4, 6])
def test_levels_of_even_spacing(count):
    field = np.random.default_rng(count).integers(0, count, (40, 40))
    seen = np.ones(field.shape, bool)
    seen[3, 4] = False
    found, relative, cuts = read(30.0 * field, seen, count)
    assert found.dtype == np.int8
    assert found[3, 4] == -1
    assert (found[seen] == field[seen]).mean() > (0.999 if count > 2 else 0.99)
    # What the cuts say is what is told.
    assert ((relative[..., None] > cuts).sum(-1) == found)[seen].all()
    assert (np.diff(cuts, axis=-1) > 0).all()


@given(
    count=st.integers(3, 6),
    exponent=st.floats(0.55, 1.6),
    side=st.integers(16, 70),
    gain=st.floats(0.2, 1.0),
    slope=st.floats(-0.01, 0.01),
    seed=st.integers(0, 10_000),
)
@settings(max_examples=60, deadline=None)
def test_middle_levels_may_be_brighter_or_darker(count, exponent, side, gain, slope, seed):
    """A tone curve, black that is not black, and light that falls off across the pad."""
    rng = np.random.default_rng(seed)
    field = rng.integers(0, count, (side, side))
    shown = 40 + 160 * gain * (field / (count - 1)) ** exponent
    step = np.diff(np.sort(np.unique(shown))).min()
    shown = shown * (1 + slope * np.arange(side)) + rng.normal(0, 0.08 * step, field.shape)
    seen = rng.random(field.shape) < 0.95
    found, _, _ = read(shown, seen, count)
    assert (found[seen] == field[seen]).mean() > 0.97


def test_a_tone_curve_off_the_power_laws():
    field = np.random.default_rng(5).integers(0, 4, (30, 30))
    shown = np.array([20.0, 120.0, 150.0, 220.0])[field]
    found, _, _ = read(shown, np.ones(field.shape, bool), 4)
    assert (found == field).mean() > 0.99


@pytest.mark.parametrize("count", [2, 3, 9])
@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (5, 5), (3, 200)])
def test_few_cells_or_none_with_contrast(count, shape):
    for values in (np.full(shape, 77.0), np.arange(np.prod(shape), dtype=float).reshape(shape)):
        for seen in (np.ones(shape, bool), np.zeros(shape, bool)):
            found, _, cuts = read(values, seen, count)
            assert np.isfinite(cuts).all()
            assert (found[seen] >= 0).all()
            assert (found[~seen] == -1).all()
