"""Fields cut from maximum-length sequences: truth by counting every window."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from windows import all_windows

from padstudio.pad.coding.search.bounds import bounds
from padstudio.pad.coding.search.maximum_length import can_cut, cut_field
from padstudio.pad.coding.search.spec import FieldSpec, Watch


def plain(rows: int, cols: int, **kind: object) -> FieldSpec:
    return FieldSpec(rows=rows, cols=cols, unique="plain", distance=1, **kind)  # type: ignore[arg-type]


def different_windows(field: np.ndarray, window: int) -> int:
    return len(np.unique(all_windows(field, window).reshape(-1, window**2), axis=0))


@pytest.mark.parametrize(
    ("rows", "cols", "window", "levels"),
    [(257, 257, 4, 2), (24, 24, 3, 2), (100, 180, 3, 3), (60, 40, 2, 7), (40, 20, 2, 31)],
)
def test_every_window_of_a_cut_field_is_there_once(
    rows: int, cols: int, window: int, levels: int
) -> None:
    spec = plain(rows, cols, window=window, levels=levels)
    field = cut_field(spec, Watch(60))
    assert field is not None
    assert field.shape == (rows, cols)
    assert int(field.max()) == levels - 1
    assert different_windows(field, window) == spec.windows


def test_nearly_all_windows_that_exist_are_used() -> None:
    spec = plain(257, 258, window=4)
    field = cut_field(spec, Watch(60))
    assert field is not None
    assert different_windows(field, 4) == 254 * 255
    assert bounds(spec).share > 0.98


@settings(max_examples=30, deadline=None)
@given(rows=st.integers(3, 40), cols=st.integers(3, 40), seed=st.integers(0, 2**62))
def test_any_shape_that_can_be_cut_is(rows: int, cols: int, seed: int) -> None:
    spec = plain(rows, cols, window=3, levels=3, seed=seed)
    assert can_cut(spec)
    field = cut_field(spec, Watch(60))
    assert field is not None
    assert different_windows(field, 3) == spec.windows


@pytest.mark.parametrize(
    "spec",
    [
        FieldSpec(rows=40, cols=40, distance=1),
        FieldSpec(rows=40, cols=40, unique="plain", distance=2),
        plain(40, 40, levels=4, window=3),
        plain(40, 40, levels=6, window=3),
        plain(40, 40, visible_lines=True),
        plain(40, 40, method="growth"),
        plain(40, 40, window=8),
        plain(259, 259, window=4),
    ],
)
def test_what_cannot_be_cut_is_left_to_searches(spec: FieldSpec) -> None:
    assert not can_cut(spec)


def test_none_where_no_sequence_does() -> None:
    # Two polynomials of order 4 are primitive; with neither do 15 windows in line tell the state.
    assert cut_field(plain(2, 16, window=2), Watch(60)) is None


def test_seeds_choose_the_sequence() -> None:
    one, same, other = (cut_field(plain(60, 60, seed=seed), Watch(60)) for seed in (1, 1, 2))
    assert one is not None
    assert same is not None
    assert other is not None
    assert np.array_equal(one, same)
    assert 0.3 < (one != other).mean() < 0.7
