"""Fields cut from one maximum-length sequence: all windows differ as they stand, up to the bound.

A linear recurrence of order b² over the integers modulo a prime Y, whose polynomial is primitive,
runs through all Y^(b²) − 1 states but zero before it comes back. Row i of the field is the
sequence from place i · stride on, so that the window at (i, j) belongs to the state at place
i · stride + j. With a stride of at least the windows in a row, no state comes twice. The b² cells
of a window are linear functions of the state; where they are independent, different states give
different windows. About 29 % of all strides and polynomials have that at two levels, so that a few
are tried.

Maximum-length sequences: MacWilliams, Sloane, "Pseudo-random sequences and arrays", Proc. IEEE 64,
1976, doi:10.1109/PROC.1976.10411. They fold a sequence along the diagonal of a torus, which ties
its sides to the divisors of Y^(b²) − 1; a field that does not close is free of that.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from padstudio.pad.coding.search.spec import FieldSpec, Watch

U8 = NDArray[np.uint8]
I64 = NDArray[np.int64]

# Beyond this many states windows are so many that any search finds its way.
_MAX_STATES = 2**30
# Polynomials drawn, of which about one in 2 b² is primitive, and strides tried with each.
_POLYNOMIALS = 1000
# About 29 % of strides do: sixteen with one polynomial fail in one of 240 cases.
_STRIDES = 16


def can_cut(spec: FieldSpec) -> bool:
    """Whether a field can be cut from one sequence: plain, distance 1, a prime number of levels.

    All windows but one are within reach; the window of zeros is not.
    """
    if spec.method != "auto" or spec.levels ** (spec.window**2) > _MAX_STATES:
        return False
    plain = spec.unique == "plain" and spec.distance == 1 and not spec.visible_lines
    return plain and _factors(spec.levels) == [spec.levels] and len(_strides(spec)) > 0


def cut_field(spec: FieldSpec, watch: Watch) -> U8 | None:
    """Cut a field from a maximum-length sequence that the seed chooses.

    Returns
    -------
    (rows, cols) uint8, or None
        None where the few sequences that a small window has do not do, or time is spent.
    """
    order, levels = spec.window**2, spec.levels
    strides = _strides(spec)
    for attempt in range(_POLYNOMIALS):
        if watch.spent(0.0):
            return None
        # Of NumPy's generators, seed sequences give the same numbers in every version.
        words = np.random.SeedSequence([spec.seed, attempt]).generate_state(2 * order + 1)
        taps = words[:order].astype(np.int64) % levels
        step = _companion(taps)
        if taps[0] == 0 or not _is_primitive(step, levels):
            continue
        start = words[order:-1].astype(np.int64) % levels
        start[0] += not start.any()
        for offset in range(min(_STRIDES, len(strides))):
            stride = strides[(int(words[-1]) + offset) % len(strides)]
            if _is_whole(step, stride, spec.window, levels):
                length = (spec.rows - 1) * stride + spec.cols
                cells = _sequence(taps, start, length, levels)
                rows = np.lib.stride_tricks.as_strided(
                    cells, (spec.rows, spec.cols), (stride, 1), writeable=False
                )
                return rows.copy()
    return None


def _strides(spec: FieldSpec) -> range:
    """Strides with which no state comes twice; the sequence is no longer than it must be."""
    down, across = spec.rows - spec.window + 1, spec.cols - spec.window + 1
    states = spec.levels ** (spec.window**2) - 1
    least = max(across, spec.window)
    most = (states - across) // (down - 1) if down > 1 else least
    return range(least, min(most, least + _STRIDES) + 1)


def _factors(number: int) -> list[int]:
    """Prime factors, each once."""
    found, factor = [], 2
    while factor * factor <= number:
        if number % factor == 0:
            found.append(factor)
            while number % factor == 0:
                number //= factor
        factor += 1
    return found + [number] * (number > 1)


def _companion(taps: I64) -> I64:
    """The matrix (k, k) that takes a state s_t … s_(t+k−1) to the next, s_(t+k) = taps · state."""
    step = np.eye(len(taps), k=1, dtype=np.int64)
    step[-1] = taps
    return step


def _power(matrix: I64, exponent: int, levels: int) -> I64:
    """A power of a matrix modulo ``levels``."""
    out = np.eye(len(matrix), dtype=np.int64)
    while exponent:
        if exponent & 1:
            out = out @ matrix % levels
        matrix = matrix @ matrix % levels
        exponent >>= 1
    return out


def _is_primitive(step: I64, levels: int) -> bool:
    """Whether the states run through all but zero before they come back."""
    states = levels ** len(step) - 1
    one = np.eye(len(step), dtype=np.int64)
    if not np.array_equal(_power(step, states, levels), one):
        return False
    return not any(
        np.array_equal(_power(step, states // factor, levels), one) for factor in _factors(states)
    )


def _is_whole(step: I64, stride: int, b: int, levels: int) -> bool:
    """Whether the cells of a window tell the state: b rows of b cells, a stride apart."""
    down = _power(step, stride, levels)
    cells = []
    line = np.eye(len(step), dtype=np.int64)
    for _ in range(b):
        # The first j-th cell of a line is the state's first cell j steps on.
        cell = line[0]
        for _ in range(b):
            cells.append(cell)
            cell = cell @ step % levels
        line = line @ down % levels
    return _rank(np.array(cells), levels) == len(step)


def _rank(matrix: I64, levels: int) -> int:
    """Rank modulo a prime, by Gaussian elimination."""
    rank = 0
    for col in range(matrix.shape[1]):
        below = np.flatnonzero(matrix[rank:, col])
        if not len(below):
            continue
        matrix[[rank, rank + below[0]]] = matrix[[rank + below[0], rank]]
        matrix[rank] = matrix[rank] * pow(int(matrix[rank, col]), -1, levels) % levels
        others = matrix[rank + 1 :]
        others -= others[:, col : col + 1] * matrix[rank]
        others %= levels
        rank += 1
    return rank


def _sequence(taps: I64, start: I64, length: int, levels: int) -> U8:
    """The first cells of the sequence (length,).

    Raised to a power q of the prime, a polynomial keeps its coefficients and spreads its powers
    q-fold: the recurrence holds for every q-th cell too, and so for ever longer runs at a time.
    """
    order = len(taps)
    used = np.flatnonzero(taps)
    wide = np.uint8 if order * (levels - 1) ** 2 < 256 else np.uint16
    cells = np.empty(max(length, order), np.uint8)
    cells[:order] = start
    known, spread = order, 1
    while known < length:
        while known >= order * spread * levels:
            spread *= levels
        fresh = min((order - int(used[-1])) * spread, length - known)
        first = known - order * spread
        total: NDArray[np.unsignedinteger] = np.zeros(fresh, wide)
        for tap in used:
            run = cells[first + tap * spread :][:fresh]
            total += run if taps[tap] == 1 else run * wide(taps[tap])
        cells[known : known + fresh] = total % levels
        known += fresh
    return cells[:length]
