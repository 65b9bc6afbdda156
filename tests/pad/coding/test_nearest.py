"""Windows of two fields beside each other, by comparing every one with every other."""

from __future__ import annotations

import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from windows import all_windows

from padstudio.pad.coding.nearest import nearest_apart
from padstudio.pad.coding.verify import least_distance_apart


@settings(max_examples=60, deadline=None)
@given(
    window=st.integers(2, 5),
    levels=st.sampled_from([2, 3, 4, 17, 36]),
    extra=st.tuples(*[st.integers(0, 6)] * 4),
    limit=st.integers(0, 5),
    seed=st.integers(0, 2**32),
)
def test_any_two_fields(
    window: int, levels: int, extra: tuple[int, int, int, int], limit: int, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    shape = [window + more for more in extra]
    one = rng.integers(0, levels, shape[:2]).astype(np.uint8)
    other = rng.integers(0, levels, shape[2:]).astype(np.uint8)
    found = nearest_apart(one, other, window, levels, limit=limit)
    mine, theirs = all_windows(one, window), all_windows(other, window)
    turned = np.concatenate([np.rot90(theirs, turn, (1, 2)) for turn in range(4)])
    differing = (mine[:, None] != turned[None]).sum((2, 3))
    assert np.array_equal(found.distance, np.minimum(differing.min(1), limit + 1))
    assert found.distance.min() == least_distance_apart(one, other, window, levels, limit=limit)
    near = np.flatnonzero(found.distance <= limit)
    # Windows of the field itself are counted first.
    places = found.other[near] - len(mine)
    assert np.array_equal(differing[near, places], found.distance[near])


@pytest.mark.parametrize("limit", [0, 3])
def test_fields_of_one_level_take_no_longer_than_others(limit: int) -> None:
    rng = np.random.default_rng(0)
    flat, small = np.zeros((200, 200), np.uint8), np.zeros((40, 40), np.uint8)
    random = rng.integers(0, 2, flat.shape).astype(np.uint8)
    nearest_apart(random, small, 5, 2, limit=limit)
    start = time.process_time()
    assert (nearest_apart(flat, small, 5, 2, limit=limit).distance == 0).all()
    assert time.process_time() - start < 5
