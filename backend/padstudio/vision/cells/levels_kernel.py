"""Compiled inner loops of `CellGrid.levels`: which level each cell shows.

Levels are printed evenly spaced, but paper, light and the camera's tone curve move the middle ones
by more than half a step. Where there are more than two, their brightness is therefore fitted to
the cells: the power law that leaves the least scatter, then each level's own median (k-means in one
dimension). Cells are read without the pad's field, so that what they show stays evidence.

References
----------
Lloyd, S. (1982). Least squares quantization in PCM. doi:10.1109/TIT.1982.1056489.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import fast_jit
from padstudio.vision.cells.cells_kernel import moments

# Exponents of brightness over printed value. Simulated prints are at 0.6–0.8; between two of these
# no level of six moves by half a step.
_EXPONENTS = (1.5, 1.2, 1.0, 0.85, 0.7, 0.58)
# On simulated pads of three to eight levels more rounds change no cell in a hundred.
_ROUNDS, _REFINEMENTS = 4, 2
# Fewer cells do not tell a level's own brightness.
_TELLING = 8
# A part of so many cells a side tells the power law.
_PART = 48
_WHITE = 255.0


@fast_jit
def cuts(
    relative: NDArray[np.float32], seen: NDArray[np.bool_], count: int, block: int
) -> NDArray[np.float32]:
    """Where levels part.

    Parameters
    ----------
    relative : (R, C) float32
        Values against mean and deviation of the block round each.
    seen : (R, C) bool
    count : int
        Y, 2 or more.
    block : int
        Cells a side, odd.

    Returns
    -------
    (R, C, Y − 1) float32
        Values of ``relative`` between one level and the next, rising.
    """
    out = np.zeros((*relative.shape, count - 1), np.float32)
    if count == 2:
        return out
    response = _response(relative, seen, count, block)
    levels = _first_levels(relative, seen, response)
    for _ in range(_ROUNDS):
        mean, deviation = _moments_of(levels, seen, response, block)
        _place(relative, seen, response, mean, deviation, levels)
    mean, deviation = _moments_of(levels, seen, response, block)
    for k in range(count - 1):
        cut = (response[k] + response[k + 1]) / 2
        out[..., k] = (cut - mean) / deviation
    return out


@fast_jit
def to_levels(
    relative: NDArray[np.float32], seen: NDArray[np.bool_], cuts: NDArray[np.float32]
) -> NDArray[np.int8]:
    """Levels (R, C) int8 of values between cuts (R, C, Y − 1), −1 where not seen."""
    out = np.full(relative.shape, -1, np.int8)
    for r in range(relative.shape[0]):
        for c in range(relative.shape[1]):
            if seen[r, c]:
                # Counted one by one: a slice a cell would be allocated for every frame.
                level = 0
                for k in range(cuts.shape[2]):
                    level += relative[r, c] > cuts[r, c, k]
                out[r, c] = level
    return out


@fast_jit
def _response(
    relative: NDArray[np.float32], seen: NDArray[np.bool_], count: int, block: int
) -> Array:
    """Brightness (Y,) of each level, from a part of the cells."""
    rows, cols = _part(seen.sum(axis=1)), _part(seen.sum(axis=0))
    relative = np.ascontiguousarray(relative[rows[0] : rows[1], cols[0] : cols[1]])
    seen = np.ascontiguousarray(seen[rows[0] : rows[1], cols[0] : cols[1]])
    best, least = _power(count, 1.0), np.inf
    best_levels = _first_levels(relative, seen, best)
    for exponent in _EXPONENTS:
        response = _power(count, exponent)
        levels = _first_levels(relative, seen, response)
        scatter = np.inf
        for _ in range(_ROUNDS):
            mean, deviation = _moments_of(levels, seen, response, block)
            scatter = _place(relative, seen, response, mean, deviation, levels)
        if scatter < least:
            least, best, best_levels = scatter, response, levels
    for _ in range(_REFINEMENTS):
        mean, deviation = _moments_of(best_levels, seen, best, block)
        if not _refine(relative * deviation + mean, best_levels, best):
            break
        mean, deviation = _moments_of(best_levels, seen, best, block)
        _place(relative, seen, best, mean, deviation, best_levels)
    return best


@fast_jit
def _part(count: NDArray[np.intp]) -> tuple[int, int]:
    """First and last of at most so many rows or columns about the middle of the cells seen."""
    if len(count) <= _PART:
        return 0, len(count)
    middle = (count * np.arange(len(count))).sum() // max(count.sum(), 1)
    first = min(max(middle - _PART // 2, 0), len(count) - _PART)
    return first, first + _PART


@fast_jit
def _power(count: int, exponent: float) -> Array:
    return _WHITE * (np.arange(count) / (count - 1)) ** exponent


@fast_jit
def _first_levels(
    relative: NDArray[np.float32], seen: NDArray[np.bool_], response: Array
) -> NDArray[np.int8]:
    """Levels as if each occurred equally often in every block."""
    levels = np.full(relative.shape, -1, np.int8)
    mean = np.full(relative.shape, response.mean())
    deviation = np.full(relative.shape, response.std())
    _place(relative, seen, response, mean, deviation, levels)
    return levels


@fast_jit
def _moments_of(
    levels: NDArray[np.int8], seen: NDArray[np.bool_], response: Array, block: int
) -> tuple[Array, Array]:
    """Mean and deviation (R, C) of the blocks as they would be with these levels."""
    values = np.zeros(levels.shape, np.float32)
    for r in range(levels.shape[0]):
        for c in range(levels.shape[1]):
            if seen[r, c]:
                values[r, c] = response[levels[r, c]]
    return moments(values, seen, block)


@fast_jit
def _place(
    relative: NDArray[np.float32],
    seen: NDArray[np.bool_],
    response: Array,
    mean: Array,
    deviation: Array,
    levels: NDArray[np.int8],
) -> float:
    """Write each cell's nearest level; the mean square of what they are off is returned."""
    total, cells = 0.0, 0
    for r in range(relative.shape[0]):
        for c in range(relative.shape[1]):
            if not seen[r, c]:
                continue
            value = relative[r, c] * deviation[r, c] + mean[r, c]
            level = 0
            while level + 1 < len(response) and value > (response[level] + response[level + 1]) / 2:
                level += 1
            levels[r, c] = level
            total += (value - response[level]) ** 2
            cells += 1
    return total / max(cells, 1)


@fast_jit
def _refine(values: Array, levels: NDArray[np.int8], response: Array) -> bool:
    """Put each level where its cells' median is; False where cells are too few to tell."""
    medians = np.empty(len(response))
    for level in range(len(response)):
        own = values.ravel()[levels.ravel() == level]
        if len(own) < _TELLING:
            return False
        medians[level] = np.median(own)
    span = medians[-1] - medians[0]
    if span <= 0 or not math.isfinite(span) or (np.diff(medians) <= 0).any():
        return False
    response[:] = _WHITE * (medians - medians[0]) / span
    return True
