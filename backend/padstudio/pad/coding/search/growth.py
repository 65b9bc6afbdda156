"""Growth of a field at random, as in the paper: start block, to the right, down, never a repeat.

1. A random b × b block at the top left.
2. To the right: one random column of b cells at a time; each completes one window.
3. Down: one random row of b cells at a time; each completes one window.
4. The rest in reading order, one random cell at a time; each completes one window.

Whatever is added is drawn again where its window is not allowed (see `chains`).

In the paper a dead end starts again from a new block. A field of millions of windows meets dead
ends however many windows there are; where the method is free, some steps are taken back instead.
"""

from __future__ import annotations

from itertools import count

import numpy as np
from numpy.typing import NDArray

from padstudio.compiled import jit
from padstudio.pad.coding.search.hash_chains import (
    allowed,
    chains,
    displace,
    place,
    read_window,
)
from padstudio.pad.coding.search.random import draw, random_state
from padstudio.pad.coding.search.spec import FieldSearchError, FieldSpec, Watch

U8 = NDArray[np.uint8]
I32 = NDArray[np.int32]
U64 = NDArray[np.uint64]

# Draws of a whole row or column of b cells before it counts as a dead end.
_DRAWS = 256
# Dead ends at one place, each of which takes some steps back, before all starts again.
_PATIENCE = 64
# Steps between two looks at the watch.
_STEPS = 20_000


@jit
def take_back(field: U8, step: int, until: int, b: int, turns: int, heads: I32, links: I32) -> None:
    """Undo the steps ``until`` … ``step`` − 1, the last first."""
    down, across = field.shape[0] - b + 1, field.shape[1] - b + 1
    cells = np.zeros((turns, b * b), np.uint8)
    for undone in range(step - 1, until - 1, -1):
        row, col = _window_of(undone, down, across)
        read_window(field, row, col, b, turns, cells)
        displace(row, col, across, heads, links, cells)


@jit
def _window_of(step: int, down: int, across: int) -> tuple[int, int]:
    """Row and column of the window that a step completes."""
    if step < across:
        return 0, step
    if step < across + down - 1:
        return step - across + 1, 0
    rest = step - across - down + 1
    return 1 + rest // (across - 1), 1 + rest % (across - 1)


@jit
def _extend(
    field: U8,
    row: int,
    col: int,
    top: int,
    left: int,
    b: int,
    levels: int,
    distance: int,
    visible: bool,
    heads: I32,
    links: I32,
    cells: U8,
    state: U64,
) -> bool:
    """Draw the cells from (top, left) to the end of the window at (row, col) until it is allowed.

    A single cell is tried at every level once, in turn from a random one.
    """
    tries = levels if top == row + b - 1 and left == col + b - 1 else _DRAWS
    first = draw(state, levels)
    for attempt in range(tries):
        for i in range(top, row + b):
            for j in range(left, col + b):
                field[i, j] = (first + attempt) % levels if tries == levels else draw(state, levels)
        if allowed(field, row, col, b, distance, visible, heads, links, cells):
            place(row, col, field.shape[1] - b + 1, heads, links, cells)
            return True
    return False


@jit
def grow(
    field: U8,
    first: int,
    last: int,
    b: int,
    levels: int,
    turns: int,
    distance: int,
    visible: bool,
    heads: I32,
    links: I32,
    state: U64,
) -> int:
    """Take growth steps first … last − 1; return the step that dead-ended, or ``last``.

    Parameters
    ----------
    field : (rows, cols) uint8
        Grown in place; every step completes one window, steps in the order of the module's list.
    turns : int
        4 where windows must differ in all turns, else 1.
    heads, links : int32 arrays
        Of `Chains`, with ``distance`` parts.
    state : (1,) uint64
        Random state.
    """
    down, across = field.shape[0] - b + 1, field.shape[1] - b + 1
    cells = np.zeros((turns, b * b), np.uint8)
    for step in range(first, last):
        row, col = _window_of(step, down, across)
        top = row + b - 1 if row else 0
        left = col + b - 1 if col else 0
        if not _extend(
            field, row, col, top, left, b, levels, distance, visible, heads, links, cells, state
        ):
            return step
    return last


def grow_field(spec: FieldSpec, watch: Watch) -> NDArray[np.uint8]:
    """Grow a field; what dead-ends starts again from a new block, with the next random stream.

    Returns
    -------
    (rows, cols) uint8

    Raises
    ------
    FieldSearchError
        Where the budget ends first, with the whole rows of the farthest attempt.
    """
    best, most = None, 0
    for stream in count():
        field, step, spent = _attempt(spec, stream, watch)
        if step == spec.windows:
            return field
        if step > most:
            best, most = field, step
        if spent:
            break
    raise FieldSearchError(
        f"growth dead-ended {stream} times; it completed {most} of {spec.windows} windows at "
        "best: take a smaller field, a lesser distance, or another method",
        _whole_rows(best, most, spec),
    )


def _attempt(spec: FieldSpec, stream: int, watch: Watch) -> tuple[NDArray[np.uint8], int, bool]:
    """A field, the steps that it completed, and whether time is spent."""
    field = np.zeros((spec.rows, spec.cols), np.uint8)
    placed = chains(spec.windows, spec.distance)
    state = random_state(spec.seed, stream)
    step, farthest, dead_ends = 0, 0, 0
    patience = 0 if spec.method == "growth" else _PATIENCE
    while True:
        last = min(step + _STEPS, spec.windows)
        step = grow(
            field, step, last, spec.window, spec.levels, spec.turns, spec.distance,
            spec.visible_lines, placed.heads, placed.links, state,
        )  # fmt: skip
        spent = watch.spent(step / spec.windows)
        if step == spec.windows or spent:
            return field, step, spent
        if step == last:
            continue
        if step > farthest:
            farthest, dead_ends = step, 0
        if dead_ends == patience:
            return field, step, False
        dead_ends += 1
        until = max(0, step - spec.window * (dead_ends & -dead_ends))
        take_back(field, step, until, spec.window, spec.turns, placed.heads, placed.links)
        step = until


def _whole_rows(
    field: NDArray[np.uint8] | None, steps: int, spec: FieldSpec
) -> NDArray[np.uint8] | None:
    """The part of a field that ``steps`` steps completed, as whole rows; None where none did."""
    across, down = spec.cols - spec.window + 1, spec.rows - spec.window + 1
    if field is None or steps < across:
        return None
    rest = max(0, steps - across - down + 1) // max(1, across - 1)
    return field[: spec.window + min(rest, down - 1)].copy()
