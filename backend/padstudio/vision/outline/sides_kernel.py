"""Compiled loops of `sides`: profiles across a side, and the line through their steps."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import fast_jit

_ROUNDS = 8
# A line is known to so many pixels at the best.
_LEAST_SIGMA = 0.02


@fast_jit
def ends(values: Array) -> tuple[Array, Array]:
    """Means (N,) of the inner and of the outer quarter of profiles (N, S)."""
    count, samples = values.shape
    quarter = samples // 4
    inside, outside = np.zeros(count), np.zeros(count)
    for k in range(count):
        for i in range(quarter):
            inside[k] += values[k, i] / quarter
            outside[k] += values[k, samples - 1 - i] / quarter
    return inside, outside


@fast_jit
def contrast(values: Array) -> float:
    """The step of profiles (N, S) in units of what scatters on either side of it."""
    inside, outside = ends(values)
    spread = math.sqrt((inside.var() + outside.var()) / 2) + 1e-6
    return float((outside.mean() - inside.mean()) / spread)


@fast_jit
def half_way(values: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Where profiles (N, S) pass half way from inside to outside, and whether they do so well.

    The area under the rising part tells the place better than a crossing does: it uses every
    sample, and noise averages out.

    Returns
    -------
    shift : (N,) float64
        −1 … 1, from a profile's first sample to its last.
    good : (N,) bool
    """
    count, samples = values.shape
    low, high = ends(values)
    typical = float(np.median(high - low))
    shift, good = np.empty(count), np.empty(count, np.bool_)
    for k in range(count):
        rise = high[k] - low[k]
        good[k] = typical > 0 and 0.4 * typical < rise < 2.5 * typical
        filled, before = 0.0, 0.0
        for i in range(samples):
            # Clipping at 0 and 1 would count noise on one side only, and shift the step by it.
            part = (values[k, i] - low[k]) / (rise if rise > 0 else 1.0)
            part = min(max(part, -1.0), 2.0)
            filled += part + before if i else 0.0
            before = part
        shift[k] = 1 - filled / (samples - 1)
    return shift, good


@fast_jit
def robust_line(rays: Array, focal_px: float) -> tuple[Array, Array, float]:
    """A line through most of some points (N, 2) of the plane z = 1.

    Returns
    -------
    line : (3,) float64
        Unit normal and offset.
    off : (N,) float64
        How far the points are from it, frame pixels.
    sigma : float
        Their robust standard deviation, frame pixels.
    """
    weight, off = np.ones(len(rays)), np.empty(len(rays))
    line, sigma = np.zeros(3), np.inf
    for _ in range(_ROUNDS):
        total = mx = my = xx = xy = yy = 0.0
        for k in range(len(rays)):
            total += weight[k]
            mx, my = mx + weight[k] * rays[k, 0], my + weight[k] * rays[k, 1]
        mx, my = mx / total, my / total
        for k in range(len(rays)):
            x, y = rays[k, 0] - mx, rays[k, 1] - my
            xx, xy, yy = xx + weight[k] * x * x, xy + weight[k] * x * y, yy + weight[k] * y * y
        angle = 0.5 * math.atan2(2 * xy, xx - yy)
        line[0], line[1] = -math.sin(angle), math.cos(angle)
        line[2] = -(line[0] * mx + line[1] * my)
        for k in range(len(rays)):
            off[k] = (rays[k, 0] * line[0] + rays[k, 1] * line[1] + line[2]) * focal_px
        sigma = max(float(np.median(np.abs(off))) / 0.6745, _LEAST_SIGMA)
        for k in range(len(rays)):
            weight[k] = 1 / (1 + (off[k] / (2 * sigma)) ** 2) ** 2
    return line, off, sigma
