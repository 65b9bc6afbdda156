"""Which part of a layer a camera sees."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from padstudio.arrays import Array
from padstudio.geometry import projection
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.pad.spec import Layer, Pad

_GRID = 12
# Rays nearer to the horizon than this cosine meet the plane beyond any pad.
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
    column, row = to_lattice(pad, layer, np.array([low[0], high[0]]), np.array([high[1], low[1]]))
    return _span(row, layer.rows), _span(column, layer.cols)


@lru_cache(maxsize=8)
def _rays(camera: Camera) -> Array:
    """Rays (N, 3) spread evenly over a camera's frame."""
    x = np.linspace(-0.5, camera.width - 0.5, _GRID)
    y = np.linspace(-0.5, camera.height - 0.5, _GRID)
    normalized = camera.normalize(np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2))
    return np.column_stack([normalized, np.ones(len(normalized))])


def to_lattice(pad: Pad, layer: Layer, x_mm: Array, y_mm: Array) -> tuple[Array, Array]:
    """Column and row, as fractions, of points of the pad frame."""
    width, height = pad.size_mm
    column = (x_mm + width / 2) / (layer.cell_mm * pad.scale[0])
    row = (height / 2 - y_mm) / (layer.cell_mm * pad.scale[1])
    return column, row


def to_pad(pad: Pad, layer: Layer, coordinates: Array) -> Array:
    """Points (N, 3) of the pad frame, mm, of a layer's lattice coordinates (N, 2): column, row."""
    width, height = pad.size_mm
    x = coordinates[:, 0] * layer.cell_mm * pad.scale[0] - width / 2
    y = height / 2 - coordinates[:, 1] * layer.cell_mm * pad.scale[1]
    return np.column_stack([x, y, np.zeros(len(coordinates))])


def _span(values: Array, count: int) -> tuple[int, int]:
    low, high = math.floor(values[0]) - 1, math.ceil(values[1]) + 1
    return min(max(low, 0), count), min(max(high, 0), count)
