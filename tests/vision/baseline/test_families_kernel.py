"""Compiled loops over families of lines, on lines whose families are known."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from padstudio.vision.baseline import families_kernel as kernel

SEEDS = st.integers(0, 2**32 - 1)
ALIGNED = 0.03


def _toward(rng: np.random.Generator, point: np.ndarray, count: int) -> np.ndarray:
    """Segments (N, 2, 2) of 40 px at random places that point at a vanishing point (3,)."""
    middle = rng.uniform(0, 400, (count, 2))
    way = point[:2] - point[2] * middle
    way *= 20 / np.linalg.norm(way, axis=1, keepdims=True)
    return np.stack([middle - way, middle + way], axis=1)


@given(SEEDS)
def test_lines_are_aligned_within_the_angle(seed: int) -> None:
    rng = np.random.default_rng(seed)
    point = np.array([*rng.uniform(-3000, 3000, 2), rng.uniform(-1, 1)])
    ends = _toward(rng, point, 60)
    middle, half = ends.mean(axis=1), (ends[:, 1] - ends[:, 0]) / 2
    off = rng.uniform(-2 * ALIGNED, 2 * ALIGNED, 60)
    across = np.stack([-half[:, 1], half[:, 0]], axis=1)
    half = half * np.cos(off)[:, None] + across * np.sin(off)[:, None]
    turned = np.stack([middle - half, middle + half], axis=1)
    clear = np.abs(np.abs(off) - ALIGNED) > 1e-6
    found = kernel.aligned(point, turned, ALIGNED)
    assert (found == (np.abs(off) < ALIGNED))[clear].all()


@given(SEEDS)
def test_a_point_settles_where_most_lines_meet(seed: int) -> None:
    rng = np.random.default_rng(seed)
    point = np.array([*rng.uniform(600, 3000, 2), 1.0])
    ends = np.concatenate([_toward(rng, point, 30), rng.uniform(0, 400, (4, 2, 2))])
    along = ends[:, 1] - ends[:, 0]
    normal = np.stack([-along[:, 1], along[:, 0]], axis=1)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    lines = np.column_stack([normal, -(normal * ends[:, 0]).sum(axis=1)])
    weight = np.concatenate([np.full(30, 40.0), np.full(4, 1e-3)])
    near = point * [1.003, 0.997, 1.0]
    found = kernel.settled(near, lines, ends, weight, ALIGNED)
    assert found[:2] / found[2] == pytest.approx(point[:2], rel=1e-4)


@given(SEEDS)
def test_a_step_explains_the_support_near_its_multiples(seed: int) -> None:
    rng = np.random.default_rng(seed)
    place, support = rng.uniform(-50, 50, 40), rng.uniform(1, 9, 40)
    steps, anchors, near = rng.uniform(0.5, 9, 6), place[:8].copy(), 0.15
    offset = (place - anchors[:, None])[None] / steps[:, None, None]
    truth = (np.abs(offset - np.round(offset)) < near) @ support / support.sum()
    scores, best = kernel.weigh_steps(place, support, steps, anchors, near)
    assert scores == pytest.approx(truth.max(axis=1))
    assert truth[np.arange(6), best] == pytest.approx(truth.max(axis=1))


@given(SEEDS)
def test_a_lattice_is_found_and_its_strangers_dropped(seed: int) -> None:
    rng = np.random.default_rng(seed)
    # Pixels of lattice coordinates.
    pixels = np.array([[40, 6, 90], [-5, 38, 70], [1e-3, -2e-3, 1.0]])
    ends, numbers = [], np.full((2, 21), np.nan)
    for axis in range(2):
        for number in range(10):
            line = np.zeros((2, 2))
            line[:, axis], line[:, 1 - axis] = number, (0, 9)
            at = np.column_stack([line, np.ones(2)]) @ pixels.T
            numbers[axis, len(ends)] = number
            ends.append(at[:, :2] / at[:, 2:])
    ends.append(rng.uniform(0, 400, (2, 2)))
    numbers[0, 20] = 30
    support = np.append(np.full(20, 100.0), 1e-3)
    found, fit = kernel.fit_lattice(np.array(ends), numbers, support, 0.1, 3, 4)
    assert found
    assert np.isnan(numbers[0, 20])
    assert np.isfinite(numbers).sum() == 20
    truth = np.linalg.inv(pixels)
    assert fit / fit[2, 2] == pytest.approx(truth / truth[2, 2], rel=1e-4, abs=1e-6)


def test_too_few_lines_are_no_lattice() -> None:
    ends = np.array([[[0.0, 0.0], [0.0, 9.0]], [[1.0, 0.0], [1.0, 9.0]]])
    numbers = np.array([[0.0, 1.0], [np.nan, np.nan]])
    assert not kernel.fit_lattice(ends, numbers, np.ones(2), 0.1, 2, 4)[0]
