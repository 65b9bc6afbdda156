"""Search a field over a table of all windows: row by row, and where that fails by a beam."""

from __future__ import annotations

from itertools import count

from padstudio.pad.coding.search.beam_search import beam_field, fits_beam
from padstudio.pad.coding.search.board import U8
from padstudio.pad.coding.search.bounds import bounds
from padstudio.pad.coding.search.row_search import RowSearch
from padstudio.pad.coding.search.spec import Fields, FieldSearchError, FieldSpec, Watch

# Rounds of the search by rows before the first beam, and boards of that; both double each cycle.
# Smaller tables are searched for fewer rounds, and by more beams a cycle.
_ROUNDS, _LEAST_ROUNDS = 100, 10
_WIDTH = 64
_USUAL_CODES = 2**16


def search_field(spec: FieldSpec, watch: Watch, beside: Fields = ()) -> U8:
    """Search a field over a table of all windows, of which those of other fields are taken.

    Returns
    -------
    (rows, cols) uint8

    Raises
    ------
    FieldSearchError
        Where the budget ends first, with the rows reached at best.
    """
    by_rows = RowSearch(spec, beside)
    beamed = fits_beam(spec) and bounds(spec).outlook == "long"
    best, reached = by_rows.best, 0
    codes = spec.levels ** (spec.window**2)
    rounds = min(_ROUNDS, max(_LEAST_ROUNDS, _ROUNDS * codes // _USUAL_CODES))
    beams = max(1, _USUAL_CODES // codes)
    for cycle in count():
        ended = by_rows.run(watch, rounds << cycle)
        if by_rows.reached > reached:
            best, reached = by_rows.best.copy(), by_rows.reached
        for number in range(beams if beamed and not ended else 0):
            stream = 1 + cycle * beams + number
            rows, field = beam_field(spec, watch, _WIDTH << cycle, stream, beside)
            if rows > reached:
                best, reached = field, rows
            if reached == spec.rows or watch.spent(reached / spec.rows):
                break
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
