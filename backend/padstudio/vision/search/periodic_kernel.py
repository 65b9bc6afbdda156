"""Compiled inner loop of `padstudio.vision.search.periodic_axes`."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import fast_jit
from padstudio.vision.search.line_spacing import LEAST_SLOPE
from padstudio.vision.search.search_kernel import LEAST_COSINE, Edges, axes_at


@fast_jit
def most_periodic(
    normals: Array,
    angles: Array,
    turns: Array,
    edges: Edges,
    tiles: tuple[NDArray[np.intp], int],
    band: tuple[int, int, float],
) -> tuple[float, Array]:
    """See `periodic_axes`: the clearest spacing's contrast and the axes that show it.

    Parameters
    ----------
    normals : (N, 3) float64
    angles : (N,) float64
        Of the first axis on each plane.
    turns : (T,) float64
        Beside those.
    edges : Edges
    tiles : (E,) int, int
        Each edge's tile, and how many there are.
    band : (first, last, step)
        Frequencies, in steps of so many for a distance of 1 on the plane at distance 1.
    """
    (rays, lines), (tile, count), (first, last, step) = edges, tiles, band
    size = last - first + 1
    best, best_axes = -1.0, np.eye(3)
    real, imaginary = np.empty((2 * count, size)), np.empty((2 * count, size))
    total = np.empty(2 * count)
    for k in range(len(normals)):
        for turn in turns:
            axes = axes_at(normals[k], angles[k] + turn)
            real[:], imaginary[:], total[:] = 0.0, 0.0, 0.0
            for e in range(len(rays)):
                across, along = abs(_dot(lines[e], axes[0])), abs(_dot(lines[e], axes[1]))
                axis, depth = int(along > across), _dot(rays[e], axes[2])
                if min(across, along) > LEAST_SLOPE * max(across, along) or depth < LEAST_COSINE:
                    continue
                place = 2 * np.pi * step * _dot(rays[e], axes[axis]) / depth
                at = 2 * tile[e] + axis
                total[at] += 1
                c, s = math.cos(first * place), math.sin(first * place)
                dc, ds = math.cos(place), math.sin(place)
                for f in range(size):
                    real[at, f] += c
                    imaginary[at, f] += s
                    c, s = c * dc - s * ds, s * dc + c * ds
            every = max(total.sum(), 1.0)
            for f in range(size):
                power = 0.0
                for at in range(2 * count):
                    power += real[at, f] ** 2 + imaginary[at, f] ** 2 - total[at]
                if power / every > best:
                    best, best_axes = power / every, axes
    return best, best_axes


@fast_jit
def _dot(a: Array, b: Array) -> float:
    return float(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])
