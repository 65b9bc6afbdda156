"""Leaves, snow and mud in the simulator's inner loop: outlines, found by a grid of bins."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import inlined_jit

# A box over more bins than this is taken to be littered.
_MOST_BINS = 64


class LitterShapes(NamedTuple):
    """Outlines on the sheet, the last uppermost.

    Attributes
    ----------
    shapes : (N, 10) float64
        1 for a leaf and 0 for an ellipse; centre; cosine and sine of the long axis; half length
        and half breadth; linear colour.
    starts : (n² + 1,) int32
        Where each bin's list begins in ``items``; bins go row by row.
    items : (M,) int32
        Shapes that reach into a bin, in their order.
    grid : (3,) float64
        Least x and y, and the side of a bin, mm.
    bins : int
        n, bins a side; 0 where there is no litter.
    """

    shapes: Array
    starts: NDArray[np.int32]
    items: NDArray[np.int32]
    grid: Array
    bins: int


class Spot(NamedTuple):
    """A point of the sheet, mm."""

    x: float
    y: float


@inlined_jit
def _inside(spot: Spot, shape: Array) -> bool:
    """Whether a point lies within an outline: an ellipse, or a leaf between two parabolas."""
    dx, dy = spot.x - shape[1], spot.y - shape[2]
    along = (shape[3] * dx + shape[4] * dy) / shape[5]
    across = (shape[3] * dy - shape[4] * dx) / shape[6]
    if shape[0] > 0:
        return bool(abs(across) < 1.0 - along * along)
    return bool(along * along + across * across < 1.0)


@inlined_jit
def litter_at(x: float, y: float, litter: LitterShapes) -> int:
    """The uppermost shape at a point, -1 where there is none."""
    side = litter.bins
    p = math.floor((x - litter.grid[0]) / litter.grid[2])
    q = math.floor((y - litter.grid[1]) / litter.grid[2])
    if p < 0 or q < 0 or p >= side or q >= side:
        return -1
    cell = int(q) * side + int(p)
    for n in range(litter.starts[cell + 1] - 1, litter.starts[cell] - 1, -1):
        k = litter.items[n]
        if _inside(Spot(x, y), litter.shapes[k]):
            return int(k)
    return -1


@inlined_jit
def touches_litter(box: tuple[float, float, float, float], litter: LitterShapes) -> bool:
    """Whether a shape's circle reaches into a box (x0, x1, y0, y1)."""
    side = litter.bins
    if side == 0:
        return False
    x0, x1, y0, y1 = box
    step = litter.grid[2]
    p0 = max(math.floor((x0 - litter.grid[0]) / step), 0)
    p1 = min(math.floor((x1 - litter.grid[0]) / step), side - 1)
    q0 = max(math.floor((y0 - litter.grid[1]) / step), 0)
    q1 = min(math.floor((y1 - litter.grid[1]) / step), side - 1)
    if p1 < p0 or q1 < q0:
        return False
    if (p1 - p0 + 1) * (q1 - q0 + 1) > _MOST_BINS:
        return True
    for q in range(int(q0), int(q1) + 1):
        for p in range(int(p0), int(p1) + 1):
            cell = q * side + p
            for n in range(litter.starts[cell], litter.starts[cell + 1]):
                shape = litter.shapes[litter.items[n]]
                dx = max(x0 - shape[1], 0.0, shape[1] - x1)
                dy = max(y0 - shape[2], 0.0, shape[2] - y1)
                if dx * dx + dy * dy < shape[5] * shape[5]:
                    return True
    return False
