"""Compiled elimination of brightness from the equations of a pattern: Schur complements."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from padstudio.arrays import Array
from padstudio.compiled import fast_jit

#: As `without_brightness` takes it.
HELD = 1e-9


class Eliminated(NamedTuple):
    """Each channel's normal matrix without its brightness.

    Attributes
    ----------
    inner : (C, K, K) float64
        Of the pose.
    shared : (C, L, K) float64
        What of a step of the pose brightness takes over.
    linear : (C, L, L) float64
        Of brightness.
    """

    inner: Array
    shared: Array
    linear: Array


@fast_jit
def eliminated(normal: Array, size: int) -> Eliminated:
    """The Schur complements of the channels' normal matrices (C, M, M)."""
    channels, linear = len(normal), normal.shape[1] - size
    inner, shared = np.empty((channels, size, size)), np.empty((channels, linear, size))
    rest, none = np.empty((channels, linear, linear)), np.zeros(size + linear)
    for c in range(channels):
        inner[c], _, shared[c], _ = without_brightness(normal[c], none, size, HELD)
        for a in range(linear):
            for b in range(linear):
                rest[c, a, b] = normal[c, size + max(a, b), size + min(a, b)]
            rest[c, a, a] += max(HELD * rest[c, a, a], 1e-9)
    return Eliminated(inner, shared, rest)


@fast_jit
def without_brightness(
    normal: Array, right: Array, size: int, held: float
) -> tuple[Array, Array, Array, Array]:
    """Normal equations of the pose alone: the Schur complement of the L terms of brightness.

    Parameters
    ----------
    normal : (size + L, size + L) float64
        Lower triangle.
    right : (size + L,) float64
    size : int
    held : float
        Terms are held to what they are by this share of what the picture says of them, so that
        those it says nothing of, as of a layer out of view, can be solved for.

    Returns
    -------
    normal : (size, size) float64
    right : (size,) float64
    shared : (L, size) float64
        What of a step of the pose brightness takes over.
    change : (L,) float64
        Of brightness, while the pose stays.
    """
    linear = len(right) - size
    work = np.empty((linear, linear + size + 1))
    for a in range(linear):
        for b in range(linear):
            work[a, b] = normal[size + max(a, b), size + min(a, b)]
        work[a, a] += max(held * work[a, a], 1e-9)
        for k in range(size):
            work[a, linear + k] = normal[size + a, k]
        work[a, linear + size] = right[size + a]
    # Gauss-Jordan; a positive definite matrix needs no pivots.
    for p in range(linear):
        work[p, p:] /= work[p, p]
        for a in range(linear):
            if a != p:
                work[a, p:] -= work[a, p] * work[p, p:]
    shared, change = work[:, linear : linear + size].copy(), work[:, linear + size].copy()
    inner, pull = np.empty((size, size)), right[:size].copy()
    for a in range(size):
        for b in range(size):
            inner[a, b] = normal[max(a, b), min(a, b)]
        for k in range(linear):
            across = normal[size + k, a]
            pull[a] -= across * change[k]
            for b in range(size):
                inner[a, b] -= across * shared[k, b]
    return inner, pull, shared, change
