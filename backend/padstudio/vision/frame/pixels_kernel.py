"""Compiled looks at few of a frame's pixels, as `frame.pyramid.Window` shows them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import fast_inlined_jit, fast_jit, jit
from padstudio.vision.frame.pyramid import Window


@fast_inlined_jit
def between(values: NDArray[np.uint8], step: int, first: int, x: float, y: float) -> float:
    """Value between four pixels, of one channel as of `padstudio.vision.frame.pyramid.Window`.

    Column x and row y must be at least 0, and a pixel away from the far ends.
    """
    column, row = int(x), int(y)
    fx, fy = x - column, y - row
    # Unsigned places are not looked up from the end, which would be asked for at each of them.
    left, right = np.uintp(column * step + first), np.uintp(column * step + first + step)
    here, below = np.uintp(row), np.uintp(row + 1)
    a, b = float(values[here, left]), float(values[below, left])
    top = a + fx * (values[here, right] - a)
    return float(top + fy * (b + fx * (values[below, right] - b) - top))


@fast_inlined_jit
def value_at(window: Window, column: float, row: float) -> float:
    """Grey value of a window between its pixels; beyond its rim the rim's."""
    h, w = len(window.values), window.width
    x, y = min(max(column, 0.0), w - 1.001), min(max(row, 0.0), h - 1.001)
    value = window.gain * between(window.values, window.step, window.first, x, y) + window.black
    if window.weight:
        # Not the colours' own shape: their rows may hold more than the picture.
        across, down = math.ceil(window.scale * w), math.ceil(window.scale * h)
        x = min(max(window.scale * x + window.shift, 0.0), across - 1.001)
        y = min(max(window.scale * y + window.shift, 0.0), down - 1.001)
        value += window.weight * between(window.colours, 1, 0, x, y)
    return value


@fast_jit
def values_at(window: Window, xy: Array) -> NDArray[np.float32]:
    """Grey values (N,) of a window at some of its columns and rows (N, 2)."""
    out = np.empty(len(xy), np.float32)
    for i in range(len(xy)):
        out[i] = value_at(window, xy[i, 0], xy[i, 1])
    return out


@fast_jit
def impulses(
    window: Window, corners: NDArray[np.intp], size: int, black: float, white: float, step: float
) -> int:
    """Pixels of some squares that are nearly black or white and stand out from their neighbours.

    Colours do not count. The squares' corners (N, 2) are columns and rows; their outermost pixels
    only serve as neighbours.
    """
    found, around = 0, np.empty(9)
    low, high = np.uint8(0), np.uint8(255)
    for raw in range(256):
        value = window.gain * raw + window.black
        low = np.uint8(raw) if value <= black else low
        high = np.uint8(255 - raw) if window.gain * (255 - raw) + window.black >= white else high
    for x0, y0 in corners:
        for y in range(y0 + 1, y0 + size - 1):
            # Most rows have none, and to see that takes a part of the time.
            some = False
            for x in range(x0 + 1, x0 + size - 1):
                value = window.values[np.uintp(y), np.uintp(x * window.step + window.first)]
                some |= (value <= low) | (value >= high)
            if not some:
                continue
            for x in range(x0 + 1, x0 + size - 1):
                at = x * window.step + window.first
                value = window.gain * window.values[y, at] + window.black
                if black < value < white:
                    continue
                for k in range(9):
                    beside = at + (k % 3 - 1) * window.step
                    around[k] = window.gain * window.values[y + k // 3 - 1, beside] + window.black
                around.sort()
                found += abs(value - around[4]) > step
    return found


@fast_jit
def halved(plane: NDArray[np.uint8], width: int) -> NDArray[np.uint8]:
    """A plane of so many columns at half the scale, by area averaging.

    On frames that the cache does not hold twice as fast as OpenCV's.
    """
    # An odd last row or column is left out.
    out = np.empty((len(plane) // 2, width // 2), np.uint8)
    for r in range(out.shape[0]):
        for c in range(out.shape[1]):
            top = np.uint16(plane[2 * r, 2 * c]) + np.uint16(plane[2 * r, 2 * c + 1])
            low = np.uint16(plane[2 * r + 1, 2 * c]) + np.uint16(plane[2 * r + 1, 2 * c + 1])
            out[r, c] = (top + low + 2) >> 2
    return out


@jit
def above(
    values: NDArray[np.float32], local: NDArray[np.float32], level: np.float32
) -> NDArray[np.uint8]:
    """255 where values (h, w) exceed both those of another plane and a level, else 0."""
    out = np.empty(values.shape, np.uint8)
    for r in range(values.shape[0]):
        for c in range(values.shape[1]):
            out[r, c] = 255 * ((values[r, c] > local[r, c]) & (values[r, c] > level))
    return out
