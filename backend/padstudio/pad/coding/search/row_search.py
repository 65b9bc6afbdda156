"""The search over the rows of a board (see `rows`): fill a row, take rows back."""

from __future__ import annotations

import numpy as np

from padstudio.compiled import jit
from padstudio.pad.coding.search.board import I16, I32, I64, U8, U64, board, give_back
from padstudio.pad.coding.search.bounds import bounds, ruled_out
from padstudio.pad.coding.search.random import draw
from padstudio.pad.coding.search.spec import FieldSpec, Watch
from padstudio.pad.coding.search.trellis import start, sweep, walk

# Cost of a cell below which one window is left; k windows cost a k-th of it. Random costs are 0 …
# 63 a cell.
_SCARCE = 4096
# Near the bound, open windows at random no longer join up to open rows: at two levels a cell has
# two ways on, half of them closed. Cells are then biased, so that the windows left over are alike
# in that, and join up. Measured to pay for short rows only, and less at a distance.
_SHORT_ROW = 500
_SCARCE_TIGHT, _BIAS, _BIAS_AT_DISTANCE = 64, 64, 32
# Dead ends at one place of a row before rows are taken back.
_ROW_TRIES = 64
# Codes entered between two looks at the watch.
_CODES = 50_000


@jit
def _read_lines(row: int, field: U8, lines: I64, levels: int) -> None:
    """Enter the lines of the b - 1 rows above one."""
    b = lines.shape[0]
    per = levels**b
    for i in range(b - 1):
        line = 0
        for col in range(field.shape[1]):
            line = (line * levels + field[row - b + 1 + i, col]) % per
            if col >= b - 1:
                lines[i, col - b + 1] = line


@jit
def fill(
    row: int,
    field: U8,
    taken: U64,
    free: I16,
    turned: I64,
    journal: I32,
    starts: I64,
    lines: I64,
    value: I32,
    choice: U8,
    reach: U8,
    offsets: I64,
    levels: int,
    distance: int,
    visible: bool,
    scarce: int,
    bias: int,
    state: U64,
    counts: I64,
) -> bool:
    """Fill a row below b - 1 others, or leave it as it was."""
    b, across = lines.shape
    per = value.shape[1] * levels
    _read_lines(row, field, lines, levels)
    number = (row - b + 1) * across
    starts[number] = counts[1]
    first, last, farthest, tries = 0, across, -1, 0
    while tries < _ROW_TRIES:
        sweep(
            first, last, row, field, taken, free, lines, value, choice, levels, visible, scarce,
            bias, state,
        )  # fmt: skip
        if first == 0 and not start(row, field, value, levels, visible, b):
            break
        reached = walk(
            first, row, field, taken, free, turned, journal, starts, lines, value, choice, reach,
            offsets, levels, distance, counts,
        )  # fmt: skip
        if reached == across:
            starts[number + across] = counts[1]
            return True
        if reached > farthest:
            farthest, tries = reached, 0
        tries += 1
        first = max(0, reached - b * (tries & -tries))
        last = min(across, reached + 2 * b)
        give_back(starts[number + first], counts[1], taken, free, per, journal)
        counts[1] = starts[number + first]
    give_back(starts[number], counts[1], taken, free, per, journal)
    counts[1] = starts[number]
    return False


@jit
def top_row(row: int, field: U8, levels: int, visible: bool, b: int, state: U64) -> None:
    """Fill a row that completes no window."""
    run = 0
    for col in range(field.shape[1]):
        field[row, col] = draw(state, levels)
        if visible and row:
            run = run + 1 if field[row, col] == field[row - 1, col] else 0
            if run == b:
                field[row, col] = (field[row, col] + 1) % levels
                run = 0


@jit
def search(
    field: U8,
    taken: U64,
    free: I16,
    turned: I64,
    journal: I32,
    starts: I64,
    lines: I64,
    value: I32,
    choice: U8,
    reach: U8,
    best: U8,
    state: U64,
    counts: I64,
    levels: int,
    distance: int,
    visible: bool,
    scarce: int,
    bias: int,
    fills: int,
) -> int:
    """Try to fill a number of rows, taking rows back on failure; return the row in work."""
    b, across = lines.shape
    per = levels**b
    offsets = np.empty(b * b * (levels - 1), np.int64)
    for _ in range(fills):
        row = counts[0]
        if row == field.shape[0]:
            break
        if row < b - 1:
            top_row(row, field, levels, visible, b, state)
            counts[0] += 1
        elif fill(
            row, field, taken, free, turned, journal, starts, lines, value, choice, reach, offsets,
            levels, distance, visible, scarce, bias, state, counts,
        ):  # fmt: skip
            counts[0] += 1
            if row >= counts[2]:
                counts[2], counts[3] = row + 1, 0
        else:
            if row > counts[4]:
                counts[4] = row
                best[:row] = field[:row]
            counts[3] += 1
            back = row - (counts[3] & -counts[3])
            if back < b - 1:
                back, counts[2], counts[3] = 0, 0, 0
            counts[0] = back
            window = max(0, back - b + 1) * across
            give_back(starts[window], counts[1], taken, free, per, journal)
            counts[1] = starts[window]
    return int(counts[0])


def rule(spec: FieldSpec) -> tuple[int, int]:
    """Costs of scarce and of biased cells for a spec."""
    if bounds(spec).outlook == "easy" or spec.cols > _SHORT_ROW:
        return _SCARCE, 0
    return _SCARCE_TIGHT, _BIAS if spec.distance == 1 else _BIAS_AT_DISTANCE


class RowSearch:
    """A search row by row that can be gone on with.

    Attributes
    ----------
    reached : int
        Rows filled at best.
    best : (rows, cols) uint8
        A field that has them.
    """

    def __init__(self, spec: FieldSpec) -> None:
        self._spec = spec
        self._board = board(spec)
        self._costs = rule(spec)
        codes = spec.cols * spec.turns * ruled_out(spec)
        self._fills = max(1, _CODES // codes)
        self.reached, self.best = 0, self._board.field

    def run(self, watch: Watch, rounds: int) -> bool:
        """Search on for a number of rounds; true once it is whole, or time is spent."""
        spec, made = self._spec, self._board
        for _ in range(rounds):
            row = search(
                *made, spec.levels, spec.distance, spec.visible_lines, *self._costs, self._fills
            )
            deepest = int(made.counts[4])
            self.reached, self.best = max((row, made.field), (deepest, made.best), key=_rows)
            if row == spec.rows or watch.spent(row / spec.rows):
                return True
        return False


def _rows(reached: tuple[int, U8]) -> int:
    return reached[0]
