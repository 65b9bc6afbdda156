"""Points of a picture by square tiles, so that those beside a line are found without the others."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import jit

Numbers = NDArray[np.intp]

# Side of a tile in units of how near points are to a line; so many tiles side by side at the most.
_SIDE, _MOST = 6.0, 512

# Where the first tile begins, a tile's side, tiles a row, and for each tile where its points begin
# among the numbers of all points, which follow.
Tiles = tuple[tuple[float, float], float, int, Numbers, Numbers]


@jit
def tiled(points: Array, pieces: Array, near: float) -> Tiles:
    """Points (P, 2) by tile, of the part of the plane that pieces of line (M, 2, 2) reach.

    Points elsewhere are in no tile: a wide lens, made straight, throws some of them very far.
    """
    low, high = np.full(2, np.inf), np.full(2, -np.inf)
    for piece in pieces:
        for end in range(2):
            if math.isfinite(piece[end, 0] + piece[end, 1]):
                low, high = np.minimum(low, piece[end]), np.maximum(high, piece[end])
    if not low[0] <= high[0]:
        low, high = np.zeros(2), np.zeros(2)
    low, high = low - near, high + near
    side = max(_SIDE * near, (high - low).max() / _MOST)
    columns, rows = int((high[0] - low[0]) / side) + 1, int((high[1] - low[1]) / side) + 1
    tile = np.full(len(points), -1, np.intp)
    starts = np.zeros(columns * rows + 1, np.intp)
    for p in range(len(points)):
        x, y = points[p, 0], points[p, 1]
        if low[0] <= x <= high[0] and low[1] <= y <= high[1]:
            tile[p] = int((y - low[1]) / side) * columns + int((x - low[0]) / side)
            starts[tile[p] + 1] += 1
    starts = np.cumsum(starts)
    free, numbers = starts.copy(), np.empty(starts[-1], np.intp)
    for p in range(len(points)):
        if tile[p] >= 0:
            numbers[free[tile[p]]] = p
            free[tile[p]] += 1
    return (low[0], low[1]), side, columns, starts, numbers


@jit
def beside(tiles: Tiles, ends: Array, near: float, found: Numbers) -> int:
    """Numbers, in `found`, of all points within `near` of a piece (2, 2), and of some others.

    Returns how many they are.
    """
    (left, top), side, columns, starts, numbers = tiles
    rows = (len(starts) - 1) // columns
    dx, dy = ends[1, 0] - ends[0, 0], ends[1, 1] - ends[0, 1]
    # Tile by tile along the axis that the piece is nearer to.
    is_flat = abs(dx) >= abs(dy)
    a = 0 if is_flat else 1
    slope = (dy / dx if is_flat else dx / dy) if dx or dy else 0.0
    origin, other = (left, top) if is_flat else (top, left)
    last_along, last_across = (columns - 1, rows - 1) if is_flat else (rows - 1, columns - 1)
    start, stop = min(ends[0, a], ends[1, a]) - near, max(ends[0, a], ends[1, a]) + near
    reach = near * math.hypot(1.0, slope)
    count = 0
    for i in range(
        _tile(start, origin, side, last_along), _tile(stop, origin, side, last_along) + 1
    ):
        here = ends[0, 1 - a] + slope * (origin + i * side - ends[0, a])
        there = here + slope * side
        first = _tile(min(here, there) - reach, other, side, last_across)
        last = _tile(max(here, there) + reach, other, side, last_across)
        for j in range(first, last + 1):
            t = j * columns + i if is_flat else i * columns + j
            for n in range(starts[t], starts[t + 1]):
                found[count] = numbers[n]
                count += 1
    return count


@jit
def _tile(at: float, origin: float, side: float, last: int) -> int:
    return int(min(max((at - origin) / side, 0.0), float(last)))
