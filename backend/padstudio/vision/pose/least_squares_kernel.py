"""Compiled Gauss–Newton of `padstudio.vision.pose.least_squares`: all steps of a fit in one call.

A fit solves a dozen small systems; called one by one from Python, each costs more than its work.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import fast_jit
from padstudio.geometry.small_matrices import solve, turned

# Weighted points above this share of the best one's trust tell the scatter.
_TELLING = 0.3
_CUT_OFF = 2.5
# A step that is shorter than so many standard deviations, squared, is the last.
_SETTLED = 0.01


@fast_jit
def linearize(
    points: Array,
    along: Array,
    rays: Array,
    moment: Array,
    rotation: Array,
    centre: Array,
    shift: Array,
    turn: Array,
) -> Array:
    """See `least_squares`: residual and its change with centre and turn, (N, 7)."""
    out = np.empty((len(points), 7))
    seen = np.empty((2, 3))
    for i in range(len(points)):
        s = moment[i]
        for k in range(2):
            f = 0.2 * k
            dx = points[i, 0] + f * along[i, 0] - centre[0] - s * shift[0]
            dy = points[i, 1] + f * along[i, 1] - centre[1] - s * shift[1]
            dz = points[i, 2] + f * along[i, 2] - centre[2] - s * shift[2]
            x = dx * rotation[0, 0] + dy * rotation[1, 0] + dz * rotation[2, 0]
            y = dx * rotation[0, 1] + dy * rotation[1, 1] + dz * rotation[2, 1]
            z = dx * rotation[0, 2] + dy * rotation[1, 2] + dz * rotation[2, 2]
            w0, w1, w2 = s * turn[0], s * turn[1], s * turn[2]
            seen[k, 0] = x - (w1 * z - w2 * y)
            seen[k, 1] = y - (w2 * x - w0 * z)
            seen[k, 2] = z - (w0 * y - w1 * x)
        x, y, z = seen[0]
        u, v = x / z, y / z
        tu, tv = seen[1, 0] / seen[1, 2] - u, seen[1, 1] / seen[1, 2] - v
        length = max(math.sqrt(tu * tu + tv * tv), 1e-15)
        nu, nv = -tv / length, tu / length
        out[i, 0] = (rays[i, 0] - u) * nu + (rays[i, 1] - v) * nv
        g0, g1, g2 = nu / z, nv / z, -(nu * u + nv * v) / z
        for k in range(3):
            out[i, 1 + k] = -(g0 * rotation[k, 0] + g1 * rotation[k, 1] + g2 * rotation[k, 2])
        out[i, 4] = -(y * g2 - z * g1)
        out[i, 5] = -(z * g0 - x * g2)
        out[i, 6] = -(x * g1 - y * g0)
    return out


@fast_jit
def normal_equations(rows: Array, moment: Array, weight: Array, size: int) -> tuple[Array, Array]:
    """Weighted normal matrix (size, size) and right side of linearized rows (N, 7)."""
    normal, right, j = np.zeros((size, size)), np.zeros(size), np.empty(12)
    for i in range(len(rows)):
        w = weight[i]
        if w <= 0:
            continue
        for k in range(6):
            j[k] = rows[i, 1 + k]
            j[6 + k] = moment[i] * j[k]
        for a in range(size):
            t = w * j[a]
            right[a] += t * rows[i, 0]
            for b in range(a + 1):
                normal[a, b] += t * j[b]
    for a in range(size):
        for b in range(a):
            normal[b, a] = normal[a, b]
    return normal, right


@fast_jit
def scores(
    rows: Array, moment: Array, weight: Array, tile: NDArray[np.intp], tiles: int, size: int
) -> Array:
    """Parts of the right side of `normal_equations` by tile, (tiles, size)."""
    out = np.zeros((tiles, size))
    for i in range(len(rows)):
        t = weight[i] * rows[i, 0]
        for k in range(size):
            out[tile[i], k] += t * (rows[i, 1 + k] if k < 6 else moment[i] * rows[i, k - 5])
    return out


@fast_jit
def scatter(residual: Array, weight: Array) -> float:
    """Robust standard deviation: the median of |residual| of trusted points over 0.6745."""
    size = np.abs(residual[weight > _TELLING * weight.max()])
    middle = len(size) // 2
    return max(float(np.partition(size, middle)[middle]) / 0.6745, 1e-3)


@fast_jit
def trust_of(residual: Array, weight: Array, sigma: float) -> Array:
    """Inverse variances of residuals, those that stand out trusted little."""
    return weight / (1 + (residual / (_CUT_OFF * sigma)) ** 2) ** 2 / sigma**2


@fast_jit
def fit(
    points: Array,
    along: Array,
    rays: Array,
    moment: Array,
    weight: Array,
    rotation: Array,
    centre: Array,
    shift: Array,
    turn: Array,
    prior: Array,
    expected: Array,
    focal_px: float,
    iterations: int,
) -> tuple[bool, Array, Array, Array, Array, Array, float]:
    """Robust Gauss–Newton for 6 or 12 parameters, as many as the prior has.

    Returns
    -------
    solved : bool
    rotation, centre, shift, turn
        The pose found.
    rows : (N, 7) float64
        Residuals there, pixels, and their change with centre and turn.
    sigma : float
        Their robust standard deviation at the last step.
    """
    size, sigma = len(prior), 1.0
    rows = linearize(points, along, rays, moment, rotation, centre, shift, turn) * focal_px
    for _ in range(iterations):
        residual = rows[:, 0].copy()
        sigma = scatter(residual, weight)
        normal, right = normal_equations(rows, moment, trust_of(residual, weight, sigma), size)
        for k in range(size):
            now = 0.0 if k < 6 else shift[k - 6] if k < 9 else turn[k - 9]
            normal[k, k] += prior[k]
            right[k] += prior[k] * (expected[k] - now)
        solved, step = solve(normal, right)
        if not solved:
            return False, rotation, centre, shift, turn, rows, sigma
        rotation, centre = turned(rotation, step[3:6]), centre + step[:3]
        if size == 12:
            shift, turn = shift + step[6:9], turn + step[9:]
        rows = linearize(points, along, rays, moment, rotation, centre, shift, turn) * focal_px
        if (step * right).sum() < _SETTLED:
            break
    return True, rotation, centre, shift, turn, rows, sigma
