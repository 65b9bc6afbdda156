"""Hash chains over the windows placed in a field, by which near ones are found.

Windows are looked up in chains over parts of a window: of two windows nearer than d, at least one
of d disjoint parts is equal (pigeonhole), so one chain a part finds every near window without a
table of all windows.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.compiled import jit

U8 = NDArray[np.uint8]
I32 = NDArray[np.int32]

_PRIME = np.uint64(0x100000001B3)
_OFFSET = np.uint64(0xCBF29CE484222325)
_S29, _S32 = np.uint64(29), np.uint64(32)


class Chains(NamedTuple):
    """The windows placed so far: per part, hash heads and links of window numbers, -1 for none."""

    heads: NDArray[np.int32]
    links: NDArray[np.int32]


def chains(windows: int, parts: int) -> Chains:
    """Empty chains for a number of windows, one chain system a part."""
    size = 1 << max(4, int(windows - 1).bit_length())
    return Chains(np.full((parts, size), -1, np.int32), np.full((parts, windows), -1, np.int32))


@jit
def read_window(field: U8, row: int, col: int, b: int, turns: int, cells: U8) -> None:
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
def bucket(cells: U8, turn: int, part: int, parts: int, mask: int) -> int:
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
def allowed(
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
    read_window(field, row, col, b, turns, cells)
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
            other = int(heads[part, bucket(cells, turn, part, distance, mask)])
            while other >= 0:
                if _nearer(cells, turn, field, other // across, other % across, b, distance):
                    return False
                other = int(links[part, other])
    return True


@jit
def place(row: int, col: int, across: int, heads: I32, links: I32, cells: U8) -> None:
    """Enter the upright window of ``cells``, which stands at (row, col), into the chains."""
    parts, mask, number = heads.shape[0], heads.shape[1] - 1, row * across + col
    for part in range(parts):
        at = bucket(cells, 0, part, parts, mask)
        links[part, number] = heads[part, at]
        heads[part, at] = number


@jit
def displace(row: int, col: int, across: int, heads: I32, links: I32, cells: U8) -> None:
    """Undo `place` of the window placed last, of which ``cells`` are."""
    parts, mask = heads.shape[0], heads.shape[1] - 1
    for part in range(parts):
        heads[part, bucket(cells, 0, part, parts, mask)] = links[part, row * across + col]
