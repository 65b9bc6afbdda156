"""Compiled least squares of `mixture`: one channel against the terms of its model."""

from __future__ import annotations

import math

import numpy as np

from padstudio.arrays import Array
from padstudio.compiled import fast_jit
from padstudio.geometry.small_matrices import solve

#: Terms of the light, and those of them by which a layer's gain may change over the frame.
LIGHT, GAIN = 6, 3
# Rounds of reweighting: the weights change by less than a hundredth in the fourth.
_ROUNDS = 4
# Geman-McClure's weights fall to a quarter at so many standard deviations of the rest.
_CUT_OFF, _LEAST_SIGMA = 3.0, 1.0


@fast_jit
def normal_equations(terms: Array, values: Array, weight: Array) -> tuple[Array, Array]:
    """Weighted normal matrix (M, M) and right side (M,) of a linear model with terms (N, M)."""
    size = terms.shape[1]
    normal, right = np.zeros((size, size)), np.zeros(size)
    for i in range(len(values)):
        for a in range(size):
            t = weight[i] * terms[i, a]
            right[a] += t * values[i]
            for b in range(a + 1):
                normal[a, b] += t * terms[i, b]
    for a in range(size):
        # Levels of a layer of which one cell is in view are a part of the light.
        normal[a, a] = normal[a, a] * (1 + 1e-6) + 1e-9
        for b in range(a):
            normal[b, a] = normal[a, b]
    return normal, right


@fast_jit
def left_over(normal: Array, right: Array, total: float, out: int, until: int) -> float:
    """Weighted squares that all terms but those from ``out`` to ``until`` leave over."""
    size = len(right) - (until - out)
    part, side = np.empty((size, size)), np.empty(size)
    for a in range(size):
        row = a if a < out else a + until - out
        side[a] = right[row]
        for b in range(size):
            part[a, b] = normal[row, b if b < out else b + until - out]
    _, solution = solve(part, side)
    return max(total - float((solution * side).sum()), 1e-9)


@fast_jit
def fit_channel(values: Array, terms: Array) -> tuple[float, float, Array, Array]:
    """The mixture of a channel's values (N,) by terms (N, 6 + 3 L).

    Returns
    -------
    explained : float
    residual : float
    shows, gain : (L,) float64
        As of `padstudio.vision.cells.mixture.ChannelMixture`, by layer.
    """
    weight, solution = np.ones(len(values)), np.zeros(terms.shape[1])
    for _ in range(_ROUNDS):
        normal, right = normal_equations(terms, values, weight)
        _, solution = solve(normal, right)
        left = values - (terms * solution).sum(axis=1)
        sigma = max(1.4826 * float(np.median(np.abs(left))), _LEAST_SIGMA)
        weight = 1 / (1 + (left / (_CUT_OFF * sigma)) ** 2) ** 2
    normal, right = normal_equations(terms, values, weight)
    total, size = (weight * values * values).sum(), terms.shape[1]
    full = left_over(normal, right, total, size, size)
    light = left_over(normal, right, total, LIGHT, size)
    layers = (size - LIGHT) // GAIN
    shows, gain = np.zeros(layers), np.zeros(layers)
    for k in range(layers):
        first = LIGHT + GAIN * k
        shows[k] = 1 - full / left_over(normal, right, total, first, first + GAIN)
        gain[k] = solution[first]
    return 1 - full / light, math.sqrt(full / weight.sum()), shows, gain
