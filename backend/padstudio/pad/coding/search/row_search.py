"""Growth of a field row by row, over a table of all windows, looking ahead over the whole row.

Each row is a path through a trellis (`padstudio.pad.coding.search.trellis`). Where a row dead-ends
the walk goes back some cells, and after many dead ends at one place rows are taken back: how many
goes by Luby's sequence (Luby, Sinclair, Zuckerman, "Optimal speedup of Las Vegas algorithms", Inf.
Process. Lett. 47, 1993, doi:10.1016/0020-0190(93)90029-9).
"""

from __future__ import annotations

from padstudio.compiled import pure_jit
from padstudio.pad.coding.search.beside import board_beside
from padstudio.pad.coding.search.board import (
    BEST_ROWS,
    FAILURES,
    FRONTIER,
    LENGTH,
    ROW,
    U8,
    Board,
    Costs,
    give_back,
    take_symmetric,
)
from padstudio.pad.coding.search.bounds import bounds, ruled_out
from padstudio.pad.coding.search.random import draw
from padstudio.pad.coding.search.spec import Fields, FieldSpec, Watch
from padstudio.pad.coding.search.trellis import find_paths, start, walk

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


@pure_jit
def _read_lines(board: Board, row: int) -> None:
    """Enter the lines of the b - 1 rows above one."""
    b, levels, per = board.rules.window, board.rules.levels, board.turned.shape[2]
    for i in range(b - 1):
        line = 0
        for col in range(board.field.shape[1]):
            line = (line * levels + board.field[row - b + 1 + i, col]) % per
            if col >= b - 1:
                board.lines[i, col - b + 1] = line


@pure_jit
def fill(board: Board, row: int) -> bool:
    """Fill a row below b - 1 others, or leave it as it was."""
    b, across = board.lines.shape
    _read_lines(board, row)
    number = (row - b + 1) * across
    board.starts[number] = board.counts[LENGTH]
    first, last, farthest, tries = 0, across, -1, 0
    while tries < _ROW_TRIES:
        find_paths(board, row, first, last)
        if first == 0 and not start(board, row):
            break
        reached = walk(board, row, first)
        if reached == across:
            board.starts[number + across] = board.counts[LENGTH]
            return True
        if reached > farthest:
            farthest, tries = reached, 0
        tries += 1
        first = max(0, reached - b * (tries & -tries))
        last = min(across, reached + 2 * b)
        give_back(board, board.starts[number + first])
    give_back(board, board.starts[number])
    return False


@pure_jit
def top_row(board: Board, row: int) -> None:
    """Fill a row that completes no window."""
    field, levels = board.field, board.rules.levels
    run = 0
    for col in range(field.shape[1]):
        field[row, col] = draw(board.state, levels)
        if board.rules.visible_lines and row:
            run = run + 1 if field[row, col] == field[row - 1, col] else 0
            if run == board.rules.window:
                field[row, col] = (field[row, col] + 1) % levels
                run = 0


@pure_jit
def search(board: Board, fills: int) -> int:
    """Try to fill a number of rows, taking rows back on failure; return the row in work."""
    b, counts = board.rules.window, board.counts
    take_symmetric(board)
    for _ in range(fills):
        row = counts[ROW]
        if row == len(board.field):
            break
        if row < b - 1:
            top_row(board, row)
            counts[ROW] += 1
        elif fill(board, row):
            counts[ROW] += 1
            if row >= counts[FRONTIER]:
                counts[FRONTIER], counts[FAILURES] = row + 1, 0
        else:
            _step_back(board, row)
    return int(counts[ROW])


@pure_jit
def _step_back(board: Board, row: int) -> None:
    """Take rows back where one cannot be filled, the more, the oftener that was so."""
    counts, top = board.counts, board.rules.window - 1
    if row > counts[BEST_ROWS]:
        counts[BEST_ROWS] = row
        for i in range(row):
            for j in range(board.field.shape[1]):
                board.best[i, j] = board.field[i, j]
    counts[FAILURES] += 1
    back = row - (counts[FAILURES] & -counts[FAILURES])
    if back < top:
        back, counts[FRONTIER], counts[FAILURES] = 0, 0, 0
    counts[ROW] = back
    give_back(board, board.starts[max(0, back - top) * board.lines.shape[1]])


def costs(spec: FieldSpec) -> Costs:
    """Costs of cells for a spec."""
    if bounds(spec).outlook == "easy" or spec.cols > _SHORT_ROW:
        return Costs(_SCARCE, 0)
    return Costs(_SCARCE_TIGHT, _BIAS if spec.distance == 1 else _BIAS_AT_DISTANCE)


class RowSearch:
    """A search row by row that can be gone on with.

    Parameters
    ----------
    spec
    beside
        Fields whose windows are taken.

    Attributes
    ----------
    reached : int
        Rows filled at best.
    best : (rows, cols) uint8
        A field that has them.
    """

    def __init__(self, spec: FieldSpec, beside: Fields = ()) -> None:
        self._spec = spec
        self._board = board_beside(spec, costs(spec), beside)
        codes = spec.cols * spec.turns * ruled_out(spec)
        self._fills = max(1, _CODES // codes)
        self.reached, self.best = 0, self._board.field

    def run(self, watch: Watch, rounds: int) -> bool:
        """Search on for a number of rounds; true once it is whole, or time is spent."""
        spec, made = self._spec, self._board
        for _ in range(rounds):
            row = search(made, self._fills)
            deepest = int(made.counts[BEST_ROWS])
            self.reached, self.best = max((row, made.field), (deepest, made.best), key=_rows)
            if row == spec.rows or watch.spent(row / spec.rows):
                return True
        return False


def _rows(reached: tuple[int, U8]) -> int:
    return reached[0]
