"""Compiled inner loop of `padstudio.vision.search.edges`, which documents what it computes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import fast_jit, jit

Plane = NDArray[np.float32]


@jit
def steepness(gx: Plane, gy: Plane) -> Plane:
    """Length of a plane's gradient (gx, gy), to the last bit the same wherever it lies in memory.

    OpenCV's ``magnitude``, as quick, rounds otherwise where its output is aligned otherwise, so
    that poses would differ from run to run.
    """
    out = np.empty(gx.shape, np.float32)
    for r in range(gx.shape[0]):
        for c in range(gx.shape[1]):
            out[r, c] = np.sqrt(gx[r, c] * gx[r, c] + gy[r, c] * gy[r, c])
    return out


@fast_jit
def find_peaks(
    gx: Plane, gy: Plane, size: Plane, floor: Plane, most: int
) -> tuple[Array, Array, Array]:
    """Gradient maxima above a floor, thinned evenly to at most ``most``.

    Returns
    -------
    local : (N, 2) float64
        Pixels of the plane.
    tangent : (N, 2) float64
        Unit vectors along the steps.
    strength : (N,) float64
    """
    height, width = size.shape
    found = np.empty((height * width, 2), np.int32)
    count = 0
    for y in range(1, height - 1):
        for x in range(1, width - 1):
            here = size[y, x]
            if here <= floor[y, x]:
                continue
            if abs(gx[y, x]) >= abs(gy[y, x]):
                peak = here >= size[y, x - 1] and here > size[y, x + 1]
            else:
                peak = here >= size[y - 1, x] and here > size[y + 1, x]
            if peak:
                found[count, 0], found[count, 1] = x, y
                count += 1
    stride = max(1, -(-count // most))
    kept = -(-count // stride)
    local, tangent, strength = np.empty((kept, 2)), np.empty((kept, 2)), np.empty(kept)
    for k in range(kept):
        x, y = found[k * stride, 0], found[k * stride, 1]
        along_x = abs(gx[y, x]) >= abs(gy[y, x])
        here = float(size[y, x])
        before = float(size[y, x - 1] if along_x else size[y - 1, x])
        after = float(size[y, x + 1] if along_x else size[y + 1, x])
        bend = min(before + after - 2 * here, -1e-6)
        shift = min(max(0.5 * (before - after) / bend, -0.5), 0.5)
        local[k, 0] = x + shift if along_x else float(x)
        local[k, 1] = float(y) if along_x else y + shift
        tangent[k, 0], tangent[k, 1] = -gy[y, x] / here, gx[y, x] / here
        strength[k] = here
    return local, tangent, strength
