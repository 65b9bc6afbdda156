"""Compiled Gauss–Newton of `padstudio.vision.pose.least_squares`: all steps of a fit in one call.

A fit solves a dozen small systems; called one by one from Python, each costs more than its work.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import fast_jit

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
def solve(matrix: Array, right: Array) -> tuple[bool, Array]:
    """Solution of a symmetric, positive definite system by Cholesky's factors."""
    n = len(right)
    low, x = np.zeros((n, n)), right.copy()
    for i in range(n):
        for j in range(i + 1):
            rest = matrix[i, j]
            for k in range(j):
                rest -= low[i, k] * low[j, k]
            if i == j:
                if not rest > 1e-13 * matrix[i, i]:
                    return False, x
                low[i, i] = math.sqrt(rest)
            else:
                low[i, j] = rest / low[j, j]
    for i in range(n):
        for k in range(i):
            x[i] -= low[i, k] * x[k]
        x[i] /= low[i, i]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            x[i] -= low[k, i] * x[k]
        x[i] /= low[i, i]
    return True, x


@fast_jit
def turned(rotation: Array, turn: Array) -> Array:
    """A rotation followed by a rotation vector in its own frame (Rodrigues), kept orthonormal."""
    angle = math.sqrt(turn[0] ** 2 + turn[1] ** 2 + turn[2] ** 2)
    a = 1 - angle * angle / 6 if angle < 1e-4 else math.sin(angle) / angle
    b = 0.5 - angle * angle / 24 if angle < 1e-4 else (1 - math.cos(angle)) / (angle * angle)
    w0, w1, w2 = turn
    skew = np.array([[0.0, -w2, w1], [w2, 0.0, -w0], [-w1, w0, 0.0]])
    step, out, square = np.eye(3), np.zeros((3, 3)), np.zeros((3, 3))
    for i in range(3):
        for j in range(3):
            step[i, j] += a * skew[i, j]
            for k in range(3):
                step[i, j] += b * skew[i, k] * skew[k, j]
    for i in range(3):
        for j in range(3):
            for k in range(3):
                out[i, j] += rotation[i, k] * step[k, j]
    # One step of Newton's toward the nearest rotation takes away what rounding adds.
    for i in range(3):
        for j in range(3):
            for k in range(3):
                square[i, j] += out[k, i] * out[k, j]
    kept = np.zeros((3, 3))
    for i in range(3):
        for j in range(3):
            for k in range(3):
                kept[i, j] += out[i, k] * ((1.5 if k == j else 0.0) - 0.5 * square[k, j])
    return kept


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
