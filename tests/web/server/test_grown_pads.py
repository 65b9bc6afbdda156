"""Pads grown lately: kept by their code, bounded, never mistaken for another's."""

from __future__ import annotations

from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from padstudio.web.schemas.base import PadSpec
from padstudio.web.server.grown_pads import GrownPads
from padstudio.workers import pads as design

SPEC: dict[str, Any] = PadSpec(rows=12, cols=14, ratio=2, distance=1).model_dump()


def _design(text: str) -> design.Design:
    return design.Design(text, {})


def test_size_and_name_do_not_change_the_code() -> None:
    grown = GrownPads()
    made = _design("pad")
    grown.keep(SPEC, made)
    other = {**SPEC, "name": "other", "cell_mm": 3.0, "quiet_mm": 7.0}
    assert grown.find(other) is made
    assert grown.holds(SPEC)
    assert not grown.holds(other)


@given(
    st.sampled_from(sorted(set(SPEC) - {"name", "cell_mm", "quiet_mm", "seed"})),
    st.integers(20, 40),
)
def test_everything_else_does(field: str, value: int) -> None:
    grown = GrownPads()
    grown.keep(SPEC, _design("pad"))
    assert grown.find({**SPEC, field: value}) is None


def test_what_no_seed_brings_back_is_not_kept() -> None:
    grown = GrownPads()
    grown.keep({**SPEC, "seed": None}, _design("pad"))
    assert grown.find({**SPEC, "seed": None}) is None


def test_the_ones_not_asked_for_longest_go_first() -> None:
    grown = GrownPads(keep_bytes=30)
    specs = [{**SPEC, "seed": seed} for seed in range(4)]
    for place, spec in enumerate(specs):
        if place == 3:
            assert grown.find(specs[0])
        grown.keep(spec, _design("0123456789"))
    assert [grown.find(spec) is not None for spec in specs] == [True, False, True, True]
    grown.keep(SPEC, _design("x" * 31))
    assert not any(grown.find(spec) for spec in specs)


@settings(max_examples=20, deadline=None)
@given(
    st.floats(0.01, 500, allow_nan=False),
    st.floats(0, 500, allow_nan=False),
    st.sampled_from([1, 2, 3]),
)
def test_a_resized_pad_is_the_one_that_would_be_generated(
    cell_mm: float, quiet_mm: float, ratio: int
) -> None:
    spec = {**SPEC, "ratio": ratio, "window": 4}
    wanted = {**spec, "name": "other", "cell_mm": cell_mm, "quiet_mm": quiet_mm}
    resized = design.resize(design.generate(spec, 30.0), "other", cell_mm, quiet_mm)
    assert resized == design.generate(wanted, 30.0)
