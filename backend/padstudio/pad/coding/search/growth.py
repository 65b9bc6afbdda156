"""Growth of a field at random, as in the paper: start block, to the right, down, never a repeat.

1. A random b × b block at the top left.
2. To the right: one random column of b cells at a time; each completes one window.
3. Down: one random row of b cells at a time; each completes one window.
4. The rest in reading order, one random cell at a time; each completes one window.

Whatever is added is drawn again where its window is not allowed (see `hash_chains`).

In the paper a dead end starts again from a new block. A field of millions of windows meets dead
ends however many windows there are; where the method is free, some steps are taken back instead.
"""

from __future__ import annotations

from itertools import count

import numpy as np
from numpy.typing import NDArray

from padstudio.compiled import pure_jit
from padstudio.pad.coding.search.hash_chains import (
    Placed,
    allowed,
    displace,
    place,
    placed_beside,
)
from padstudio.pad.coding.search.random import draw
from padstudio.pad.coding.search.spec import Fields, FieldSearchError, FieldSpec, Watch

# Draws of a whole row or column of b cells before it counts as a dead end.
_DRAWS = 256
# Dead ends at one place, each of which takes some steps back, before all starts again.
_PATIENCE = 64
# Steps between two looks at the watch.
_STEPS = 20_000


@pure_jit
def _window_of(placed: Placed, step: int) -> tuple[int, int]:
    """Row and column of the window that a step completes."""
    down = placed.rows - placed.rules.window + 1
    across = placed.cols - placed.rules.window + 1
    if step < across:
        return 0, step
    if step < across + down - 1:
        return step - across + 1, 0
    rest = step - across - down + 1
    return 1 + rest // (across - 1), 1 + rest % (across - 1)


@pure_jit
def _extend(placed: Placed, row: int, col: int) -> bool:
    """Draw the cells that the window at (row, col) lacks until it is allowed, and place it.

    A single cell is tried at every level once, in turn from a random one.
    """
    b, levels = placed.rules.window, placed.rules.levels
    top, left = row + b - 1 if row else 0, col + b - 1 if col else 0
    tries = levels if row and col else _DRAWS
    first = draw(placed.state, levels)
    for attempt in range(tries):
        for i in range(top, row + b):
            for j in range(left, col + b):
                level = (first + attempt) % levels
                placed.field[i, j] = level if tries == levels else draw(placed.state, levels)
        if allowed(placed, row, col):
            place(placed, row, col)
            return True
    return False


@pure_jit
def grow(placed: Placed, first: int, last: int) -> int:
    """Take growth steps first … last − 1; return the step that dead-ended, or ``last``.

    Every step completes one window, in the order of the module's list. From ``first`` to a lesser
    ``last``, steps are undone.
    """
    for step in range(first - 1, last - 1, -1):
        row, col = _window_of(placed, step)
        displace(placed, row, col)
    for step in range(first, last):
        row, col = _window_of(placed, step)
        if not _extend(placed, row, col):
            return step
    return last


def grow_field(spec: FieldSpec, watch: Watch, beside: Fields = ()) -> NDArray[np.uint8]:
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
        field, step, spent = _attempt(spec, placed_beside(spec, stream, beside), watch)
        if step == spec.windows:
            return field.copy()
        if step > most:
            best, most = field, step
        if spent:
            break
    raise FieldSearchError(
        f"growth dead-ended {stream} times; it completed {most} of {spec.windows} windows at "
        "best: take a smaller field, a lesser distance, or another method",
        _whole_rows(best, most, spec),
    )


def _attempt(spec: FieldSpec, placed: Placed, watch: Watch) -> tuple[NDArray[np.uint8], int, bool]:
    """A field, the steps that it completed, and whether time is spent."""
    field = placed.field[: spec.rows, : spec.cols]
    step, farthest, dead_ends = 0, 0, 0
    patience = 0 if spec.method == "growth" else _PATIENCE
    while True:
        last = min(step + _STEPS, spec.windows)
        step = grow(placed, step, last)
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
        step = grow(placed, step, max(0, step - spec.window * (dead_ends & -dead_ends)))


def _whole_rows(
    field: NDArray[np.uint8] | None, steps: int, spec: FieldSpec
) -> NDArray[np.uint8] | None:
    """The part of a field that ``steps`` steps completed, as whole rows; None where none did."""
    across, down = spec.cols - spec.window + 1, spec.rows - spec.window + 1
    if field is None or steps < across:
        return None
    rest = max(0, steps - across - down + 1) // max(1, across - 1)
    return field[: spec.window + min(rest, down - 1)].copy()
