"""Where sheets of paper meet: the fewest, spread evenly, on cell edges."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from padstudio.arrays import Array
from padstudio.errors import SpecError

# Seams in a wide quiet margin fall on a raster of this pitch.
_QUIET_STEP_MM = 10.0
# Rounding of sums of cell sizes; far below what a printer places.
_TOLERANCE_MM = 1e-6


def find_seams(
    length_mm: float,
    usable_mm: float,
    *,
    under_mm: float,
    quiet_mm: float,
    cells_mm: Sequence[float],
    on_cells: bool,
) -> tuple[list[float], bool]:
    """Seams across one side of a page.

    Parameters
    ----------
    length_mm : float
        The page's side, quiet margins included.
    usable_mm : float
        What one sheet holds, with what goes on under the next sheet.
    under_mm : float
        How far a sheet's print goes on under the next one; 0 for butt joints.
    quiet_mm : float
        Where the first cell begins.
    cells_mm : sequence of float
        Sides of the cells of the layers.
    on_cells : bool
        Put seams on cell edges, unless a cell is larger than a sheet: on the coarsest layer's
        where that takes no more sheets than the finest's.

    Returns
    -------
    list of float, bool
        Seams in ascending order, mm from the page's side, without the sides themselves; whether
        none cuts a cell of the finest layer.

    Raises
    ------
    SpecError
        If the overlap takes the whole sheet.
    """
    if length_mm <= usable_mm + _TOLERANCE_MM:
        return [], True
    step = usable_mm - under_mm
    if step < 10:
        raise SpecError(
            f"an overlap of {under_mm:g} mm leaves {max(step, 0):g} mm of each sheet; take a "
            "smaller overlap or a larger paper"
        )
    if on_cells:
        fine, coarse = (
            _spread(length_mm, usable_mm, step, _edges(length_mm, quiet_mm, cell))
            for cell in (min(cells_mm), max(cells_mm))
        )
        if fine is not None:
            return (coarse if coarse is not None and len(coarse) <= len(fine) else fine), True
    sheets = 1 + math.ceil((length_mm - usable_mm) / step - _TOLERANCE_MM)
    # Only the last sheet has nothing under a next one: the others' even share must fit as well.
    share = min(length_mm / sheets, step)
    return [share * number for number in range(1, sheets)], False


def _edges(length: float, quiet: float, cell: float) -> Array:
    """Where a seam may be: cell edges, and a raster in the quiet margins."""
    cells = quiet + cell * np.arange(math.floor((length - 2 * quiet) / cell + 1e-9) + 1)
    blank = np.arange(0, quiet, _QUIET_STEP_MM)
    edges = np.concatenate([blank, cells, length - blank])
    return np.unique(edges[(edges > _TOLERANCE_MM) & (edges < length - _TOLERANCE_MM)])


def _spread(length: float, usable: float, step: float, edges: Array) -> list[float] | None:
    """The fewest seams on given edges, as even as these allow; None where none reaches."""
    sheets = _count(0.0, length, usable, step, edges)
    if sheets is None:
        return None
    seams: list[float] = []
    start = 0.0
    for left in range(sheets - 1, 0, -1):
        even = start + (length - start) / (left + 1)
        reach = edges[(edges > start) & (edges <= start + step + _TOLERANCE_MM)]
        by_evenness = reach[np.argsort(np.abs(reach - even), kind="stable")].tolist()
        start = next(
            edge for edge in by_evenness if _count(edge, length, usable, step, edges) == left
        )
        seams.append(start)
    return seams


def _count(start: float, length: float, usable: float, step: float, edges: Array) -> int | None:
    """How many sheets the page still takes from an edge on; None where no next edge is in reach."""
    sheets = 1
    while length - start > usable + _TOLERANCE_MM:
        place = int(np.searchsorted(edges, start + step + _TOLERANCE_MM)) - 1
        if place < 0 or edges[place] <= start + _TOLERANCE_MM:
            return None
        start = float(edges[place])
        sheets += 1
    return sheets
