"""Stage `lines`, paper: the two directions of a grid, as vanishing points."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.vision.baseline import families_kernel, lines_kernel
from padstudio.vision.baseline.hough import homogeneous

Flags = NDArray[np.bool_]

# Lines of a family point at its vanishing point within this angle; families differ by the other.
_ALIGNED, _APART = np.radians(1.5), np.radians(35.0)
# So many of the best supported lines propose vanishing points.
_PROPOSERS = 70
_LEAST_LINES = 3


def two_vanishing_points(ends: Array, support: Array) -> tuple[Array, Array] | None:
    """The vanishing points of the two families that hold the most length of line.

    Parameters
    ----------
    ends : (M, 2, 2) float64
        Ends of lines; coordinates of about unit size keep the crossings well conditioned.
    support : (M,) float64
        Length of line.

    Returns
    -------
    pair of (3,) float64, or None
        Homogeneous points; None where the lines fall into fewer than two families.
    """
    first = _vanishing_point(ends, support, np.ones(len(ends), bool))
    if first is None:
        return None
    here = np.average(ends.mean(axis=1), axis=0, weights=support)
    direction = first[:2] - first[2] * here
    along = ends[:, 1] - ends[:, 0]
    apart = _angle(along, np.broadcast_to(direction, along.shape)) > _APART
    second = _vanishing_point(ends, support, apart)
    return None if second is None else (first, second)


def _vanishing_point(ends: Array, support: Array, allowed: Flags) -> Array | None:
    """The point that the most length of line points at, from all pairs of long lines."""
    which = np.flatnonzero(allowed)
    if len(which) < _LEAST_LINES:
        return None
    lines = homogeneous(ends[which])
    # Lines of a family do not cross within the picture: nor may they meet where lines are.
    low, high = ends.reshape(-1, 2).min(axis=0), ends.reshape(-1, 2).max(axis=0)
    points = lines_kernel.crossings(lines[:_PROPOSERS], low, high)
    if not len(points):
        return None
    weight = support[which]
    scores = lines_kernel.pointed_at(points, ends[which], weight, _ALIGNED)
    best = points[int(np.argmax(scores))]
    return families_kernel.settled(best, lines, ends[which], weight, _ALIGNED)


def aligned(point: Array, ends: Array) -> Flags:
    """Which lines point at a vanishing point."""
    return families_kernel.aligned(point, ends, _ALIGNED)


def _angle(a: Array, b: Array) -> Array:
    """Angles (N,) between undirected vectors (N, 2), 0 … π/2."""
    cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return np.asarray(np.arctan2(np.abs(cross), np.abs((a * b).sum(axis=1))))
