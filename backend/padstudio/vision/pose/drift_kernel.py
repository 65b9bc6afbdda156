"""Compiled half of `padstudio.vision.pose.row_motion`: all that a steady drift may explain."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from padstudio.arrays import Array
from padstudio.compiled import fast_jit
from padstudio.vision.pose.row_motion_kernel import STATIC, RowSums, solve_with_priors

# Intervals that leave a direction of shift this much less sure than the other tell nothing.
_ONE_SIDED = 50.0


class Rows(NamedTuple):
    """Normal equations by rows, scaled so that their inverse is a covariance.

    Attributes
    ----------
    sums : RowSums
    first, width : float
        Row time of the first interval's beginning, and its length.
    """

    sums: RowSums
    first: float
    width: float


class Priors(NamedTuple):
    """What is known beforehand.

    Attributes
    ----------
    bias_px : float
        One standard deviation of the biases toward the dark.
    sigma : (S, 6) or (1, 0) float64
        Standard deviations of the drift, about what is expected; without columns there is none.
    log_prior : (S,) float64
    """

    bias_px: float
    sigma: Array
    log_prior: Array


class Mixture(NamedTuple):
    """Moments of all answers.

    Attributes
    ----------
    mean : (n,) float64
    covariance : (6, 6) float64
        Of the pose.
    """

    mean: Array
    covariance: Array


class Drift(NamedTuple):
    """Answers under several sizes of a drift.

    Attributes
    ----------
    normal : (n, n) float64
        Of static parameters and drift, without the drift's prior.
    pull : (n,) float64
    log_weight : (S,) float64
    mean : (S, n) float64
    covariance : (S, 6, 6) float64
    mixed : Mixture
    unrest : float
        As of `unrest`, about the likeliest.
    """

    normal: Array
    pull: Array
    log_weight: Array
    mean: Array
    covariance: Array
    mixed: Mixture
    unrest: float


@fast_jit
def drifting(rows: Rows, away: Array, priors: Priors) -> Drift:
    """Pose, biases and drift by the sums over rows.

    Parameters
    ----------
    rows : Rows
    away : (6,) float64
        The drift about which the sums were made, less the expected one.
    priors : Priors
    """
    normal, pull = static(rows.sums)
    for k in range(6, STATIC):
        normal[k, k] += 1 / priors.bias_px**2
    if priors.sigma.shape[1] > 0:
        normal, pull = with_drift(normal, pull, rows, away)
    found = solve_with_priors(normal, pull, priors.sigma, priors.log_prior)
    log_weight, mean, covariance = found
    likeliest = mean[np.argmax(log_weight)]
    best = np.zeros(STATIC + 6)
    best[: len(pull)] = likeliest
    shakes = unrest(rows, best, away, np.zeros((0, 3)))
    mixed = mixture(log_weight, mean, covariance)
    return Drift(normal, pull, log_weight, mean, covariance, mixed, shakes)


@fast_jit
def static(sums: RowSums) -> tuple[Array, Array]:
    """Normal equations (8, 8) of a frame that stands still."""
    normal, pull = np.zeros((STATIC, STATIC)), np.zeros(STATIC)
    for k in range(sums.pull.shape[1]):
        for a in range(STATIC):
            pull[a] += sums.pull[0, k, a]
            for b in range(STATIC):
                normal[a, b] += sums.normal[0, k, a, b]
    return normal, pull


@fast_jit
def with_drift(normal: Array, pull: Array, rows: Rows, away: Array) -> tuple[Array, Array]:
    """Normal equations (14, 14) of the static parameters and the drift, without its prior."""
    size, width = STATIC + 6, rows.width
    m0, m1, m2 = rows.sums.normal[0], rows.sums.normal[1], rows.sums.normal[2]
    g0, g1 = rows.sums.pull[0], rows.sums.pull[1]
    whole, right = np.zeros((size, size)), np.zeros(size)
    whole[:STATIC, :STATIC], right[:STATIC] = normal, pull
    for k in range(len(g0)):
        at = rows.first + width * k
        for b in range(6):
            right[STATIC + b] += at * g0[k, b] + width * g1[k, b]
            for a in range(STATIC):
                whole[a, STATIC + b] += at * m0[k, a, b] + width * m1[k, a, b]
            for a in range(6):
                twice = at * at * m0[k, a, b] + 2 * width * at * m1[k, a, b]
                whole[STATIC + a, STATIC + b] += twice + width * width * m2[k, a, b]
    for b in range(STATIC, size):
        for a in range(STATIC):
            whole[b, a] = whole[a, b]
    for a in range(size):
        for b in range(6):
            right[a] += whole[a, STATIC + b] * away[b]
    return whole, right


@fast_jit
def unrest(rows: Rows, best: Array, away: Array, sway: Array) -> float:
    """Squared shifts that single intervals still ask for, over their variance.

    Parameters
    ----------
    rows : Rows
    best : (14,) float64
        Static parameters and drift.
    away : (6,) float64
    sway : (I + 1, 3) float64
        Rotation vectors of a shaking at the intervals' ends; (0, 3) of none.
    """
    m0, m1, g0 = rows.sums.normal[0], rows.sums.normal[1], rows.sums.pull[0]
    squares, telling, left = 0.0, 0, np.empty(2)
    for k in range(len(g0)):
        at = rows.first + rows.width * k
        for i in range(2):
            left[i] = g0[k, 3 + i]
            for j in range(STATIC):
                left[i] -= m0[k, 3 + i, j] * best[j]
            for j in range(6):
                moment = at * m0[k, 3 + i, j] + rows.width * m1[k, 3 + i, j]
                left[i] -= moment * (best[STATIC + j] - away[j])
            for j in range(3 if len(sway) else 0):
                later = m1[k, 3 + i, 3 + j]
                left[i] -= (m0[k, 3 + i, 3 + j] - later) * sway[k, j] + later * sway[k + 1, j]
        a, b, c = m0[k, 3, 3], m0[k, 4, 4], m0[k, 3, 4]
        middle, half = (a + b) / 2, math.sqrt((a - b) ** 2 / 4 + c * c)
        if middle > 0 and middle + half < _ONE_SIDED * (middle - half):
            x, y = left[0], left[1]
            squares += (b * x * x - 2 * c * x * y + a * y * y) / (a * b - c * c)
            telling += 1
    free = 2 * telling - 6
    return squares / free if free > 0 else 0.0


@fast_jit
def mixture(log_weight: Array, mean: Array, covariance: Array) -> Mixture:
    """Moments of answers (S, n) with covariances (S, 6, 6) of their first six parameters."""
    weight = np.exp(log_weight - log_weight.max())
    weight /= weight.sum()
    whole, spread = np.zeros(mean.shape[1]), np.zeros((6, 6))
    for s in range(len(weight)):
        whole += weight[s] * mean[s]
    for s in range(len(weight)):
        for a in range(6):
            for b in range(6):
                away = (mean[s, a] - whole[a]) * (mean[s, b] - whole[b])
                spread[a, b] += weight[s] * (covariance[s, a, b] + away)
    return Mixture(whole, spread)
