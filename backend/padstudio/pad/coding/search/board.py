"""The state of a search row by row: the field, and a table of all windows that are still allowed.

A window enters with all its turns and everything nearer than the distance to any of them, so that
one bit of the table tells whether a window is still allowed.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.compiled import inlined_jit, pure_jit
from padstudio.pad.coding.search.random import random_state
from padstudio.pad.coding.search.spec import FieldSpec, Rules

U8 = NDArray[np.uint8]
U64 = NDArray[np.uint64]
I16 = NDArray[np.int16]
I32 = NDArray[np.int32]
I64 = NDArray[np.int64]

_ONE, _LOW_SIX = np.uint64(1), np.uint64(63)
# Places in `Board.counts`.
ROW, LENGTH, FRONTIER, FAILURES, BEST_ROWS, READY = range(6)


class Costs(NamedTuple):
    """What cells cost that leave few windows below (k windows a k-th of it), or break the bias."""

    scarce: int
    bias: int


class Board(NamedTuple):
    """The state of a search.

    A window's code is its base-Y number, row by row; a *line* is the base-Y number of b cells side
    by side; a *block* is the code of the b − 1 upper rows of a window.

    Attributes
    ----------
    rules, costs
    field : (rows, cols) uint8
    taken : (Y^b² / 64,) uint64
        One bit a code: 1 where the window is not allowed.
    free : (Y^(b² − b),) int16
        Allowed windows that continue each block.
    turned : (turns, b, Y^b) int64
        What a line in each row of a window adds to the code of the turned window.
    journal, starts
        Codes in the order they were taken, and the journal's length before each window.
    lines : (b, across) int64
        Lines above the row in work, and its own.
    value : (across + 1, Y^(b − 1)) int32
        Least cost to the row's end.
    choice : (across, Y^(b − 1)) uint8
        The level that leads there.
    reach : (across + 1, Y^(b − 1)) uint8
        Which states the row below can have.
    best : (rows, cols) uint8
        The field as it was when most rows were filled.
    changes : (b² (Y − 1),) int64
        Scratch: what changes of one cell add to a code.
    stack : (2, distance) int64
        Scratch: codes on the way to a near one, and the next change of each.
    state : (1,) uint64
        Random state.
    counts : (6,) int64
        Row in work, length of the journal, the row most filled since all rows were taken back,
        failures there, rows of ``best``, whether `take_symmetric` is done.
    """

    rules: Rules
    costs: Costs
    field: U8
    taken: U64
    free: I16
    turned: I64
    journal: I32
    starts: I64
    lines: I64
    value: I32
    choice: U8
    reach: U8
    best: U8
    changes: I64
    stack: I64
    state: U64
    counts: I64


def board(spec: FieldSpec, costs: Costs) -> Board:
    """An empty board for a spec."""
    b, levels = spec.window, spec.levels
    codes = levels ** (b * b)
    across = spec.cols - b + 1
    return Board(
        rules=spec.rules,
        costs=costs,
        field=np.zeros((spec.rows, spec.cols), np.uint8),
        taken=np.zeros(codes // 64 + 1, np.uint64),
        free=np.full(levels ** (b * b - b), levels**b, np.int16),
        turned=turned_lines(b, levels, spec.turns),
        journal=np.empty(codes, np.int32),
        starts=np.zeros(spec.windows + 1, np.int64),
        lines=np.zeros((b, across), np.int64),
        value=np.zeros((across + 1, levels ** (b - 1)), np.int32),
        choice=np.zeros((across, levels ** (b - 1)), np.uint8),
        reach=np.zeros((across + 1, levels ** (b - 1)), np.uint8),
        best=np.zeros((spec.rows, spec.cols), np.uint8),
        changes=np.zeros(b * b * (levels - 1), np.int64),
        stack=np.zeros((2, spec.distance), np.int64),
        state=random_state(spec.seed),
        counts=np.zeros(6, np.int64),
    )


def turned_lines(b: int, levels: int, turns: int) -> I64:
    """``turned`` of `Board`; turn t is t quarter turns counter-clockwise."""
    weights = (levels ** np.arange(b * b - 1, -1, -1)).reshape(b, b)
    digits = np.stack([np.arange(levels**b) // levels ** (b - 1 - j) % levels for j in range(b)])
    return np.stack([np.rot90(weights, -t) @ digits for t in range(turns)]).astype(np.int64)


@inlined_jit
def is_taken(taken: U64, code: int) -> bool:
    """Whether a window is not allowed."""
    return bool((taken[code >> 6] >> (np.uint64(code) & _LOW_SIX)) & _ONE)


@inlined_jit
def take(board: Board, code: int) -> None:
    """Take a code, and note it in the journal, where it is not taken."""
    taken, counts = board.taken, board.counts
    word, bit = taken[code >> 6], _ONE << (np.uint64(code) & _LOW_SIX)
    if word & bit == 0:
        taken[code >> 6] = word | bit
        board.free[code // board.turned.shape[2]] -= 1
        board.journal[counts[LENGTH]] = code
        counts[LENGTH] += 1


@inlined_jit
def _take_changed(board: Board, code: int, first: int) -> None:
    """Take the codes that the changes from ``first`` on make of a code."""
    for k in range(first, len(board.changes)):
        take(board, code + board.changes[k])


@inlined_jit
def _give(board: Board, code: int) -> None:
    """Allow a window again."""
    board.taken[code >> 6] &= ~(_ONE << (np.uint64(code) & _LOW_SIX))
    board.free[code // board.turned.shape[2]] += 1


@pure_jit
def give_back(board: Board, length: int) -> None:
    """Undo the journal down to a length."""
    for k in range(length, board.counts[LENGTH]):
        _give(board, board.journal[k])
    board.counts[LENGTH] = length


@inlined_jit
def _find_changes(board: Board, code: int) -> None:
    """Enter what each other level of each cell, the last cell first, would add to a code."""
    levels, weight, k = board.rules.levels, 1, 0
    while k < len(board.changes):
        digit = code // weight % levels
        for level in range(levels):
            if level != digit:
                board.changes[k] = (level - digit) * weight
                k += 1
        weight *= levels


@pure_jit
def take_near(board: Board, code: int, depth: int) -> None:
    """Take all codes that differ from one in 1 … depth cells; depth is below the distance.

    A stack, because Numba cannot load recursive functions from its cache.
    """
    if depth == 0:
        return
    _find_changes(board, code)
    changes, others = board.changes, board.rules.levels - 1
    codes, at = board.stack[0], board.stack[1]
    codes[0], at[0] = code, 0
    _take_changed(board, code, 0)
    level = 0
    while level >= 0:
        if level == depth - 1 or at[level] == len(changes):
            level -= 1
            continue
        codes[level + 1] = codes[level] + changes[at[level]]
        at[level] += 1
        # A cell is changed once: go on with the first change of the next cell.
        at[level + 1] = (at[level] + others - 1) // others * others
        level += 1
        _take_changed(board, codes[level], at[level])


@pure_jit
def _turn(code: int, turn: int, turned: I64) -> int:
    """The code of the turned window."""
    out = 0
    for row in range(turned.shape[1] - 1, -1, -1):
        out += turned[turn, row, code % turned.shape[2]]
        code //= turned.shape[2]
    return out


@pure_jit
def _differing(one: int, other: int, levels: int) -> int:
    """In how many cells two windows differ."""
    cells = 0
    while one != other:
        if one % levels != other % levels:
            cells += 1
        one //= levels
        other //= levels
    return cells


@pure_jit
def take_symmetric(board: Board) -> None:
    """Take for good, once, all windows nearer than the distance to themselves turned.

    A half turn pairs cells, so k pairs that differ are mended by k changes and cost 2 k. A quarter
    turn within less than the distance is within ``distance - 1`` changes of a window that it
    leaves as it is; of these too many are taken first, then given back.
    """
    rules, turned = board.rules, board.turned
    if board.counts[READY] or rules.turns < 4:
        return
    levels, size = rules.levels, rules.window**2
    odd = levels if rules.window % 2 else 1
    for upper in range(levels ** ((size + 1) // 2)):
        code, rest = upper, upper // odd
        for _ in range(size // 2):
            code = code * levels + rest % levels
            rest //= levels
        quarter = rules.distance > 2 and _turn(code, 1, turned) == code
        take(board, code)
        take_near(board, code, rules.distance - 1 if quarter else (rules.distance - 1) // 2)
    for k in range(board.counts[LENGTH]):
        code = board.journal[k]
        nearest = min(
            _differing(code, _turn(code, 1, turned), levels),
            _differing(code, _turn(code, 2, turned), levels),
        )
        if nearest >= rules.distance:
            _give(board, code)
    board.counts[LENGTH], board.counts[READY] = 0, 1
