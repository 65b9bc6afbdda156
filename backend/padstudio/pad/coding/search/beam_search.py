"""Beam search over the rows of many boards at once, for fields close to the bound.

A single board (see `row_search`) dead-ends where the windows left over no longer join up, and
taking a few rows back does not mend what many rows above have spoilt. So many boards, the beam, are
filled row by row; every board has several children that differ in their random costs, and those
live on whose open windows join up best (beam search: Lowerre, "The HARPY speech recognition
system", thesis, Carnegie Mellon University, 1976). A board is judged by the number of ways to go on
from an open window: to the right, times down, summed over all open windows.
"""

from __future__ import annotations

import numpy as np

from padstudio.compiled import jit
from padstudio.pad.coding.search.beside import board_beside
from padstudio.pad.coding.search.board import (
    I16,
    I32,
    LENGTH,
    U8,
    U64,
    Board,
    Costs,
    is_taken,
    take_symmetric,
)
from padstudio.pad.coding.search.random import random_state
from padstudio.pad.coding.search.row_search import costs, fill, top_row
from padstudio.pad.coding.search.spec import Fields, FieldSpec, Watch

# Boards are copied and judged whole at every row: only small tables and short rows pay.
_MAX_CODES = 2**20
_MAX_COLS = 500
# Children of a board, which differ in their random costs.
_CHILDREN = 3
# With few windows, every board is much like the others in what it could spare: chance alone, in
# many narrow beams, was measured to reach the bound soonest.
_FEW_CODES = 2**12


def fits_beam(spec: FieldSpec) -> bool:
    """Whether boards of a spec are small enough to keep many."""
    return spec.levels ** (spec.window**2) <= _MAX_CODES and spec.cols <= _MAX_COLS


def beam_field(
    spec: FieldSpec, watch: Watch, width: int, stream: int, beside: Fields = ()
) -> tuple[int, U8]:
    """Fill rows until none of the ``width`` boards of a beam can be filled further.

    Parameters
    ----------
    stream : int
        Which of the random streams of the spec's seed.
    beside
        Fields whose windows are taken.

    Returns
    -------
    reached : int
        Rows that are filled; all where the search succeeded.
    field : (rows, cols) uint8
        A field that reached so far.
    """
    few = spec.levels ** (spec.window**2) <= _FEW_CODES
    first = board_beside(spec, Costs(0, 0) if few else costs(spec), beside)
    first = first._replace(state=random_state(spec.seed, stream))
    take_symmetric(first)
    left, right = columns(spec.window, spec.levels)
    beam = [_child(first) for _ in range(width)]
    for member in beam:
        for row in range(spec.window - 1):
            top_row(member, row)
    for row in range(spec.window - 1, spec.rows):
        born: list[tuple[int, Board]] = []
        for member in beam:
            if watch.spent(row / spec.rows):
                return row, beam[0].field
            for _ in range(_CHILDREN):
                child = _child(member)
                if fill(child, row):
                    born.append((openness(child.taken, child.free, left, right), child))
        if not born:
            return row, beam[0].field
        born.sort(key=lambda scored: -scored[0])
        beam = [child for _, child in born[:width]]
    return spec.rows, beam[0].field


def _child(parent: Board) -> Board:
    """A copy that shares with its parent what a row needs for itself alone."""
    parent.counts[LENGTH] = 0
    return parent._replace(
        field=parent.field.copy(), taken=parent.taken.copy(), free=parent.free.copy()
    )


def columns(b: int, levels: int) -> tuple[I32, I32]:
    """For every code, the number of its left and of its right b − 1 columns."""
    left, right = (np.zeros(levels ** (b * b), np.int32) for _ in range(2))
    lines = np.arange(len(left), dtype=np.int32)
    weight, line, state = 1, levels**b, levels ** (b - 1)
    for _ in range(b):
        left += lines % line // levels * weight
        right += lines % state * weight
        lines //= line
        weight *= state
    return left, right


@jit
def openness(taken: U64, free: I16, left: I32, right: I32) -> int:
    """Pairs of an open window to the right and one below, summed over all open windows."""
    upper = len(free)
    followers = np.zeros(upper, np.int64)
    for code in range(len(left)):
        if not is_taken(taken, code):
            followers[left[code]] += 1
    total = 0
    for code in range(len(left)):
        if not is_taken(taken, code):
            total += free[code % upper] * followers[right[code]]
    return total
