"""The search over a table: rows first, a beam where they fail, the largest part at the end."""

from __future__ import annotations

import hashlib
import itertools

import pytest
from windows import all_differ

from padstudio.pad.coding.search import table_search
from padstudio.pad.coding.search.spec import FieldSearchError, FieldSpec, Watch


def test_a_beam_takes_over_where_rows_fail(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(table_search, "_ROUNDS", 0)
    monkeypatch.setattr(table_search, "_WIDTH", 4)
    spec = FieldSpec(rows=90, cols=90, window=4, distance=1)
    field = table_search.search_field(spec, Watch(60))
    assert field.shape == (90, 90)
    assert all_differ(field, 4, rotation=True)
    # The same in every version: seeds name pads that are printed.
    assert hashlib.sha256(field.tobytes()).hexdigest()[:16] == "b70be5087d10ccc3"


def test_where_time_ends_the_largest_part_is_handed_back(monkeypatch: pytest.MonkeyPatch) -> None:
    # A clock that goes on by 0.1 s at each look: enough for rows and a part of a beam.
    clock = itertools.count()
    monkeypatch.setattr("padstudio.pad.coding.search.spec.monotonic", lambda: 0.1 * next(clock))
    monkeypatch.setattr(table_search, "_ROUNDS", 5)
    spec = FieldSpec(rows=125, cols=125, window=4, distance=1)
    with pytest.raises(FieldSearchError, match=r"reached \d+ of 125 rows of 125 cells") as caught:
        table_search.search_field(spec, Watch(60))
    part = caught.value.field
    assert part is not None
    assert 40 < part.shape[0] < 125
    assert f"reached {part.shape[0]} of" in str(caught.value)
    assert all_differ(part, 4, rotation=True)


@pytest.mark.parametrize("seed", [2, 5])
def test_the_bound_itself_is_reached(seed: int) -> None:
    spec = FieldSpec(rows=12, cols=12, window=3, distance=1, seed=seed)
    field = table_search.search_field(spec, Watch(60))
    assert field.shape == (12, 12)
    assert all_differ(field, 3, rotation=True)
