"""Search a field over a table of all windows: row by row, and where that fails by a crowd."""

from __future__ import annotations

from itertools import count

from padstudio.pad.bounds import bounds
from padstudio.pad.crowd import can_crowd, crowd_field
from padstudio.pad.field_spec import FieldSearchError, FieldSpec, Watch
from padstudio.pad.row_search import RowSearch
from padstudio.pad.rows import U8

# Rounds of the search by rows before the first crowd, and boards of that; both double in turns.
_ROUNDS = 100
_WIDTH = 64


def search_field(spec: FieldSpec, watch: Watch) -> U8:
    """Search a field over a table of all windows.

    Returns
    -------
    (rows, cols) uint8

    Raises
    ------
    FieldSearchError
        Where the budget ends first, with the rows reached at best.
    """
    by_rows = RowSearch(spec)
    crowded = can_crowd(spec) and bounds(spec).outlook == "long"
    best, reached = by_rows.best, 0
    for turn in count():
        ended = by_rows.run(watch, _ROUNDS << turn)
        if by_rows.reached > reached:
            best, reached = by_rows.best.copy(), by_rows.reached
        if crowded and not ended:
            rows, field = crowd_field(spec, watch, _WIDTH << turn)
            if rows > reached:
                best, reached = field, rows
        if reached == spec.rows:
            return best
        if ended or watch.spent(reached / spec.rows):
            break
    raise FieldSearchError(
        f"the search reached {reached} of {spec.rows} rows of {spec.cols} cells in "
        f"{watch.elapsed_s:.0f} s: give it more time, or take a smaller field, a lesser distance, "
        "a larger window or more levels",
        best[:reached].copy() if reached >= spec.window else None,
    )
