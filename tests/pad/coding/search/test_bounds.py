"""Bounds against published figures and against counting every window."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from padstudio.errors import LimitError, SpecError
from padstudio.pad.coding.search.bounds import bounds, check_possible
from padstudio.pad.coding.search.spec import FieldSpec


def square(side: int, window: int, levels: int = 2, **kind: object) -> FieldSpec:
    return FieldSpec(
        rows=side, cols=side, window=window, levels=levels, distance=kind.pop("distance", 1), **kind
    )  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("window", "levels", "unique", "side"),
    [
        (5, 2, "rotation", 2899),
        (4, 2, "rotation", 130),
        (3, 2, "rotation", 12),
        (5, 2, "plain", 5796),
        (3, 3, "rotation", 71),
        (3, 4, "rotation", 257),
        (4, 3, "rotation", 3283),
        (2, 4, "rotation", 8),
    ],
)
def test_largest_squares(window: int, levels: int, unique: str, side: int) -> None:
    found = bounds(square(window, window, levels, unique=unique))
    assert found.largest_square == side
    # The square itself fits, the next one does not.
    if side <= 4000:
        check_possible(square(side, window, levels, unique=unique))
    with pytest.raises(SpecError, match=f"at most {side} x {side}") as caught:
        check_possible(square(side + 1, window, levels, unique=unique))
    assert caught.value.error_code == "impossible_spec"
    assert caught.value.detail["largest_square"] == side


@pytest.mark.parametrize(("window", "levels"), [(2, 2), (2, 3), (2, 5), (3, 2)])
def test_allowed_windows_by_counting_all(window: int, levels: int) -> None:
    orbits = set()
    for cells in product(range(levels), repeat=window * window):
        turns = [
            tuple(np.rot90(np.array(cells).reshape(window, window), k).ravel()) for k in range(4)
        ]
        if len(set(turns)) == 4:
            orbits.add(min(turns))
    found = bounds(square(window, window, levels))
    assert found.windows_allowed == len(orbits)
    assert found.windows_possible == levels ** (window * window)


def test_the_outlook_tells_easy_from_long() -> None:
    assert bounds(FieldSpec()).outlook == "easy"
    assert bounds(square(140, 5, distance=3)).outlook == "long"
    assert bounds(square(2700, 5)).outlook == "long"
    # One sequence reaches up to the bound, which growth at random does not.
    assert bounds(square(5796, 5, unique="plain")).outlook == "easy"
    assert bounds(square(5796, 5, unique="plain", method="growth")).outlook == "long"


def test_distance_lowers_the_bound() -> None:
    sides = [bounds(square(5, 5, distance=d)).windows_at_most for d in range(1, 26)]
    assert sides == sorted(sides, reverse=True)


def test_a_search_beyond_the_memory_limit_is_refused() -> None:
    with pytest.raises(LimitError, match="lesser distance"):
        check_possible(square(4000, 8, distance=20))


def test_what_cannot_be_at_any_size_says_another_way() -> None:
    with pytest.raises(SpecError, match="take a lesser distance"):
        check_possible(square(3, 3, distance=9))
