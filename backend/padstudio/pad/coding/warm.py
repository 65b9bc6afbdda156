"""Compiles the loops of coding ahead, by one small field of every method."""

from __future__ import annotations

from collections.abc import Iterator

from padstudio.pad.coding.generate import generate_field
from padstudio.pad.coding.search.beam_search import beam_field
from padstudio.pad.coding.search.spec import FieldSpec, Watch


def warm_up() -> None:
    """Take all steps."""
    for _ in steps():
        pass


def steps() -> Iterator[None]:
    """Generate and prove small fields, also beside others, by rows, by a beam and by growth."""
    other = generate_field(FieldSpec(rows=12, cols=12))
    yield
    generate_field(FieldSpec(rows=12, cols=12, seed=2), beside=(other,))
    yield
    beam_field(FieldSpec(rows=6, cols=6, window=3, distance=1), Watch(60), 1, 1)
    yield
    generate_field(FieldSpec(rows=12, cols=12, method="growth", distance=1), beside=(other,))
    yield
