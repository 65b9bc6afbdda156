"""The verifier against comparing every window with every other."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from windows import all_windows, lines_visible, nearest_distances

from padstudio.errors import SpecError
from padstudio.pad.coding.verify import least_distance, verify_field


@st.composite
def fields(draw: st.DrawFn) -> tuple[NDArray[np.uint8], int, int]:
    window, levels = draw(st.integers(2, 5)), draw(st.sampled_from([2, 3, 4, 17, 36]))
    rows, cols = (window + draw(st.integers(0, 7)) for _ in range(2))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    return rng.integers(0, levels, (rows, cols)).astype(np.uint8), window, levels


@settings(max_examples=60, deadline=None)
@given(case=fields(), limit=st.integers(0, 6))
def test_any_field(case: tuple[NDArray[np.uint8], int, int], limit: int) -> None:
    field, window, levels = case
    found = verify_field(field, window, levels, distance_limit=limit)
    limit = min(limit, window * window)
    assert found.distance_limit == limit
    for rotation, least, histogram in (
        (False, found.min_distance, found.histogram),
        (True, found.min_distance_under_rotation, found.histogram_under_rotation),
    ):
        truth = np.minimum(nearest_distances(field, window, rotation=rotation), limit + 1)
        assert least == truth.min()
        assert histogram == tuple(np.bincount(truth, minlength=limit + 2))
        assert least == least_distance(field, window, levels, rotation=rotation, limit=limit)
    assert found.unique == (found.min_distance > 0)
    assert found.unique_under_rotation == (found.min_distance_under_rotation > 0)
    assert found.visible_lines == lines_visible(field, window)
    assert found.level_counts == tuple(np.bincount(field.ravel(), minlength=levels))
    assert found.windows == len(all_windows(field, window))


def test_the_weakest_windows_are_shown_where_they_lie() -> None:
    rng = np.random.default_rng(3)
    field = rng.integers(0, 2, (20, 20)).astype(np.uint8)
    field[13:18, 1:6] = np.rot90(field[2:7, 9:14], -1)
    field[15, 3] ^= 1
    found = verify_field(field, 5, 2, distance_limit=2)
    places = {(w.row, w.col): w for w in found.weakest}
    near = places[2, 9]
    assert (near.other_row, near.other_col, near.turn, near.distance) == (13, 1, 1, 1)
    for pair in found.weakest:
        one = field[pair.row : pair.row + 5, pair.col : pair.col + 5]
        other = field[pair.other_row : pair.other_row + 5, pair.other_col : pair.other_col + 5]
        assert (one != np.rot90(other, pair.turn)).sum() == pair.distance
    assert [w.distance for w in found.weakest] == sorted(w.distance for w in found.weakest)


def test_a_window_that_is_its_own_turn_is_not_unique_under_rotation() -> None:
    field = np.array([[0, 1, 0], [1, 1, 1], [0, 1, 0]], np.uint8)
    found = verify_field(field, 3, 2)
    assert found.unique
    assert not found.unique_under_rotation


def test_large_windows_of_many_levels() -> None:
    field = np.random.default_rng(0).integers(0, 16, (40, 40)).astype(np.uint8)
    assert verify_field(field, 8, 16).unique_under_rotation
    field[30:38, 5:13] = field[2:10, 20:28]
    found = verify_field(field, 8, 16)
    assert not found.unique
    assert {(w.row, w.col) for w in found.weakest if w.distance == 0} == {(2, 20), (30, 5)}


def test_it_goes_into_json() -> None:
    field = np.random.default_rng(0).integers(0, 2, (9, 9)).astype(np.uint8)
    plain = json.loads(json.dumps(verify_field(field, 5, 2).to_dict()))
    assert plain["windows_possible"] == 2**25
    assert set(plain["weakest"][0]) == {
        "row", "col", "other_row", "other_col", "turn", "distance",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("shape", "window", "level"), [((4, 9), 5, 1), ((9, 9), 5, 2), ((9, 9), 1, 1), ((9,), 5, 1)]
)
def test_what_is_no_field_is_refused(shape: tuple[int, ...], window: int, level: int) -> None:
    with pytest.raises(SpecError):
        verify_field(np.full(shape, level, np.uint8), window, 2)
