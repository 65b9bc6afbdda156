"""A beam of boards: its judgement against a count by hand, and its fields against the truth."""

from __future__ import annotations

import numpy as np
from windows import all_differ

from padstudio.pad.coding.search.beam_search import (
    beam_field,
    columns,
    fits_beam,
    openness,
)
from padstudio.pad.coding.search.board import Costs, board, take_symmetric
from padstudio.pad.coding.search.spec import FieldSpec, Watch


def open_windows(taken: np.ndarray, codes: int) -> list[tuple[tuple[int, ...], ...]]:
    """The windows of 2 × 2 cells at 3 levels whose bit is not set."""
    cells = [tuple(code // 3**k % 3 for k in (3, 2, 1, 0)) for code in range(codes)]
    bits = [int(taken[code // 64]) >> code % 64 & 1 for code in range(codes)]
    return [(w[:2], w[2:]) for w, bit in zip(cells, bits, strict=True) if not bit]


def test_openness_counts_the_ways_on_from_every_open_window() -> None:
    spec = FieldSpec(rows=3, cols=3, window=2, levels=3, distance=1)
    made = board(spec, Costs(0, 0))
    take_symmetric(made)
    windows = open_windows(made.taken, 81)
    assert len(windows) == 81 - 9
    ways = 0
    for (_, b), (c, d) in windows:
        below = sum(upper == (c, d) for upper, _ in windows)
        right = sum((u[0], v[0]) == (b, d) for u, v in windows)
        ways += below * right
    assert openness(made.taken, made.free, *columns(2, 3)) == ways


def test_a_beam_fills_fields_as_asked() -> None:
    spec = FieldSpec(rows=60, cols=40, window=4, distance=1)
    reached, field = beam_field(spec, Watch(60), 2, 1)
    assert reached == 60
    assert all_differ(field, 4, rotation=True)


def test_a_beam_that_dies_out_hands_back_how_far_it_came() -> None:
    spec = FieldSpec(rows=200, cols=60, window=4, distance=1, seed=3)
    reached, field = beam_field(spec, Watch(60), 1, 1)
    again, same = beam_field(spec, Watch(60), 1, 1)
    assert 60 < reached < 200
    assert reached == again
    assert np.array_equal(field, same)
    assert all_differ(field[:reached], 4, rotation=True)


def test_a_spent_watch_ends_it() -> None:
    reached, _ = beam_field(FieldSpec(rows=60, cols=40, window=4, distance=1), Watch(-1), 2, 1)
    assert reached == 3


def test_only_small_boards_are_kept_many() -> None:
    assert fits_beam(FieldSpec(rows=100, cols=100, window=4, distance=1))
    assert not fits_beam(FieldSpec(rows=100, cols=100))
    assert not fits_beam(FieldSpec(rows=10, cols=600, window=4, distance=1))
