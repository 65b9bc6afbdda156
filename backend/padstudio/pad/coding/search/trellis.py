"""One row of a board (see `rows`): find its cheapest open path, and walk it."""

from __future__ import annotations

import numpy as np

from padstudio.compiled import jit
from padstudio.pad.coding.search.board import (
    I16,
    I32,
    I64,
    LOW_SIX,
    ONE,
    U8,
    U64,
    take_near,
)
from padstudio.pad.coding.search.random import draw

CLOSED = 1 << 30
_SPREAD = np.uint64(0xD6E8FEB86659FD93)
_N32, _N58 = np.uint64(32), np.uint64(58)


@jit
def sweep(
    first: int,
    last: int,
    row: int,
    field: U8,
    taken: U64,
    free: I16,
    lines: I64,
    value: I32,
    choice: U8,
    levels: int,
    visible: bool,
    scarce: int,
    bias: int,
    state: U64,
) -> None:
    """Fill in least cost and first level of a path to the row's end, windows first … last − 1.

    Found from the right, on top of the costs from ``last`` on; a state without an open path costs
    ``CLOSED``.
    """
    b, across = lines.shape
    states, per = value.shape[1], value.shape[1] * levels
    upper = len(free) // per
    if row == field.shape[0] - 1:
        scarce = 0
    value[across, :] = 0
    for w in range(last - 1, first - 1, -1):
        draw(state, 2)
        noise = state[0] * _SPREAD
        block = 0
        for i in range(b - 1):
            block = block * per + lines[i, w]
        code, below = block * per, block % upper * per
        above = lines[b - 2, w] if visible else -1
        flat = visible and _equal_columns(field, row, w + b - 1, b)
        sums = field[row - 1, w + b - 1] + (field[row - 2, w + b - 1] if b > 2 else 0)
        for s in range(states):
            best, level = CLOSED, 0
            for v in range(levels):
                option = s * levels + v
                number = code + option
                if (taken[number >> 6] >> (np.uint64(number) & LOW_SIX)) & ONE:
                    continue
                left = free[below + option]
                if left <= 0 and scarce:
                    continue
                if option == above or (flat and v == s % levels):
                    continue
                z = (noise ^ np.uint64(option)) * _SPREAD
                cost = value[w + 1, option % states] + np.int64((z ^ (z >> _N32)) * _SPREAD >> _N58)
                if scarce:
                    cost += scarce // left
                if (v + sums) % levels:
                    cost += bias
                if cost < best:
                    best, level = cost, v
            value[w, s] = best
            choice[w, s] = level


@jit
def _equal_columns(field: U8, row: int, col: int, b: int) -> bool:
    """Whether the b - 1 cells above (row, col) equal those above (row, col - 1)."""
    for i in range(1, b):  # noqa: SIM110 - Numba compiles no generators
        if field[row - i, col] != field[row - i, col - 1]:
            return False
    return True


@jit
def walk(
    first: int,
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
    counts: I64,
) -> int:
    """Follow the choices from window ``first`` on; return the window where it ends, or across.

    It ends where a window is taken, or leaves the row below without an open path so far.
    """
    b, across = lines.shape
    states, per = value.shape[1], value.shape[1] * levels
    s = 0
    more = row < field.shape[0] - 1
    if first == 0:
        reach[0, :] = 1
    for j in range(b - 1):
        s = s * levels + field[row, first + j]
    for w in range(first, across):
        block = 0
        for i in range(b - 1):
            block = block * per + lines[i, w]
        option = s * levels + choice[w, s]
        number = block * per + option
        if value[w, s] >= CLOSED or (taken[number >> 6] >> (np.uint64(number) & LOW_SIX)) & ONE:
            return w
        field[row, w + b - 1] = option % levels
        lines[b - 1, w] = option
        starts[(row - b + 1) * across + w] = counts[1]
        for turn in range(turned.shape[0]):
            code = 0
            for i in range(b):
                code += int(turned[turn, i, lines[i, w]])
            word, bit = taken[code >> 6], ONE << (np.uint64(code) & LOW_SIX)
            if word & bit == 0:
                taken[code >> 6] = word | bit
                free[code // per] -= 1
                journal[counts[1]] = code
                counts[1] += 1
            if distance > 1:
                counts[1] = take_near(
                    code, distance - 1, levels, offsets, taken, free, per, journal, int(counts[1])
                )
        s = option % states
        if more and not _spread(w, taken, lines, reach, levels):
            return w
    return int(across)


@jit
def _spread(w: int, taken: U64, lines: I64, reach: U8, levels: int) -> bool:
    """Enter the states that the row below can have after window w; whether there are any."""
    b, states, per = lines.shape[0], reach.shape[1], reach.shape[1] * levels
    block = 0
    for i in range(1, b):
        block = block * per + lines[i, w]
    reach[w + 1, :] = 0
    alive = False
    for s in range(states):
        if reach[w, s]:
            for v in range(levels):
                option = s * levels + v
                number = block * per + option
                if not (taken[number >> 6] >> (np.uint64(number) & LOW_SIX)) & ONE:
                    alive = True
                    reach[w + 1, option % states] = 1
    return alive


@jit
def start(row: int, field: U8, value: I32, levels: int, visible: bool, b: int) -> bool:
    """Enter the first b - 1 cells of the row from which the end is reached at least cost."""
    best, cells = CLOSED, -1
    for s in range(value.shape[1]):
        hidden, rest = False, s
        for col in range(b - 2, 0, -1):
            equal = rest % levels == rest // levels % levels
            if visible and equal and _equal_columns(field, row, col, b):
                hidden = True
            rest //= levels
        if value[0, s] < best and not hidden:
            best, cells = value[0, s], s
    if cells < 0:
        return False
    for j in range(b - 2, -1, -1):
        field[row, j] = cells % levels
        cells //= levels
    return True
