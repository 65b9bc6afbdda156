"""Compiled algebra of the filter's matrices, up to 21 × 21."""

from __future__ import annotations

import math

import numpy as np

from padstudio.arrays import Array
from padstudio.compiled import fast_jit


@fast_jit
def product(a: Array, b: Array) -> Array:
    """``a @ b``."""
    out = np.zeros((a.shape[0], b.shape[1]))
    for i in range(a.shape[0]):
        for k in range(a.shape[1]):
            factor = a[i, k]
            if factor != 0.0:
                for j in range(b.shape[1]):
                    out[i, j] += factor * b[k, j]
    return out


@fast_jit
def sandwich(a: Array, b: Array) -> Array:
    """``a @ b @ a.T``, kept symmetric."""
    left = product(a, b)
    out = np.zeros((a.shape[0], a.shape[0]))
    for i in range(a.shape[0]):
        for j in range(i + 1):
            for k in range(a.shape[1]):
                out[i, j] += left[i, k] * a[j, k]
            out[j, i] = out[i, j]
    return out


@fast_jit
def lower_root(matrix: Array) -> Array:
    """Cholesky's factor of a positive definite matrix; rounding may take it to the brink."""
    n = len(matrix)
    low = np.zeros((n, n))
    for i in range(n):
        for j in range(i + 1):
            rest = matrix[i, j]
            for k in range(j):
                rest -= low[i, k] * low[j, k]
            if i == j:
                low[i, i] = math.sqrt(max(rest, 1e-14 * matrix[i, i], 1e-300))
            else:
                low[i, j] = rest / low[j, j]
    return low


@fast_jit
def solved(low: Array, right: Array) -> Array:
    """``inverse(low @ low.T) @ right`` for a matrix of right sides."""
    x = right.copy()
    n, m = x.shape
    for i in range(n):
        for k in range(i):
            for c in range(m):
                x[i, c] -= low[i, k] * x[k, c]
        for c in range(m):
            x[i, c] /= low[i, i]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            for c in range(m):
                x[i, c] -= low[k, i] * x[k, c]
        for c in range(m):
            x[i, c] /= low[i, i]
    return x


@fast_jit
def rotation_vector(a: Array, b: Array) -> Array:
    """The rotation vector (3,) of ``a.T @ b``, by its quaternion."""
    r = np.zeros((3, 3))
    for i in range(3):
        for j in range(3):
            for k in range(3):
                r[i, j] += a[k, i] * b[k, j]
    axis = np.array([r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]]) / 2
    sine = math.sqrt(axis[0] ** 2 + axis[1] ** 2 + axis[2] ** 2)
    cosine = (r[0, 0] + r[1, 1] + r[2, 2] - 1) / 2
    angle = math.atan2(sine, cosine)
    if sine > 1e-9:
        return axis * (angle / sine)
    if cosine > 0:
        return axis
    # Half a turn: the axis is the column of r + 1 that is longest.
    k = 0
    for i in range(1, 3):
        if r[i, i] > r[k, k]:
            k = i
    column = r[:, k].copy()
    column[k] += 1
    return column * (math.pi / math.sqrt(column[0] ** 2 + column[1] ** 2 + column[2] ** 2))


@fast_jit
def skew(vector: Array) -> Array:
    """(3, 3), which times a vector is the cross product of this one with it."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
