"""Compiled inner loop of `edges`, which documents what it computes."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import jit

Plane = NDArray[np.float32]


@jit
def steepest(xy: NDArray[np.int32], gx: Plane, gy: Plane, steep: Plane, search: int) -> Array:
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
def directions(xy: NDArray[np.int32], gx: Plane, gy: Plane, bins: int) -> NDArray[np.int32]:
    """Which way the plane is steepest at pixels (N, 2), in so many bins over half a turn."""
    found = np.empty(len(xy), np.int32)
    for k in range(len(xy)):
        x, y = xy[k]
        found[k] = round(math.atan2(gy[y, x], gx[y, x]) * bins / math.pi) % bins
    return found


@jit
def _beside(steep: Plane, x: int, y: int, offset: int, along_x: bool) -> np.float32:
    """A pixel of the same row or column; the picture's border goes on beyond it."""
    height, width = steep.shape
    column = min(max(x + offset, 0), width - 1) if along_x else x
    row = y if along_x else min(max(y + offset, 0), height - 1)
    value: np.float32 = steep[row, column]
    return value
