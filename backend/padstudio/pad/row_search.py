"""The search over the rows of a board: sweep a row, walk it, take back (see `rows`)."""

from __future__ import annotations

import numpy as np

from padstudio.pad.field_spec import FieldSearchError, FieldSpec, Watch
from padstudio.pad.jit import draw, jit
from padstudio.pad.rows import I16, I32, I64, LOW_SIX, ONE, U8, U64, board, give_back, take_near

_CLOSED = np.int64(1 << 30)
_SPREAD = np.uint64(0xD6E8FEB86659FD93)
_N32, _N58 = np.uint64(32), np.uint64(58)
# Cost of a cell below which one window is left; k windows cost a k-th of it.
_SCARCE = np.int64(4096)
# Dead ends within a row before rows are taken back.
_ROW_TRIES = 24
# Cells swept between two looks at the watch.
_CELLS = 50_000


@jit
def _sweep(
    first: int,
    row: int,
    field: U8,
    taken: U64,
    free: I16,
    lines: I64,
    value: I32,
    choice: U8,
    levels: int,
    visible: bool,
    state: U64,
) -> None:
    """Fill in the least cost to the row's end, and the level that leads there, from ``first`` on.

    The least cost of all paths is found from the right; a state without an open path costs
    ``_CLOSED``.
    """
    b, across = lines.shape
    states, per = value.shape[1], value.shape[1] * levels
    upper = len(free) // per
    scarce = 0 if row == field.shape[0] - 1 else _SCARCE
    value[across, :] = 0
    for w in range(across - 1, first - 1, -1):
        draw(state, 2)
        noise = state[0] * _SPREAD
        block = 0
        for i in range(b - 1):
            block = block * per + lines[i, w]
        code, below = block * per, block % upper * per
        above = lines[b - 2, w] if visible else -1
        flat = visible and _equal_columns(field, row, w + b - 1, b)
        for s in range(states):
            best, level = _CLOSED, 0
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
def _walk(
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
    offsets: I64,
    levels: int,
    distance: int,
    counts: I64,
) -> int:
    """Follow the choices from window ``first`` on; return the window that is closed, or across."""
    b, across = lines.shape
    states, per = value.shape[1], value.shape[1] * levels
    s = 0
    for j in range(b - 1):
        s = s * levels + field[row, first + j]
    for w in range(first, across):
        block = 0
        for i in range(b - 1):
            block = block * per + lines[i, w]
        option = s * levels + choice[w, s]
        number = block * per + option
        if value[w, s] >= _CLOSED or (taken[number >> 6] >> (np.uint64(number) & LOW_SIX)) & ONE:
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
    return int(across)


@jit
def _start(row: int, field: U8, value: I32, levels: int, visible: bool, b: int) -> bool:
    """Enter the first b - 1 cells of the row from which the end is reached at least cost."""
    best, cells = _CLOSED, -1
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


@jit
def _fill(
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
    offsets: I64,
    levels: int,
    distance: int,
    visible: bool,
    state: U64,
    counts: I64,
) -> bool:
    """Fill a row below b - 1 others, or leave it as it was."""
    b, across = lines.shape
    per = value.shape[1] * levels
    for i in range(b - 1):
        line = 0
        for col in range(field.shape[1]):
            line = (line * levels + field[row - b + 1 + i, col]) % per
            if col >= b - 1:
                lines[i, col - b + 1] = line
    first, number = 0, (row - b + 1) * across
    starts[number] = counts[1]
    for attempt in range(1, _ROW_TRIES + 1):
        _sweep(first, row, field, taken, free, lines, value, choice, levels, visible, state)
        if first == 0 and not _start(row, field, value, levels, visible, b):
            return False
        reached = _walk(
            first, row, field, taken, free, turned, journal, starts, lines, value, choice, offsets,
            levels, distance, counts,
        )  # fmt: skip
        if reached == across:
            starts[number + across] = counts[1]
            return True
        first = max(0, reached - b * (attempt & -attempt))
        give_back(starts[number + first], counts[1], taken, free, per, journal)
        counts[1] = starts[number + first]
    give_back(starts[number], counts[1], taken, free, per, journal)
    counts[1] = starts[number]
    return False


@jit
def _top_row(row: int, field: U8, levels: int, visible: bool, b: int, state: U64) -> None:
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
    best: U8,
    state: U64,
    counts: I64,
    levels: int,
    distance: int,
    visible: bool,
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
            _top_row(row, field, levels, visible, b, state)
            counts[0] += 1
        elif _fill(
            row, field, taken, free, turned, journal, starts, lines, value, choice, offsets,
            levels, distance, visible, state, counts,
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


def search_field(spec: FieldSpec, watch: Watch) -> U8:
    """Search a field row by row.

    Returns
    -------
    (rows, cols) uint8

    Raises
    ------
    FieldSearchError
        Where the budget ends first, with the rows reached at best.
    """
    made = board(spec)
    fills = max(1, _CELLS // spec.cols)
    while True:
        row = search(*made, spec.levels, spec.distance, spec.visible_lines, fills)
        if row == spec.rows:
            return made.field
        if watch.spent(row / spec.rows):
            break
    reached = int(made.counts[4])
    if row > reached:
        made.best[:row], reached = made.field[:row], row
    raise FieldSearchError(
        f"the search reached {reached} of {spec.rows} rows of {spec.cols} cells in "
        f"{watch.elapsed_s:.0f} s: give it more time, or take a smaller field, a lesser distance, "
        "a larger window or more levels",
        made.best[:reached].copy() if reached >= spec.window else None,
    )
