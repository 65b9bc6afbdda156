"""Generate fields whose windows are unique, and pads of them.

Every field is verified by `padstudio.pad.coding.verify`, which shares no code with the generators,
before it is handed out.
"""

from __future__ import annotations

import secrets
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from padstudio.errors import SpecError
from padstudio.pad.coding.search.bounds import check_possible, uses_table
from padstudio.pad.coding.search.growth import grow_field
from padstudio.pad.coding.search.maximum_length import can_cut, cut_field
from padstudio.pad.coding.search.spec import (
    FieldSearchError,
    FieldSpec,
    Watch,
)
from padstudio.pad.coding.search.table_search import search_field
from padstudio.pad.coding.verify import least_distance, lines_visible
from padstudio.pad.spec import MAX_CELLS, Layer, Pad

__all__ = ["FieldSearchError", "FieldSpec", "PadSpec", "any_seed", "generate_field", "generate_pad"]


def generate_field(
    spec: FieldSpec,
    *,
    budget_s: float = 60.0,
    progress: Callable[[float], None] | None = None,
    cancel: Callable[[], bool] | None = None,
) -> NDArray[np.uint8]:
    """Generate a field of levels with the properties of a spec.

    Parameters
    ----------
    spec : FieldSpec
        Size, window, levels, property, method and seed; the result depends on nothing else.
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
    watch = Watch(budget_s, progress, cancel)
    try:
        field = _search(spec, watch)
    except FieldSearchError as error:
        if error.field is not None:
            _prove(error.field, spec)
        raise
    _prove(field, spec)
    return field


@dataclass(frozen=True, kw_only=True)
class PadSpec(FieldSpec):
    """A pad to be generated: its red layer's field, and what else the pad holds.

    Attributes
    ----------
    name : str
    ratio : int
        How many red cells a blue cell is wide; the blue layer is the upper left rows/ratio ×
        cols/ratio of the red field. 1 makes a pad of the red layer alone.
    cell_mm, quiet_mm : float
        Side of a red cell and width of the white margin, mm.

    Raises
    ------
    SpecError
        As `FieldSpec`, and where the ratio leaves the blue layer less than one window.
    """

    name: str = "pad"
    ratio: int = 5
    cell_mm: float = 10.0
    quiet_mm: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        _check_layers(self, self.ratio)


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
    """Generate a pad of one field: the red layer, and its upper left part magnified as the blue.

    Parameters
    ----------
    spec : PadSpec, optional
        The result depends on nothing else; unless given, ``PadSpec()``.
    budget_s, progress, cancel
        As of `generate_field`.

    Raises
    ------
    SpecError, LimitError, FieldSearchError, SearchCancelledError
        As `generate_field`.
    """
    spec = spec or PadSpec()
    red = generate_field(spec, budget_s=budget_s, progress=progress, cancel=cancel)
    layers = [Layer("red", spec.cell_mm, red)]
    if spec.ratio > 1:
        blue = red[: spec.rows // spec.ratio, : spec.cols // spec.ratio]
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
    )


def _check_layers(spec: FieldSpec, ratio: int) -> None:
    """Raise SpecError where a pad cannot have a red layer of a spec and a blue one of its ratio."""
    side, window = min(spec.rows, spec.cols), spec.window
    if not 1 <= ratio <= side:
        raise SpecError(
            f"ratio is {ratio}; it must be 1 (red layer only) … {side} cells",
            detail={"field": "ratio"},
        )
    if ratio > 1 and side // ratio < window:
        raise SpecError(
            f"a ratio of {ratio} leaves a blue layer of {spec.rows // ratio} x "
            f"{spec.cols // ratio} cells, less than one {window} x {window} window: take a ratio "
            f"of at most {side // window}, or 1 for the red layer only",
            detail={"field": "ratio"},
        )
    if max(spec.rows, spec.cols) > MAX_CELLS:
        raise SpecError(
            f"{spec.rows} x {spec.cols} cells; a pad has at most {MAX_CELLS} a side",
            detail={"field": "rows" if spec.rows > MAX_CELLS else "cols"},
        )


def _search(spec: FieldSpec, watch: Watch) -> NDArray[np.uint8]:
    if can_cut(spec):
        field = cut_field(spec, watch)
        if field is not None:
            return field
    if uses_table(spec):
        return search_field(spec, watch)
    return grow_field(spec, watch)


def _prove(field: NDArray[np.uint8], spec: FieldSpec) -> None:
    """Raise AssertionError where a generator is at fault: a field must never leave unproven."""
    rotation = spec.unique == "rotation"
    found = least_distance(
        field, spec.window, spec.levels, rotation=rotation, limit=spec.distance - 1
    )
    if found < spec.distance or (spec.visible_lines and not lines_visible(field, spec.window)):
        raise AssertionError(f"the generator broke its own property: {spec}, distance {found}")
