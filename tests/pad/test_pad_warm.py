"""Warming compiles every loop that a generation may call."""

from __future__ import annotations

from padstudio.pad import crowd, growth, row_search, rows, verify_near, warm


def test_warming_compiles_every_loop() -> None:
    warm.warm_up()
    entered = [
        row_search.search,
        row_search.fill,
        row_search.top_row,
        rows._take_symmetric,
        crowd.openness,
        growth.grow,
        growth.take_back,
        verify_near.compare_runs,
    ]
    assert [f.__name__ for f in entered if not f.signatures] == []  # type: ignore[attr-defined]
