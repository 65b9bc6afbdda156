"""Compiled inner loop of `edges`, which documents what it computes."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array, Image
from padstudio.compiled import jit

Plane = NDArray[np.float32]
Numbers = NDArray[np.int32]

# Of the odd polynomial nearest to the arc tangent between 0 and 1, off by 2e-8 at the most.
_ARC = (
    *(0.9999993329, -0.3332985605, 0.1994653599, -0.1390853351),
    *(0.0964200441, -0.0559098861, 0.0218612288, -0.0040540580),
)


@jit
def pixels(mask: Image) -> Numbers:
    """The pixels (N, 2) of a picture that are not 0, x and y, row by row."""
    count = 0
    for y in range(mask.shape[0]):
        for x in range(mask.shape[1]):
            count += mask[y, x] != 0
    # A place more, as each pixel is written that might be the next; to ask first takes longer.
    found, n = np.empty((count + 1, 2), np.int32), 0
    for y in range(mask.shape[0]):
        for x in range(mask.shape[1]):
            found[n, 0], found[n, 1] = x, y
            n += mask[y, x] != 0
    return found[:count].copy()


@jit
def take_off(thin: Image, mask: NDArray[np.bool_], corner: tuple[int, int], scale: float) -> None:
    """Make those pixels 0 that are not on a mask of other pixels, so many times as large.

    ``corner`` is where the picture begins, pixels of its own. Beyond the mask its border goes on.
    """
    rows, columns = mask.shape
    for y in range(thin.shape[0]):
        row = min(max(int((y + corner[1] + 0.5) * scale), 0), rows - 1)
        for x in range(thin.shape[1]):
            if thin[y, x]:
                column = min(max(int((x + corner[0] + 0.5) * scale), 0), columns - 1)
                if not mask[row, column]:
                    thin[y, x] = 0


@jit
def steepest(xy: Numbers, gx: Plane, gy: Plane, steep: Plane, search: int) -> Array:
    """Pixels (N, 2) moved along their gradient's main axis to where the plane is steepest."""
    moved = np.empty((len(xy), 2))
    for k in range(len(xy)):
        x, y = xy[k]
        along_x = abs(gx[y, x]) >= abs(gy[y, x])
        best, here = 0, np.float32(-1.0)
        for offset in range(-search, search + 1):
            value = _beside(steep, x, y, offset, along_x)
            if value > here:
                best, here = offset, value
        before = float(_beside(steep, x, y, best - 1, along_x))
        after = float(_beside(steep, x, y, best + 1, along_x))
        bend = min(before + after - 2 * float(here), -1e-6)
        shift = best + min(max(0.5 * (before - after) / bend, -0.5), 0.5)
        moved[k, 0], moved[k, 1] = x, y
        moved[k, 0 if along_x else 1] += shift
    return moved


@jit
def directions(xy: Numbers, gx: Plane, gy: Plane, bins: int) -> Numbers:
    """Which way the plane is steepest at pixels (N, 2), in so many bins over half a turn."""
    found = np.empty(len(xy), np.int32)
    for k in range(len(xy)):
        x, y = xy[k, 0], xy[k, 1]
        turn = int(_half_turn(float(gx[y, x]), float(gy[y, x])) * bins / math.pi + 0.5)
        found[k] = turn if turn < bins else 0
    return found


@jit
def _half_turn(x: float, y: float) -> float:
    """Angle of a direction without a sense, 0 … π; five times as quick as the exact one."""
    flat, steep = abs(x), abs(y)
    t = min(flat, steep) / max(flat, steep, 1e-30)
    square, value = t * t, 0.0
    for k in range(7, -1, -1):
        value = value * square + _ARC[k]
    value *= t
    value = math.pi / 2 - value if steep > flat else value
    return math.pi - value if x * y < 0 else value


@jit
def _beside(steep: Plane, x: int, y: int, offset: int, along_x: bool) -> np.float32:
    """A pixel of the same row or column; the picture's border goes on beyond it."""
    height, width = steep.shape
    column = min(max(x + offset, 0), width - 1) if along_x else x
    row = y if along_x else min(max(y + offset, 0), height - 1)
    value: np.float32 = steep[row, column]
    return value
