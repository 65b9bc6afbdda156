"""Growth of a field at random, as in the paper: start block, to the right, down, never a repeat.

1. A random b × b block at the top left.
2. To the right: one random column of b cells at a time; each completes one window.
3. Down: one random row of b cells at a time; each completes one window.
4. The rest in reading order, one random cell at a time; each completes one window.

Whatever is added is drawn again where its window is not allowed. Windows are looked up in hash
chains over parts of a window: of two windows nearer than d, at least one of d disjoint parts is
equal (pigeonhole), so one chain a part finds every near window without a table of all windows.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.pad.field_spec import FieldSearchError, FieldSpec, Watch
from padstudio.pad.jit import draw, jit, random_state

U8 = NDArray[np.uint8]
I32 = NDArray[np.int32]
U64 = NDArray[np.uint64]

_PRIME = np.uint64(0x100000001B3)
_OFFSET = np.uint64(0xCBF29CE484222325)
_S29, _S32 = np.uint64(29), np.uint64(32)
# Draws of a whole row or column of b cells before it counts as a dead end.
_DRAWS = 256
# Steps between two looks at the watch.
_STEPS = 20_000


class Chains(NamedTuple):
    """The windows placed so far: per part, hash heads and links of window numbers, -1 for none."""

    heads: NDArray[np.int32]
    links: NDArray[np.int32]


def chains(windows: int, parts: int) -> Chains:
    """Empty chains for a number of windows, one chain system a part."""
    size = 1 << max(4, int(windows - 1).bit_length())
    return Chains(np.full((parts, size), -1, np.int32), np.full((parts, windows), -1, np.int32))


@jit
def _read(field: U8, row: int, col: int, b: int, turns: int, cells: U8) -> None:
    """Copy the window at (row, col) into cells (turns, b²), one line a counter-clockwise turn."""
    last = b - 1
    for i in range(b):
        for j in range(b):
            level = field[row + i, col + j]
            cells[0, i * b + j] = level
            if turns == 4:
                cells[1, (last - j) * b + i] = level
                cells[2, (last - i) * b + last - j] = level
                cells[3, j * b + last - i] = level


@jit
def _bucket(cells: U8, turn: int, part: int, parts: int, mask: int) -> int:
    """Hash of every ``parts``-th cell of a turned window, from cell ``part`` on."""
    h = _OFFSET
    for k in range(part, cells.shape[1], parts):
        h = (h ^ np.uint64(cells[turn, k])) * _PRIME
        h ^= h >> _S29
    return int(np.int64((h ^ (h >> _S32)) & np.uint64(mask)))


@jit
def _lines_visible(cells: U8, b: int) -> bool:
    """Whether each inner grid line of the upright window has a level change across it."""
    for line in range(1, b):
        across_row, across_col = False, False
        for k in range(b):
            if cells[0, line * b + k] != cells[0, (line - 1) * b + k]:
                across_row = True
            if cells[0, k * b + line] != cells[0, k * b + line - 1]:
                across_col = True
        if not (across_row and across_col):
            return False
    return True


@jit
def _nearer(cells: U8, turn: int, field: U8, row: int, col: int, b: int, distance: int) -> bool:
    """Whether a turned window is nearer than ``distance`` to the window of the field at a place."""
    differing = 0
    for i in range(b):
        for j in range(b):
            if cells[turn, i * b + j] != field[row + i, col + j]:
                differing += 1
                if differing >= distance:
                    return False
    return True


@jit
def _allowed(
    field: U8,
    row: int,
    col: int,
    b: int,
    distance: int,
    visible: bool,
    heads: I32,
    links: I32,
    cells: U8,
) -> bool:
    """Whether the window at (row, col) may stand beside all windows placed; fills ``cells``."""
    turns, size, mask = cells.shape[0], b * b, heads.shape[1] - 1
    across = field.shape[1] - b + 1
    _read(field, row, col, b, turns, cells)
    if visible and not _lines_visible(cells, b):
        return False
    for turn in range(1, min(turns, 3)):
        differing = 0
        for k in range(size):
            if cells[turn, k] != cells[0, k]:
                differing += 1
        if differing < distance:
            return False
    for turn in range(turns):
        for part in range(distance):
            other = int(heads[part, _bucket(cells, turn, part, distance, mask)])
            while other >= 0:
                if _nearer(cells, turn, field, other // across, other % across, b, distance):
                    return False
                other = int(links[part, other])
    return True


@jit
def _place(row: int, col: int, across: int, heads: I32, links: I32, cells: U8) -> None:
    """Enter the upright window of ``cells``, which stands at (row, col), into the chains."""
    parts, mask, number = heads.shape[0], heads.shape[1] - 1, row * across + col
    for part in range(parts):
        bucket = _bucket(cells, 0, part, parts, mask)
        links[part, number] = heads[part, bucket]
        heads[part, bucket] = number


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
        if _allowed(field, row, col, b, distance, visible, heads, links, cells):
            _place(row, col, field.shape[1] - b + 1, heads, links, cells)
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
        row, col, top, left = 0, 0, 0, 0
        if 0 < step < across:
            col, left = step, step + b - 1
        elif across <= step < across + down - 1:
            row, top = step - across + 1, step - across + b
        elif step:
            rest = step - across - down + 1
            row, col = 1 + rest // (across - 1), 1 + rest % (across - 1)
            top, left = row + b - 1, col + b - 1
        if not _extend(
            field, row, col, top, left, b, levels, distance, visible, heads, links, cells, state
        ):
            return step
    return last


def grow_field(spec: FieldSpec, watch: Watch) -> NDArray[np.uint8]:
    """Grow a field; a dead end starts again from a new block, with the next random stream.

    Returns
    -------
    (rows, cols) uint8

    Raises
    ------
    FieldSearchError
        Where the budget ends first, with the whole rows of the farthest attempt.
    """
    best, most = None, 0
    stream = 0
    while True:
        field = np.zeros((spec.rows, spec.cols), np.uint8)
        placed = chains(spec.windows, spec.distance)
        state = random_state(spec.seed, stream)
        step, spent = 0, False
        while not spent:
            last = min(step + _STEPS, spec.windows)
            step = grow(
                field, step, last, spec.window, spec.levels, spec.turns, spec.distance,
                spec.visible_lines, placed.heads, placed.links, state,
            )  # fmt: skip
            spent = watch.spent(step / spec.windows)
            if step == spec.windows:
                return field
            if step < last:
                break
        if step > most:
            best, most = field, step
        if spent:
            raise FieldSearchError(
                f"growth dead-ended {stream + 1} times; it completed {most} of {spec.windows} "
                "windows at best: take a smaller field, a lesser distance, or another method",
                _whole_rows(best, most, spec),
            )
        stream += 1


def _whole_rows(
    field: NDArray[np.uint8] | None, steps: int, spec: FieldSpec
) -> NDArray[np.uint8] | None:
    """The part of a field that ``steps`` steps completed, as whole rows; None where none did."""
    across, down = spec.cols - spec.window + 1, spec.rows - spec.window + 1
    if field is None or steps < across:
        return None
    rest = max(0, steps - across - down + 1) // max(1, across - 1)
    return field[: spec.window + min(rest, down - 1)].copy()
