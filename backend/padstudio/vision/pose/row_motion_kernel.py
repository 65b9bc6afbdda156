"""Compiled sums of `padstudio.vision.pose.row_motion`: one pass over measured borders."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import fast_jit

#: Parameters of a frame that stands still: centre, attitude, and how far steps of upright and of
#: level borders seem to lie toward the dark.
STATIC = 8
#: Intervals of rows over what was measured; a vibration of four periods a frame needs as many over
#: all of it.
INTERVALS, FEW_INTERVALS = 16, 8
#: Over less than such a share of the frame a shaking looks like tilt, and is always reckoned with.
FEW_ROWS = 0.5


class RowSums(NamedTuple):
    """Normal equations by intervals of rows, within which f goes from 0 to 1.

    Attributes
    ----------
    normal : (3, I, 8, 8) float64
        Sums of Jᵀ J, of f Jᵀ J and of f² Jᵀ J.
    pull : (2, I, 8) float64
        Sums of Jᵀ r and of f Jᵀ r.
    """

    normal: Array
    pull: Array

    def about_rest(self, sway: Array) -> RowSums:
        """Sums about a shaking, as if they were about none.

        Parameters
        ----------
        sway : (I + 1, 3) float64
            Rotation vectors at the intervals' ends.
        """
        turns = self.normal[:, :, :, 3:6]
        begin, change = sway[:-1, :, None], np.diff(sway, axis=0)[:, :, None]
        moved = [(turns[k] @ begin + turns[k + 1] @ change)[:, :, 0] for k in range(2)]
        return RowSums(self.normal, self.pull + np.stack(moved))


@fast_jit
def intervals_over(first: float, last: float) -> tuple[float, float, int]:
    """Where intervals of rows begin that cover some row times, their length and their number."""
    count = INTERVALS if last - first > FEW_ROWS else FEW_INTERVALS
    return first - 1e-9, (last - first + 2e-9) / count, count


@fast_jit
def row_sums(
    rows: Array, sides: Array, row_time: Array, trust: Array, first: float, width: float, count: int
) -> RowSums:
    """Sums over ``count`` intervals of row time from ``first`` on, each ``width`` long.

    Parameters
    ----------
    rows : (N, 7) float64
        Residuals, and their change with centre and attitude.
    sides : (N, 2) float64
        Their change with the two biases toward the dark.
    row_time, trust : (N,) float64
    first, width : float
    count : int
    """
    normal, pull = np.zeros((3, count, STATIC, STATIC)), np.zeros((2, count, STATIC))
    j = np.empty(STATIC)
    for i in range(len(rows)):
        at = (row_time[i] - first) / width
        k = min(max(int(at), 0), count - 1)
        f = at - k
        for a in range(6):
            j[a] = rows[i, 1 + a]
        j[6], j[7] = sides[i, 0], sides[i, 1]
        for a in range(STATIC):
            t = trust[i] * j[a]
            pull[0, k, a] += t * rows[i, 0]
            pull[1, k, a] += f * t * rows[i, 0]
            for b in range(a + 1):
                product = t * j[b]
                normal[0, k, a, b] += product
                normal[1, k, a, b] += f * product
                normal[2, k, a, b] += f * f * product
    for m in range(3):
        for k in range(count):
            for a in range(STATIC):
                for b in range(a):
                    normal[m, k, b, a] = normal[m, k, a, b]
    return RowSums(normal, pull)


@fast_jit
def solve_with_priors(
    normal: Array, pull: Array, sigma: Array, log_prior: Array
) -> tuple[Array, Array, Array]:
    """Answers of normal equations under several priors of their last parameters.

    By Cholesky's decomposition of the equations, scaled so that their diagonal is one.

    Parameters
    ----------
    normal : (n, n) float64
    pull : (n,) float64
    sigma : (S, k) float64
        Prior standard deviations of the last k parameters, about zero.
    log_prior : (S,) float64
        Of each prior.

    Returns
    -------
    (S,) float64, (S, n) float64, (S, 6, 6) float64
        Log marginal likelihoods with their priors, but for a constant; means; covariances of the
        first six parameters.
    """
    size, held = len(pull), sigma.shape[1]
    log_weight = log_prior.copy()
    means, covariances = np.empty((len(sigma), size)), np.zeros((len(sigma), 6, 6))
    lower, unit = np.zeros((size, size)), np.empty(size)
    # Of L's inverse the first six columns, and what it makes of the pull.
    white = np.empty((size, 7))
    for s in range(len(sigma)):
        for i in range(size):
            k = i - size + held
            unit[i] = normal[i, i] if k < 0 else normal[i, i] + sigma[s, k] ** -2.0
            unit[i] = 1 / math.sqrt(unit[i])
        for i in range(size):
            for j in range(i + 1):
                left = 1 + 1e-13 if i == j else normal[i, j] * unit[i] * unit[j]
                for m in range(j):
                    left -= lower[i, m] * lower[j, m]
                if i == j:
                    lower[i, i] = math.sqrt(max(left, 1e-15))
                else:
                    lower[i, j] = left / lower[j, j]
            log_weight[s] -= math.log(lower[i, i] / unit[i])
            for c in range(7):
                value = unit[i] * pull[i] if c == 6 else unit[i] if c == i else 0.0
                for m in range(i):
                    value -= lower[i, m] * white[m, c]
                white[i, c] = value / lower[i, i]
        for k in range(held):
            log_weight[s] -= math.log(sigma[s, k])
        for i in range(size - 1, -1, -1):
            value = white[i, 6]
            log_weight[s] += 0.5 * value * value
            for m in range(i + 1, size):
                value -= lower[m, i] * means[s, m]
            means[s, i] = value / lower[i, i]
        for i in range(size):
            means[s, i] *= unit[i]
        for a in range(6):
            for b in range(6):
                for m in range(size):
                    covariances[s, a, b] += white[m, a] * white[m, b]
    return log_weight, means, covariances


@fast_jit
def noise_sums(
    rows: Array, trust: Array, tile: NDArray[np.intp], tiles: int
) -> tuple[Array, Array, Array]:
    """Of the pose's six parameters: normal matrix, sum of squared scores, and scores by tile."""
    normal, squares, scores = np.zeros((6, 6)), np.zeros((6, 6)), np.zeros((tiles, 6))
    for i in range(len(rows)):
        psi = trust[i] * rows[i, 0]
        for a in range(6):
            ja = rows[i, 1 + a]
            scores[tile[i], a] += psi * ja
            for b in range(a + 1):
                product = ja * rows[i, 1 + b]
                normal[a, b] += trust[i] * product
                squares[a, b] += psi * psi * product
    for a in range(6):
        for b in range(a):
            normal[b, a], squares[b, a] = normal[a, b], squares[a, b]
    return normal, squares, scores
