"""Boards beside other fields, by comparing every window that exists."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from padstudio.pad.coding.search.beside import board_beside
from padstudio.pad.coding.search.board import LENGTH, Costs
from padstudio.pad.coding.search.spec import FieldSpec


@pytest.mark.parametrize("unique", ["rotation", "plain"])
@pytest.mark.parametrize(
    ("window", "levels", "distance"), [(2, 3, 1), (2, 4, 2), (3, 2, 1), (3, 2, 3)]
)
def test_exactly_the_windows_near_another_field_are_taken(
    window: int, levels: int, distance: int, unique: str
) -> None:
    rng = np.random.default_rng(window * levels)
    other = rng.integers(0, levels, (window + 1, window + 2)).astype(np.uint8)
    spec = FieldSpec(rows=9, cols=9, window=window, levels=levels, distance=distance, unique=unique)  # type: ignore[arg-type]
    made = board_beside(spec, Costs(0, 0), [other])
    views = np.lib.stride_tricks.sliding_window_view(other, (window, window))
    held = views.reshape(-1, window, window)
    every = np.array(list(product(range(levels), repeat=window**2))).reshape(-1, window, window)
    near = np.zeros(len(every), bool)
    for turn in range(4):
        turned = np.rot90(held, turn, (1, 2))
        near |= ((every[:, None] != turned[None]).sum((2, 3)) < distance).any(1)
        if unique == "rotation" and turn:
            near |= (every != np.rot90(every, turn, (1, 2))).sum((1, 2)) < distance
    codes = np.arange(len(every))
    taken = made.taken[codes >> 6] >> (codes & 63).astype(np.uint64) & np.uint64(1)
    assert np.array_equal(taken.astype(bool), near)
    assert np.array_equal(made.free, (~near).reshape(len(made.free), -1).sum(1))
    assert made.counts[LENGTH] == 0
