"""Compiled algebra of matrices so small that a call of NumPy costs more than its work."""

from __future__ import annotations

import math

import numpy as np

from padstudio.arrays import Array
from padstudio.compiled import fast_jit

# Jacobi's turns converge quadratically, in six sweeps or so.
_SWEEPS = 30


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
def least_axis(matrix: Array) -> Array:
    """Eigenvector (n,) of the least eigenvalue of a symmetric matrix (n, n), by Jacobi's turns."""
    n = len(matrix)
    left, axes = matrix.copy(), np.eye(n)
    for _ in range(_SWEEPS):
        beside = among = 0.0
        for p in range(n):
            among += left[p, p] * left[p, p]
            for q in range(p):
                beside += left[p, q] * left[p, q]
        if not beside > 1e-32 * among:
            break
        for p in range(n):
            for q in range(p + 1, n):
                if left[p, q] != 0:
                    _turn(left, axes, p, q)
    least = 0
    for p in range(1, n):
        least = p if left[p, p] < left[least, least] else least
    return axes[:, least].copy()


@fast_jit
def _turn(left: Array, axes: Array, p: int, q: int) -> None:
    """Turn two axes so that the matrix has nothing left between them."""
    ratio = (left[q, q] - left[p, p]) / (2 * left[p, q])
    tangent = math.copysign(1 / (abs(ratio) + math.sqrt(ratio * ratio + 1)), ratio)
    c = 1 / math.sqrt(tangent * tangent + 1)
    s = tangent * c
    for k in range(len(left)):
        a, b = left[k, p], left[k, q]
        left[k, p], left[k, q] = c * a - s * b, s * a + c * b
    for k in range(len(left)):
        a, b = left[p, k], left[q, k]
        left[p, k], left[q, k] = c * a - s * b, s * a + c * b
        a, b = axes[k, p], axes[k, q]
        axes[k, p], axes[k, q] = c * a - s * b, s * a + c * b


@fast_jit
def rotation_vector(rotation: Array) -> Array:
    """The rotation vector (3,) of a rotation (3, 3) by less than half a turn."""
    vector = np.array(
        [
            (rotation[2, 1] - rotation[1, 2]) / 2,
            (rotation[0, 2] - rotation[2, 0]) / 2,
            (rotation[1, 0] - rotation[0, 1]) / 2,
        ]
    )
    sine = math.sqrt(vector[0] ** 2 + vector[1] ** 2 + vector[2] ** 2)
    cosine = (rotation[0, 0] + rotation[1, 1] + rotation[2, 2] - 1) / 2
    return vector * (math.atan2(sine, cosine) / sine if sine > 0 else 1.0)


@fast_jit
def inverse_trace(matrix: Array, other: Array) -> float:
    """Trace of ``inverse(matrix) @ other``, both (n, n), symmetric; units may differ widely.

    The matrix is scaled so that its diagonal is one; rounding may take it to the brink.
    """
    n = len(matrix)
    unit, root = np.empty(n), np.zeros((n, n))
    for i in range(n):
        unit[i] = 1 / math.sqrt(max(matrix[i, i], 1e-300))
    # Cholesky's factor, and then its inverse's rows, which turn the other matrix.
    for i in range(n):
        for j in range(i + 1):
            rest = matrix[i, j] * unit[i] * unit[j]
            for k in range(j):
                rest -= root[i, k] * root[j, k]
            root[i, j] = math.sqrt(max(rest, 1e-14)) if i == j else rest / root[j, j]
    back, trace = np.zeros((n, n)), 0.0
    for i in range(n):
        for c in range(i + 1):
            rest = unit[i] if c == i else 0.0
            for k in range(c, i):
                rest -= root[i, k] * back[k, c]
            back[i, c] = rest / root[i, i]
        for a in range(i + 1):
            for b in range(i + 1):
                trace += back[i, a] * other[a, b] * back[i, b]
    return trace


@fast_jit
def turned(rotation: Array, rotvec: Array) -> Array:
    """A rotation followed by a rotation vector in its own frame (Rodrigues), kept orthonormal."""
    angle = math.sqrt(rotvec[0] ** 2 + rotvec[1] ** 2 + rotvec[2] ** 2)
    a = 1 - angle * angle / 6 if angle < 1e-4 else math.sin(angle) / angle
    b = 0.5 - angle * angle / 24 if angle < 1e-4 else (1 - math.cos(angle)) / (angle * angle)
    w0, w1, w2 = rotvec
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
    # One step of Newton and Schulz toward the nearest rotation takes away what rounding adds.
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
