"""Which part of a layer a camera sees."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from padstudio.arrays import Array
from padstudio.geometry import projection
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.pad.layout import lattice_of
from padstudio.pad.spec import Layer, Pad

# Rays a side whose meeting points with the plane bound what is seen; a cell more is added on every
# side for what lies between them.
_GRID = 12
# Rays nearer to the horizon than this cosine meet the plane beyond 50 heights: beyond any pad.
_LEAST_DROP = 0.02


def visible_range(
    pad: Pad, layer: Layer, camera: Camera, pose: Pose
) -> tuple[tuple[int, int], tuple[int, int]]:
    """Rows and columns of a layer that can lie in the frame.

    Returns
    -------
    rows, cols : (first, last + 1)
        Empty ranges where the frame does not meet the layer.
    """
    low, high = projection.ground_seen(
        _rays(camera), np.ascontiguousarray(pose.rotation), pose.position_mm, _LEAST_DROP
    )
    if not low[0] <= high[0]:
        return (0, 0), (0, 0)
    corners = lattice_of(pad, layer, np.array([[low[0], high[1]], [high[0], low[1]]]))
    first, last = corners.tolist()
    return _span(first[1], last[1], layer.rows), _span(first[0], last[0], layer.cols)


@lru_cache(maxsize=8)
def _rays(camera: Camera) -> Array:
    """Rays (N, 3) spread evenly over a camera's frame."""
    x = np.linspace(-0.5, camera.width - 0.5, _GRID)
    y = np.linspace(-0.5, camera.height - 0.5, _GRID)
    normalized = camera.normalize(np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2))
    return np.column_stack([normalized, np.ones(len(normalized))])


def _span(first: float, last: float, count: int) -> tuple[int, int]:
    low, high = math.floor(first) - 1, math.ceil(last) + 1
    return min(max(low, 0), count), min(max(high, 0), count)
