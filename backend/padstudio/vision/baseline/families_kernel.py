"""Compiled loops of `vanishing_points` and `line_grid`, which say what they compute."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import jit
from padstudio.geometry.small_matrices import least_axis

# So often a vanishing point is fitted anew to the lines that point at it.
_SETTLING = 3


@jit
def aligned(point: Array, ends: Array, aligned_rad: float) -> NDArray[np.bool_]:
    """Which lines (M, 2, 2) point at a vanishing point (3,)."""
    out = np.empty(len(ends), np.bool_)
    steepest = math.tan(aligned_rad)
    for k in range(len(ends)):
        ax, ay = ends[k, 1, 0] - ends[k, 0, 0], ends[k, 1, 1] - ends[k, 0, 1]
        mx, my = (ends[k, 0, 0] + ends[k, 1, 0]) / 2, (ends[k, 0, 1] + ends[k, 1, 1]) / 2
        tx, ty = point[0] - point[2] * mx, point[1] - point[2] * my
        out[k] = abs(ax * ty - ay * tx) <= steepest * abs(ax * tx + ay * ty)
    return out


@jit
def settled(point: Array, lines: Array, ends: Array, weight: Array, aligned_rad: float) -> Array:
    """The point (3,) nearest to the lines (M, 3) that point at it, by weight (M,)."""
    for _ in range(_SETTLING):
        near, normal = aligned(point, ends, aligned_rad), np.zeros((3, 3))
        for k in range(len(lines)):
            if near[k]:
                for i in range(3):
                    for j in range(3):
                        normal[i, j] += weight[k] * weight[k] * lines[k, i] * lines[k, j]
        point = least_axis(normal)
    return point


@jit
def weigh_steps(
    place: Array, support: Array, steps: Array, anchors: Array, near: float
) -> tuple[Array, NDArray[np.intp]]:
    """What even steps (S,) explain of lines' support, each from the best of some anchors (A,).

    Returns
    -------
    scores : (S,) float64
        Share of the support (M,) of lines whose place (M,) is within ``near`` of a whole step.
    best : (S,) intp
        Number of the anchor.
    """
    scores, best = np.full(len(steps), -1.0), np.zeros(len(steps), np.intp)
    total = support.sum()
    for s in range(len(steps)):
        for a in range(len(anchors)):
            explained = 0.0
            for k in range(len(place)):
                offset = (place[k] - anchors[a]) / steps[s]
                if abs(offset - math.floor(offset + 0.5)) < near:
                    explained += support[k]
            if explained / total > scores[s]:
                scores[s], best[s] = explained / total, a
    return scores, best


@jit
def fit_lattice(
    ends: Array, numbers: Array, support: Array, near: float, least: int, rounds: int
) -> tuple[bool, Array]:
    """The map (3, 3) to lattice coordinates, weighed anew in rounds; `numbers` loses misfits.

    Returns
    -------
    found : bool
        False where fewer than ``least`` lines of a family are left.
    fit : (3, 3) float64
    """
    fit = np.zeros((3, 3))
    for _ in range(rounds):
        for axis in range(2):
            if len(numbers[axis]) - np.isnan(numbers[axis]).sum() < least:
                return False, fit
        fit = least_axis(lattice_equations(ends, numbers, support, fit)).reshape((3, 3))
        drop_misfits(numbers, ends, fit, near)
    return True, fit


@jit
def lattice_equations(ends: Array, numbers: Array, support: Array, fit: Array) -> Array:
    """Normal equations (9, 9) of the map (3, 3) under which ends lie on their numbered lines.

    Errors are distances under the map ``fit``; where it is 0, algebraic ones. Lines numbered NaN do
    not count.
    """
    normal, row = np.zeros((9, 9)), np.zeros(9)
    for axis in range(2):
        for k in range(len(ends)):
            number = numbers[axis, k]
            if math.isnan(number):
                continue
            nx, ny = fit[axis, 0] - number * fit[2, 0], fit[axis, 1] - number * fit[2, 1]
            steep = nx * nx + ny * ny
            weight = support[k] / (steep if steep > 0 else 1.0)
            for end in range(2):
                row[:] = 0.0
                for i in range(3):
                    value = ends[k, end, i] if i < 2 else 1.0
                    row[3 * axis + i], row[6 + i] = value, -number * value
                for i in range(9):
                    for j in range(9):
                        normal[i, j] += weight * row[i] * row[j]
    return normal


@jit
def drop_misfits(numbers: Array, ends: Array, fit: Array, near: float) -> None:
    """Number those lines NaN with an end that the map puts off their line."""
    for k in range(len(ends)):
        for end in range(2):
            x, y = ends[k, end, 0], ends[k, end, 1]
            w = fit[2, 0] * x + fit[2, 1] * y + fit[2, 2]
            for axis in range(2):
                at = fit[axis, 0] * x + fit[axis, 1] * y + fit[axis, 2]
                if not abs(at - numbers[axis, k] * w) < near * abs(w):
                    numbers[axis, k] = np.nan
