"""Boards as a search finds them: symmetric windows and those of other fields are taken.

Windows of other fields are taken in every turn, with all near them.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from padstudio.compiled import pure_jit
from padstudio.pad.coding.search.board import (
    I16,
    I64,
    LENGTH,
    READY,
    U64,
    Board,
    Costs,
    board,
    take,
    take_near,
    take_symmetric,
    turned_lines,
)
from padstudio.pad.coding.search.spec import Fields, FieldSpec, Rules

# Tables of up to so many windows are kept, 8 MB: symmetric windows take a fifth of a small pad's
# time, and are the same for each of its fields.
_KEPT_CODES = 2**26


def board_beside(spec: FieldSpec, costs: Costs, fields: Fields) -> Board:
    """An empty board on which all windows of some fields, and those near them, are taken."""
    made = board(spec, costs)
    if spec.turns == 4 and spec.levels ** (spec.window**2) <= _KEPT_CODES:
        taken, free = _symmetric(made.rules)
        made.taken[:], made.free[:] = taken, free
        made.counts[READY] = 1
    b, levels = spec.window, spec.levels
    turned = turned_lines(b, levels, 4)
    for field in fields:
        across = field.shape[1] - b + 1
        lines = np.zeros((len(field), across), np.int64)
        for j in range(b):
            lines = lines * levels + field[:, j : j + across]
        _take_all(made, lines, turned)
    # The journal holds what may be given back.
    made.counts[LENGTH] = 0
    return made


@lru_cache(maxsize=1)
def _symmetric(rules: Rules) -> tuple[U64, I16]:
    """`Board.taken` and `Board.free` once symmetric windows are taken."""
    b = rules.window
    smallest = FieldSpec(
        rows=b, cols=b, window=b, levels=rules.levels, distance=rules.distance, unique="rotation"
    )
    made = board(smallest, Costs(0, 0))
    take_symmetric(made)
    return made.taken, made.free


@pure_jit
def _take_all(board: Board, lines: I64, turned: I64) -> None:
    """Take all windows that lines (rows, across) make, in every turn, and all near them."""
    b, distance = board.rules.window, board.rules.distance
    for row in range(lines.shape[0] - b + 1):
        for col in range(lines.shape[1]):
            for turn in range(turned.shape[0]):
                code = 0
                for i in range(b):
                    code += turned[turn, i, lines[row + i, col]]
                take(board, code)
                if distance > 1:
                    take_near(board, code, distance - 1)
