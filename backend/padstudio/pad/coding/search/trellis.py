"""One row of a board: find its cheapest open path, and walk it.

With the b − 1 rows above given, a new row is a path through a trellis: the state is the last b − 1
cells, each further cell completes one window, and windows that are taken are closed. The cheapest
open path is found from right to left by dynamic programming, then walked from left to right while
its windows are entered (Viterbi, "Error bounds for convolutional codes and an asymptotically
optimum decoding algorithm", IEEE Trans. Inf. Theory 13, 1967, doi:10.1109/TIT.1967.1054010). A
cell costs the more, the fewer windows are left that could continue below it, so that the row after
finds its way too; random costs on top make it a random field.

What the trellis does not see is windows that meet within the row itself, and a row that leaves the
next one without any open path: there the walk ends.
"""

from __future__ import annotations

import numpy as np

from padstudio.compiled import inlined_jit, pure_jit
from padstudio.pad.coding.search.board import LENGTH, U8, Board, is_taken, take, take_near
from padstudio.pad.coding.search.random import draw

# Cost of a state without an open path: above that of any path, and below half of what int32 holds.
_CLOSED = 1 << 30
# An odd multiplier with well-mixed bits, which spreads the bits of a window over those of its cost.
_SPREAD = np.uint64(0xD6E8FEB86659FD93)
_N32, _N58 = np.uint64(32), np.uint64(58)


@inlined_jit
def _block(board: Board, first: int, w: int) -> int:
    """The number of b − 1 lines of window w, from one on."""
    block = 0
    for i in range(first, first + board.rules.window - 1):
        block = block * board.turned.shape[2] + board.lines[i, w]
    return block


@pure_jit
def find_paths(board: Board, row: int, first: int, last: int) -> None:
    """Fill in least cost and first level of a path to the row's end, windows first … last − 1.

    Found from the right, on top of the costs from ``last`` on.
    """
    field, taken, free, value = board.field, board.taken, board.free, board.value
    b, levels = board.rules.window, board.rules.levels
    across, states, per = board.lines.shape[1], value.shape[1], board.turned.shape[2]
    upper, choice, bias = len(free) // per, board.choice, board.costs.bias
    visible = board.rules.visible_lines
    scarce = board.costs.scarce if row < len(field) - 1 else 0
    value[across, :] = 0
    for w in range(last - 1, first - 1, -1):
        draw(board.state, 2)
        noise = board.state[0] * _SPREAD
        block = _block(board, 0, w)
        code, below = block * per, block % upper * per
        above = board.lines[b - 2, w] if visible else -1
        flat = visible and _equal_columns(field, row, w + b - 1, b)
        sums = field[row - 1, w + b - 1] + (field[row - 2, w + b - 1] if b > 2 else 0)
        for s in range(states):
            best, level = _CLOSED, 0
            for v in range(levels):
                option = s * levels + v
                if is_taken(taken, code + option):
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


@pure_jit
def _equal_columns(field: U8, row: int, col: int, b: int) -> bool:
    """Whether the b - 1 cells above (row, col) equal those above (row, col - 1)."""
    for i in range(1, b):  # noqa: SIM110 - Numba compiles no generators
        if field[row - i, col] != field[row - i, col - 1]:
            return False
    return True


@pure_jit
def walk(board: Board, row: int, first: int) -> int:
    """Follow the choices from window ``first`` on; return the window where it ends, or across.

    It ends where a window is taken, or leaves the row below without an open path so far.
    """
    field, lines, reach = board.field, board.lines, board.reach
    b, levels, per = board.rules.window, board.rules.levels, board.turned.shape[2]
    across, states = lines.shape[1], reach.shape[1]
    s = 0
    if first == 0:
        reach[0, :] = 1
    for j in range(b - 1):
        s = s * levels + field[row, first + j]
    for w in range(first, across):
        option = s * levels + board.choice[w, s]
        closed = board.value[w, s] >= _CLOSED
        if closed or is_taken(board.taken, _block(board, 0, w) * per + option):
            return w
        field[row, w + b - 1] = option % levels
        lines[b - 1, w] = option
        board.starts[(row - b + 1) * across + w] = board.counts[LENGTH]
        for turn in range(board.rules.turns):
            code = 0
            for i in range(b):
                code += board.turned[turn, i, lines[i, w]]
            take(board, code)
            # A call costs as much as all else here: a board is large.
            if board.rules.distance > 1:
                take_near(board, code, board.rules.distance - 1)
        s = option % states
        if row < len(field) - 1 and not _reach_on(board, w):
            return w
    return int(across)


@inlined_jit
def _reach_on(board: Board, w: int) -> bool:
    """Enter the states that the row below can have after window w; whether there are any."""
    reach, levels = board.reach, board.rules.levels
    states, above = reach.shape[1], _block(board, 1, w) * board.turned.shape[2]
    reach[w + 1, :] = 0
    alive = False
    for s in range(states):
        if reach[w, s]:
            for option in range(s * levels, (s + 1) * levels):
                if not is_taken(board.taken, above + option):
                    alive = True
                    reach[w + 1, option % states] = 1
    return alive


@pure_jit
def start(board: Board, row: int) -> bool:
    """Enter the first b - 1 cells of the row from which the end is reached at least cost."""
    b, levels = board.rules.window, board.rules.levels
    best, cells = _CLOSED, -1
    for s in range(board.value.shape[1]):
        hidden, rest = False, s
        for col in range(b - 2, 0, -1):
            equal = board.rules.visible_lines and rest % levels == rest // levels % levels
            if equal and _equal_columns(board.field, row, col, b):
                hidden = True
            rest //= levels
        if board.value[0, s] < best and not hidden:
            best, cells = board.value[0, s], s
    if cells < 0:
        return False
    for j in range(b - 2, -1, -1):
        board.field[row, j] = cells % levels
        cells //= levels
    return True
