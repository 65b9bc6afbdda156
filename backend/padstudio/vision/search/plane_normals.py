"""Stage `lines`, dense, first half: the plane of the grid and the two directions of its lines.

The camera is calibrated and the lines are at right angles on the pad, so both families follow
from one rotation: every edge that lies on a grid line is parallel, on the pad, to one of two
axes at 90°. For a candidate plane normal each edge has an angle on the plane; four times that
angle agrees for both families, so the length of the mean of exp(4i·angle) tells how well the
normal fits. From the best ones the axes are turned until edges point along them in the picture.

Each edge is weighted by how much the plane's angle turns for a turn in the picture, so that edges
of no order give zero for every normal; the norm is that of Cauchy and Schwarz, so that a few heavy
edges cannot win. Near edges count for more, as cells shrink with distance, and a plane that most
edges cannot lie on, being behind the camera there, loses their share.

This is a search for orthogonal vanishing points on the Gaussian sphere, over the normal of their
plane instead of the points themselves.

References
----------
Barnard, S. T. (1983). Interpreting perspective images. Artificial Intelligence 21(4).
"""

from __future__ import annotations

import math

import numpy as np

from padstudio.arrays import Array
from padstudio.vision.search import search_kernel as kernels
from padstudio.vision.search.edges import EdgeSet

# Rings of candidate normals: (tilt in degrees, how many), some 10 degrees apart, from where a climb
# leads to the maximum; denser where foreshortening is strong.
_LOW_RINGS = ((12, 6), (23, 11), (33, 15), (42, 20))
_HIGH_RINGS = ((50, 24), (57, 30), (63, 36), (68, 42), (72, 48), (76, 54))
# Edges that choose the starts and lead the climb from each of so many, and those that end it. Half
# as many in the end lose one still of the score.
_COARSE_EDGES, _FINE_EDGES = 800, 2000
_STARTS = 3
# A start of less than this share of the best one's coherence is not climbed from.
_WORTH = 0.8
# A coherence from which no other start need be tried, unless planes are steep.
# 0.25 and 1 (never) find the same stills of the score.
_CLEAR = 0.5


def ring(rings: tuple[tuple[int, int], ...]) -> Array:
    normals = []
    for tilt, count in rings:
        azimuth = 2 * math.pi * (np.arange(count) + (count % 2) / 2) / count
        t = math.radians(tilt)
        normals.append(
            np.stack(
                [
                    math.sin(t) * np.cos(azimuth),
                    math.sin(t) * np.sin(azimuth),
                    np.full(count, math.cos(t)),
                ],
                axis=1,
            )
        )
    return np.concatenate(normals)


_LOW = np.concatenate([[[0.0, 0.0, 1.0]], ring(_LOW_RINGS)])
_HIGH = ring(_HIGH_RINGS)


def coherence_of(edges: EdgeSet, *, steep: bool) -> float:
    """The best coherence of all candidate planes, 0 … 1; parameters as of `find_axes`."""
    return float(_scores(edges, _rays(edges), steep).max())


def find_axes(edges: EdgeSet, *, steep: bool) -> list[tuple[float, Array]]:
    """Candidate axes of the grid, the most coherent first.

    Parameters
    ----------
    edges : EdgeSet
    steep : bool
        Start from planes tilted by more than 45° rather than less; it takes four times as long.

    Returns
    -------
    list of (coherence, axes)
        At most three; axes as in `LineFamilies`.
    """
    rays = _rays(edges)
    found: list[tuple[float, Array]] = []
    normals, score = _HIGH if steep else _LOW, _scores(edges, rays, steep)
    few, many = _some(edges, rays, _COARSE_EDGES), _some(edges, rays, _FINE_EDGES)
    for start in _distinct(normals, score):
        found.append(kernels.climb(start, few, many))
        if found[-1][0] > _CLEAR and not steep:
            break
    found.sort(key=lambda item: -item[0])
    kept: list[tuple[float, Array]] = []
    for item in found:
        if all(item[1][2] @ other[1][2] < math.cos(math.radians(3)) for other in kept):
            kept.append(item)
    return kept[:_STARTS]


def _rays(edges: EdgeSet) -> Array:
    return np.asarray(edges.rays / np.linalg.norm(edges.rays, axis=1, keepdims=True))


def _scores(edges: EdgeSet, rays: Array, steep: bool) -> Array:
    """Coherence of each candidate plane by some of the edges."""
    few = _some(edges, rays, _COARSE_EDGES)
    return np.asarray(np.abs(kernels.coherence(_HIGH if steep else _LOW, few)))


def _some(edges: EdgeSet, rays: Array, most: int) -> kernels.Edges:
    some = np.arange(0, len(rays), max(1, len(rays) // most))
    return kernels.Edges(rays[some], edges.lines[some])


def _distinct(normals: Array, score: Array) -> list[Array]:
    starts: list[Array] = []
    for k in np.argsort(-score):
        if score[k] < _WORTH * score.max():
            break
        if all(normals[k] @ other < math.cos(math.radians(12)) for other in starts):
            starts.append(normals[k])
        if len(starts) == _STARTS:
            break
    return starts
