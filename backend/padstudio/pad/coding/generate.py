"""Generate fields whose windows are unique, and pads of them.

Every field is verified by `padstudio.pad.coding.verify`, which shares no code with the generators,
before it is handed out.
"""

from __future__ import annotations

import secrets
from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from padstudio.pad.coding.pad_spec import PadSpec
from padstudio.pad.coding.search.bounds import check_possible, cuts_first, uses_table
from padstudio.pad.coding.search.growth import grow_field
from padstudio.pad.coding.search.maximum_length import can_cut, cut_field
from padstudio.pad.coding.search.spec import (
    Fields,
    FieldSearchError,
    FieldSpec,
    Watch,
)
from padstudio.pad.coding.search.table_search import search_field
from padstudio.pad.coding.verify import least_distance, least_distance_apart, lines_visible
from padstudio.pad.spec import Layer, Pad

__all__ = [
    "FieldSearchError",
    "FieldSpec",
    "PadSpec",
    "any_seed",
    "blue_beside",
    "generate_field",
    "generate_pad",
]


def generate_field(
    spec: FieldSpec,
    *,
    beside: Fields = (),
    budget_s: float = 60.0,
    progress: Callable[[float], None] | None = None,
    cancel: Callable[[], bool] | None = None,
) -> NDArray[np.uint8]:
    """Generate a field of levels with the properties of a spec.

    Parameters
    ----------
    spec : FieldSpec
        Size, window, levels, property, method and seed; the result depends on these and
        ``beside`` alone.
    beside : sequence of (rows, cols) uint8
        Fields whose windows the new one's differ from, too: in every turn, at the distance.
    budget_s : float
        Wall time for the search, s.
    progress : callable, optional
        Called with the share done, 0 … 1.
    cancel : callable, optional
        Asked often; the search ends once it answers true.

    Returns
    -------
    (rows, cols) uint8
        Levels 0 … Y−1, verified.

    Raises
    ------
    SpecError
        If no such field can exist.
    LimitError
        If the search would take more memory than it may.
    FieldSearchError
        If the budget is spent; its ``field`` is the largest part reached, verified.
    SearchCancelledError
        If ``cancel`` answered true.

    Examples
    --------
    >>> generate_field(FieldSpec(rows=12, cols=9, window=4, distance=1)).shape
    (12, 9)
    """
    check_possible(spec)
    _load_loops(uses_table(spec))
    return _generate(spec, Watch(budget_s, progress, cancel), beside)


def _generate(spec: FieldSpec, watch: Watch, beside: Fields) -> NDArray[np.uint8]:
    try:
        field = _search(spec, watch, beside)
    except FieldSearchError as error:
        if error.field is not None:
            _prove(error.field, spec, beside)
        raise
    _prove(field, spec, beside)
    return field


def any_seed(seed: int | None) -> int:
    """A seed, or one drawn where none is given."""
    return secrets.randbits(32) if seed is None else seed


def generate_pad(
    spec: PadSpec | None = None,
    *,
    budget_s: float = 60.0,
    progress: Callable[[float], None] | None = None,
    cancel: Callable[[], bool] | None = None,
) -> Pad:
    """Generate a pad of a red layer, and of a blue one where the spec has a ratio.

    Parameters
    ----------
    spec : PadSpec, optional
        The result depends on nothing else; unless given, ``PadSpec()``.
    budget_s, progress, cancel
        As of `generate_field`.

    Raises
    ------
    SpecError, LimitError, FieldSearchError, SearchCancelledError
        As `generate_field`; nothing is made that shares a code where independent layers were asked
        for.
    """
    spec = spec or PadSpec()
    check_possible(spec)
    _load_loops(uses_table(spec))
    watch = Watch(budget_s, progress, cancel)
    try:
        red, blue = _fields(spec, watch)
    except FieldSearchError as error:
        raise FieldSearchError(error.message + spec.last_resort, error.field) from error
    layers = [Layer("red", spec.cell_mm, red)]
    if spec.ratio > 1:
        layers.append(Layer("blue", spec.ratio * spec.cell_mm, blue))
    return Pad(
        layers=tuple(layers),
        window=spec.window,
        levels=spec.levels,
        quiet_mm=spec.quiet_mm,
        name=spec.name,
        seed=spec.seed,
        method=spec.method,
        unique=spec.unique,
        distance=spec.distance,
        visible_lines=spec.visible_lines,
        layer_fields=spec.layers if spec.ratio > 1 else None,
    )


def blue_beside(
    spec: PadSpec, red: NDArray[np.uint8], *, budget_s: float = 60.0
) -> NDArray[np.uint8]:
    """Generate a spec's blue field beside a red one from elsewhere.

    Parameters
    ----------
    spec : PadSpec
    red : (rows, cols) uint8
        Of the spec's size and levels; its windows need not differ from each other.
    budget_s : float
        Wall time for the search, s.

    Raises
    ------
    SpecError, LimitError, FieldSearchError
        As `generate_field`.
    """
    try:
        return generate_field(spec.blue_field(), beside=(red,), budget_s=budget_s)
    except FieldSearchError as error:
        raise FieldSearchError(error.message + spec.last_resort, error.field) from error


def _fields(spec: PadSpec, watch: Watch) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """The red and the blue field.

    The small one is first, as it then costs the large one few of its windows, and one search goes
    on to the bound; but a sequence is cut beside nothing.
    """
    if not spec.has_two_fields:
        red = _generate(spec, watch, ())
        return red, red[: spec.rows // spec.ratio, : spec.cols // spec.ratio]
    if cuts_first(spec):
        red = _generate(spec, watch, ())
        return red, _generate(spec.blue_field(), watch.unseen(), (red,))
    blue = _generate(spec.blue_field(), watch.unseen(), ())
    return _generate(spec, watch, (blue,)), blue


@cache
def _load_loops(table: bool) -> None:
    """Load a search's loops, or compile them, before its time begins: that may take a minute."""
    small = FieldSpec(rows=6, cols=6, window=3, distance=1)
    beside, watch = (np.zeros((3, 3), np.uint8),), Watch(np.inf)
    if table:
        search_field(small, watch, beside)
    else:
        grow_field(replace(small, method="growth"), watch, beside)


def _search(spec: FieldSpec, watch: Watch, beside: Fields) -> NDArray[np.uint8]:
    if can_cut(spec) and not beside:
        field = cut_field(spec, watch)
        if field is not None:
            return field
    if uses_table(spec):
        return search_field(spec, watch, beside)
    return grow_field(spec, watch, beside)


def _prove(field: NDArray[np.uint8], spec: FieldSpec, beside: Fields) -> None:
    """Raise AssertionError where a generator is at fault: a field must never leave unproven."""
    rotation, limit = spec.unique == "rotation", spec.distance - 1
    found = least_distance(field, spec.window, spec.levels, rotation=rotation, limit=limit)
    for other in beside:
        apart = least_distance_apart(field, other, spec.window, spec.levels, limit=limit)
        found = min(found, apart)
    if found < spec.distance or (spec.visible_lines and not lines_visible(field, spec.window)):
        raise AssertionError(f"the generator broke its own property: {spec}, distance {found}")
