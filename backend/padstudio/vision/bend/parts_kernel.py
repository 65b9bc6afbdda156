"""Compiled sums and solutions of `padstudio.vision.bend.parts`."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import fast_jit

#: Parameters that all parts share: the pose, its drift while the shutter rolled, and a stretch of
#: the print along x, along y and by shear.
SHARED = 15
# Parts with fewer borders than this along both axes together tell nothing.
_FEWEST = 4


class PartSums(NamedTuple):
    """Weighted sums over the borders of each part of a print.

    Attributes
    ----------
    inner : (P, 2, 2) float64
        Of products of the changes with the part's own shift along x and y.
    cross : (P, 2, 15) float64
        Of those with the changes of what all share.
    shared : (P, 15, 15) float64
    pull, right : (P, 2), (P, 15) float64
        Of residuals with the changes of either.
    borders : (P,) int
        How many there are.
    """

    inner: Array
    cross: Array
    shared: Array
    pull: Array
    right: Array
    borders: NDArray[np.intp]


@fast_jit
def part_sums(
    rows: Array, row_time: Array, place: Array, trust: Array, part: NDArray[np.intp], parts: int
) -> PartSums:
    """Sums by parts.

    Parameters
    ----------
    rows : (N, 7) float64
        As of `padstudio.vision.pose.least_squares_kernel.linearize`, pixels.
    row_time : (N,) float64
    place : (P, 2) float64
        Middles of the parts, from where the print is stretched, mm.
    trust : (N,) float64
    part : (N,) int
        Which part each border lies on.
    parts : int
    """
    inner, cross = np.zeros((parts, 2, 2)), np.zeros((parts, 2, SHARED))
    shared, pull = np.zeros((parts, SHARED, SHARED)), np.zeros((parts, 2))
    right, count = np.zeros((parts, SHARED)), np.zeros(parts, np.intp)
    j = np.empty(SHARED)
    for i in range(len(rows)):
        p, r, w = part[i], rows[i, 0], trust[i]
        count[p] += 1
        for k in range(6):
            j[k] = rows[i, 1 + k]
            j[6 + k] = row_time[i] * j[k]
        x, y = place[p, 0], place[p, 1]
        j[12], j[13], j[14] = -x * j[0], -y * j[1], -(x * j[1] + y * j[0])
        # A part that moves is seen where a camera that moves the other way would see it.
        for a in range(2):
            m = -w * j[a]
            pull[p, a] += m * r
            for b in range(2):
                inner[p, a, b] -= m * j[b]
            for b in range(SHARED):
                cross[p, a, b] += m * j[b]
        for a in range(SHARED):
            t = w * j[a]
            right[p, a] += t * r
            for b in range(a + 1):
                shared[p, a, b] += t * j[b]
    for p in range(parts):
        for a in range(SHARED):
            for b in range(a):
                shared[p, b, a] = shared[p, a, b]
    return PartSums(inner, cross, shared, pull, right, count)


@fast_jit
def without_shifts(sums: PartSums, weight: Array, expected: float) -> tuple[Array, Array, float]:
    """Normal equations of what parts share, whatever their shifts are (Schur's complement).

    Parameters
    ----------
    sums : PartSums
    weight : (P,) float64
        By which each part counts.
    expected : float
        Inverse variance of shifts, 1/mm².

    Returns
    -------
    (15, 15), (15,) float64, float
        Matrix, right side, and twice the logarithm of the shifts' part of the likelihood.
    """
    normal, right, twice_log = np.zeros((SHARED, SHARED)), np.zeros(SHARED), 0.0
    for p in range(len(weight)):
        w = weight[p]
        if w <= 0 or sums.borders[p] < _FEWEST:
            continue
        a = sums.inner[p, 0, 0] + expected / w
        b, c = sums.inner[p, 0, 1], sums.inner[p, 1, 1] + expected / w
        det = a * c - b * b
        twice_log -= math.log(det * (w / expected) ** 2)
        u, v = sums.pull[p, 0], sums.pull[p, 1]
        fu, fv = (c * u - b * v) / det, (a * v - b * u) / det
        twice_log += w * (u * fu + v * fv)
        for k in range(SHARED):
            x, y = sums.cross[p, 0, k], sums.cross[p, 1, k]
            gx, gy = (c * x - b * y) / det, (a * y - b * x) / det
            right[k] += w * (sums.right[p, k] - (gx * u + gy * v))
            for m in range(SHARED):
                held = gx * sums.cross[p, 0, m] + gy * sums.cross[p, 1, m]
                normal[k, m] += w * (sums.shared[p, k, m] - held)
    return normal, right, twice_log
