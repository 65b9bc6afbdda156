"""Growth of a field row by row, over a table of all windows, looking ahead over the whole row.

With the b − 1 rows above given, a new row is a path through a trellis: the state is the last b − 1
cells, each further cell completes one window, and windows that are taken are closed. The cheapest
open path is found from right to left (dynamic programming), then walked from left to right while
its windows are entered. A cell costs the more, the fewer windows are left that could continue
below it, so that the row after finds its way too; random costs on top make it a random field.
What the trellis does not see is windows that meet within the row itself, and a row that leaves the
next one without any open path: there the walk goes back some cells, and after many dead ends at one
place rows are taken back, by Luby's sequence (Luby, Sinclair, Zuckerman 1993,
doi:10.1016/0020-0190(93)90029-9).

A window enters with all its turns and everything nearer than the distance to any of them, so that
one bit of the table tells whether a window is still allowed.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.compiled import jit
from padstudio.pad.coding.search.random import random_state
from padstudio.pad.coding.search.spec import FieldSpec

I64 = NDArray[np.int64]

U8 = NDArray[np.uint8]
U64 = NDArray[np.uint64]
I16 = NDArray[np.int16]
I32 = NDArray[np.int32]

ONE, LOW_SIX = np.uint64(1), np.uint64(63)


class Board(NamedTuple):
    """The state of a search.

    A window's code is its base-Y number, row by row; a *line* is the base-Y number of b cells side
    by side; a *block* is the code of the b − 1 upper rows of a window.

    Attributes
    ----------
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
    state : (1,) uint64
        Random state.
    counts : (5,) int64
        Row in work, journal length, frontier row, failures there, rows of ``best``.
    """

    field: NDArray[np.uint8]
    taken: NDArray[np.uint64]
    free: NDArray[np.int16]
    turned: I64
    journal: NDArray[np.int32]
    starts: I64
    lines: I64
    value: NDArray[np.int32]
    choice: NDArray[np.uint8]
    reach: NDArray[np.uint8]
    best: NDArray[np.uint8]
    state: NDArray[np.uint64]
    counts: I64


def board(spec: FieldSpec) -> Board:
    """An empty board for a spec, symmetric windows taken."""
    b, levels = spec.window, spec.levels
    codes = levels ** (b * b)
    across = spec.cols - b + 1
    made = Board(
        field=np.zeros((spec.rows, spec.cols), np.uint8),
        taken=np.zeros(codes // 64 + 1, np.uint64),
        free=np.full(levels ** (b * b - b), levels**b, np.int16),
        turned=_turned_lines(b, levels, spec.turns),
        journal=np.empty(codes, np.int32),
        starts=np.zeros(spec.windows + 1, np.int64),
        lines=np.zeros((b, across), np.int64),
        value=np.zeros((across + 1, levels ** (b - 1)), np.int32),
        choice=np.zeros((across, levels ** (b - 1)), np.uint8),
        reach=np.zeros((across + 1, levels ** (b - 1)), np.uint8),
        best=np.zeros((spec.rows, spec.cols), np.uint8),
        state=random_state(spec.seed),
        counts=np.zeros(5, np.int64),
    )
    if spec.turns == 4:
        _take_symmetric(made.taken, made.free, made.turned, made.journal, levels, spec.distance)
    return made


def _turned_lines(b: int, levels: int, turns: int) -> I64:
    """``turned`` of `Board`; turn t is t quarter turns counter-clockwise."""
    weights = (levels ** np.arange(b * b - 1, -1, -1)).reshape(b, b)
    digits = np.stack([np.arange(levels**b) // levels ** (b - 1 - j) % levels for j in range(b)])
    return np.stack([np.rot90(weights, -t) @ digits for t in range(turns)]).astype(np.int64)


@jit
def take_run(
    base: int, offsets: I64, first: int, taken: U64, free: I16, per: int, journal: I32, length: int
) -> int:
    """Take the codes base + offset, offsets from ``first`` on; return the journal's new length."""
    for k in range(first, len(offsets)):
        code = base + int(offsets[k])
        word, bit = taken[code >> 6], ONE << (np.uint64(code) & LOW_SIX)
        if word & bit == 0:
            taken[code >> 6] = word | bit
            free[code // per] -= 1
            journal[length] = code
            length += 1
    return length


@jit
def give_back(first: int, length: int, taken: U64, free: I16, per: int, journal: I32) -> None:
    """Undo the journal from an entry on."""
    for k in range(first, length):
        code = int(journal[k])
        taken[code >> 6] &= ~(ONE << (np.uint64(code) & LOW_SIX))
        free[code // per] += 1


@jit
def _changes(code: int, levels: int, offsets: I64) -> None:
    """What each other level of each cell, the last cell first, would add to a code."""
    weight, k = 1, 0
    while k < len(offsets):
        digit = code // weight % levels
        for level in range(levels):
            if level != digit:
                offsets[k] = (level - digit) * weight
                k += 1
        weight *= levels


@jit
def take_near(
    code: int,
    depth: int,
    levels: int,
    offsets: I64,
    taken: U64,
    free: I16,
    per: int,
    journal: I32,
    length: int,
) -> int:
    """Take all codes that differ from one in 1 … depth cells; return the journal's new length.

    A stack, because Numba cannot load recursive functions from its cache.
    """
    if depth == 0:
        return length
    _changes(code, levels, offsets)
    bases, at = np.zeros(depth, np.int64), np.zeros(depth, np.int64)
    bases[0] = code
    length = take_run(code, offsets, 0, taken, free, per, journal, length)
    level = 0
    while level >= 0:
        if level == depth - 1 or at[level] == len(offsets):
            level -= 1
            continue
        bases[level + 1] = bases[level] + offsets[at[level]]
        at[level] += 1
        # A cell is changed once: go on with the first change of the next cell.
        at[level + 1] = (at[level] + levels - 2) // (levels - 1) * (levels - 1)
        level += 1
        length = take_run(bases[level], offsets, at[level], taken, free, per, journal, length)
    return length


@jit
def _turn(code: int, turn: int, turned: I64) -> int:
    """The code of the turned window."""
    out = 0
    for row in range(turned.shape[1] - 1, -1, -1):
        out += int(turned[turn, row, code % turned.shape[2]])
        code //= turned.shape[2]
    return out


@jit
def _differing(one: int, other: int, levels: int) -> int:
    """In how many cells two windows differ."""
    cells = 0
    while one != other:
        if one % levels != other % levels:
            cells += 1
        one //= levels
        other //= levels
    return cells


@jit
def _take_symmetric(
    taken: U64, free: I16, turned: I64, journal: I32, levels: int, distance: int
) -> None:
    """Take all windows nearer than the distance to themselves turned.

    A half turn pairs cells, so k pairs that differ are mended by k changes and cost 2 k. A quarter
    turn within less than the distance is within ``distance - 1`` changes of a window that it
    leaves as it is; of these too many are taken first, then given back.
    """
    b, per = turned.shape[1], turned.shape[2]
    size, odd = b * b, levels if b % 2 else 1
    offsets, centre = np.empty(size * (levels - 1), np.int64), np.zeros(1, np.int64)
    length = 0
    for upper in range(levels ** ((size + 1) // 2)):
        code, rest = upper, upper // odd
        for _ in range(size // 2):
            code = code * levels + rest % levels
            rest //= levels
        quarter = distance > 2 and _turn(code, 1, turned) == code
        depth = distance - 1 if quarter else (distance - 1) // 2
        length = take_run(code, centre, 0, taken, free, per, journal, length)
        length = take_near(code, depth, levels, offsets, taken, free, per, journal, length)
    for k in range(length):
        code = int(journal[k])
        quarter_turn, half_turn = _turn(code, 1, turned), _turn(code, 2, turned)
        if (
            min(_differing(code, quarter_turn, levels), _differing(code, half_turn, levels))
            >= distance
        ):
            give_back(k, k + 1, taken, free, per, journal)
