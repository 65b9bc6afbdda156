"""Hash chains over the windows placed in a field, by which near ones are found.

Windows are looked up in chains over parts of a window: of two windows nearer than d, at least one
of d disjoint parts is equal (pigeonhole), so one chain a part finds every near window without a
table of all windows (multi-index hashing, as in `padstudio.pad.coding.verify`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.compiled import pure_jit
from padstudio.pad.coding.search.random import random_state
from padstudio.pad.coding.search.spec import Fields, FieldSpec, Rules

# The numbers of FNV-1a with 64 bits (Fowler, Noll, Vo).
_PRIME = np.uint64(0x100000001B3)
_OFFSET = np.uint64(0xCBF29CE484222325)
# It mixes upward only, and buckets are told by the lower bits: fold the upper ones in.
_S29, _S32 = np.uint64(29), np.uint64(32)


class Placed(NamedTuple):
    """A field in growth, and the windows placed in it.

    Attributes
    ----------
    rules
    rows, cols : int
        Of the field in growth.
    field : (rows or more, cols or more) uint8
        The field in growth at the upper left, and below it others, whose windows are placed.
    heads : (distance, buckets) int32
        Per part and bucket, the number of the window placed last; -1 for none.
    links : (distance, windows) int32
        Per part, the window that was in the bucket before; -1 for none.
    cells : (turns, b²) uint8
        Scratch: the window in work, one line a counter-clockwise turn.
    state : (1,) uint64
        Random state.
    """

    rules: Rules
    rows: int
    cols: int
    field: NDArray[np.uint8]
    heads: NDArray[np.int32]
    links: NDArray[np.int32]
    cells: NDArray[np.uint8]
    state: NDArray[np.uint64]


def placed_beside(spec: FieldSpec, stream: int, fields: Fields = ()) -> Placed:
    """An empty field beside others, and the random stream of the seed that it is grown from."""
    canvas, parts = _stack(spec, fields)
    windows = (len(canvas) - spec.window + 1) * (canvas.shape[1] - spec.window + 1)
    size = 1 << max(4, int(windows - 1).bit_length())
    placed = Placed(
        rules=spec.rules,
        rows=spec.rows,
        cols=spec.cols,
        field=canvas,
        heads=np.full((spec.distance, size), -1, np.int32),
        links=np.full((spec.distance, windows), -1, np.int32),
        cells=np.zeros((spec.turns, spec.window**2), np.uint8),
        state=random_state(spec.seed, stream),
    )
    for row, rows, cols in parts:
        _place_all(placed, row, rows, cols)
    return placed


def _stack(spec: FieldSpec, fields: Fields) -> tuple[NDArray[np.uint8], list[tuple[int, int, int]]]:
    """Room for a field, above others: as they are, or in all turns where it is compared in one.

    Returns
    -------
    canvas : (rows, cols) uint8
        The field to come is its upper left part.
    parts : list of (row, rows, cols)
        Where the others are, from column 0 on.
    """
    others = [np.rot90(field, turn) for field in fields for turn in range(4 // spec.turns)]
    rows = spec.rows + sum(len(other) for other in others)
    canvas = np.zeros((rows, max([spec.cols, *(other.shape[1] for other in others)])), np.uint8)
    parts: list[tuple[int, int, int]] = []
    row = spec.rows
    for other in others:
        canvas[row : row + len(other), : other.shape[1]] = other
        parts.append((row, other.shape[0], other.shape[1]))
        row += len(other)
    return canvas, parts


@pure_jit
def _read(placed: Placed, row: int, col: int) -> None:
    """Copy the window at (row, col) into ``cells``."""
    cells, b = placed.cells, placed.rules.window
    last = b - 1
    for i in range(b):
        for j in range(b):
            level = placed.field[row + i, col + j]
            cells[0, i * b + j] = level
            if len(cells) == 4:
                cells[1, (last - j) * b + i] = level
                cells[2, (last - i) * b + last - j] = level
                cells[3, j * b + last - i] = level


@pure_jit
def _bucket(placed: Placed, turn: int, part: int) -> int:
    """Hash of a part of the window in work: every ``distance``-th cell, from cell ``part`` on."""
    parts, buckets = placed.heads.shape
    h = _OFFSET
    for k in range(part, placed.cells.shape[1], parts):
        h = (h ^ np.uint64(placed.cells[turn, k])) * _PRIME
        h ^= h >> _S29
    return int(np.int64((h ^ (h >> _S32)) & np.uint64(buckets - 1)))


@pure_jit
def _lines_visible(placed: Placed) -> bool:
    """Whether each inner grid line of the window in work has a level change across it."""
    cells, b = placed.cells, placed.rules.window
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


@pure_jit
def _near(placed: Placed, turn: int, number: int) -> bool:
    """Whether the window in work, turned, is nearer than the distance to a placed one."""
    cells, b = placed.cells, placed.rules.window
    across = placed.field.shape[1] - b + 1
    row, col = number // across, number % across
    differing = 0
    for i in range(b):
        for j in range(b):
            if cells[turn, i * b + j] != placed.field[row + i, col + j]:
                differing += 1
                if differing >= placed.rules.distance:
                    return False
    return True


@pure_jit
def _near_itself(placed: Placed) -> bool:
    """Whether the window in work is nearer than the distance to itself turned."""
    cells = placed.cells
    for turn in range(1, min(len(cells), 3)):
        differing = 0
        for k in range(cells.shape[1]):
            if cells[turn, k] != cells[0, k]:
                differing += 1
        if differing < placed.rules.distance:
            return True
    return False


@pure_jit
def allowed(placed: Placed, row: int, col: int) -> bool:
    """Whether the window at (row, col) may stand beside all windows placed; it is then in work."""
    _read(placed, row, col)
    if placed.rules.visible_lines and not _lines_visible(placed):
        return False
    if _near_itself(placed):
        return False
    for turn in range(len(placed.cells)):
        for part in range(placed.rules.distance):
            other = placed.heads[part, _bucket(placed, turn, part)]
            while other >= 0:
                if _near(placed, turn, other):
                    return False
                other = placed.links[part, other]
    return True


@pure_jit
def place(placed: Placed, row: int, col: int) -> None:
    """Enter the window in work, which stands at (row, col), into the chains."""
    number = row * (placed.field.shape[1] - placed.rules.window + 1) + col
    for part in range(len(placed.heads)):
        at = _bucket(placed, 0, part)
        placed.links[part, number] = placed.heads[part, at]
        placed.heads[part, at] = number


@pure_jit
def _place_all(placed: Placed, first: int, rows: int, cols: int) -> None:
    """Enter all windows of the field that begins at row ``first``."""
    b = placed.rules.window
    for row in range(first, first + rows - b + 1):
        for col in range(cols - b + 1):
            _read(placed, row, col)
            place(placed, row, col)


@pure_jit
def displace(placed: Placed, row: int, col: int) -> None:
    """Undo `place` of the window placed last, at (row, col)."""
    number = row * (placed.field.shape[1] - placed.rules.window + 1) + col
    _read(placed, row, col)
    for part in range(len(placed.heads)):
        placed.heads[part, _bucket(placed, 0, part)] = placed.links[part, number]
