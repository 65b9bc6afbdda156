"""Warming compiles every loop that a generation may call."""

from __future__ import annotations

from padstudio.pad.coding import verify_kernel, warm
from padstudio.pad.coding.search import beam_search, beside, board, growth, hash_chains, row_search


def test_warming_compiles_every_loop() -> None:
    warm.warm_up()
    entered = [
        row_search.search,
        row_search.fill,
        row_search.top_row,
        board.take_symmetric,
        beam_search.openness,
        growth.grow,
        beside._take_all,
        hash_chains._place_all,
        verify_kernel.compare_runs,
    ]
    assert [f.__name__ for f in entered if not f.dispatcher.signatures] == []
