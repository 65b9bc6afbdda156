"""From a pad to rectangles and true corners in millimetres.

One layout serves every painter (raster, SVG, PDF, …): a painter only paints it. Page coordinates
have their origin at the top left of the sheet with its quiet margin, x to the right, y down, mm.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.pad.spec import Channel, Layer, Pad


@dataclass(frozen=True, eq=False)
class Layout:
    """A pad's geometry at its nominal size.

    Attributes
    ----------
    page_width_mm, page_height_mm : float
        The sheet, quiet margin included.
    x_mm : (C + 1,) float64
        Column edges of the finest common grid of all layers, page coordinates.
    y_mm : (R + 1,) float64
        Row edges of the same.
    colors : (R, C, 3) uint8
        Nominal RGB of each patch of that grid; 255 is full ink of light, 0 none.
    """

    page_width_mm: float
    page_height_mm: float
    x_mm: Array
    y_mm: Array
    colors: NDArray[np.uint8]


def layout(pad: Pad) -> Layout:
    """Lay a pad out at its nominal size.

    Where a layer ends short of the pad's corner, its channel is dark; a channel without a layer is
    dark all over. The quiet margin is white.
    """
    x = _edges([layer.cell_mm * np.arange(layer.cols + 1.0) for layer in pad.layers])
    y = _edges([layer.cell_mm * np.arange(layer.rows + 1.0) for layer in pad.layers])
    colors = np.zeros((len(y) - 1, len(x) - 1, 3), np.uint8)
    middle_x, middle_y = (x[:-1] + x[1:]) / 2, (y[:-1] + y[1:]) / 2
    for layer in pad.layers:
        col, row = (middle_x / layer.cell_mm).astype(int), (middle_y / layer.cell_mm).astype(int)
        inside = np.ix_(row < layer.rows, col < layer.cols)
        values = level_values(pad.levels)[layer.field]
        plane = colors[:, :, "rgb".index(layer.channel[0])]
        plane[inside] = values[np.ix_(row[row < layer.rows], col[col < layer.cols])]
    quiet = pad.quiet_mm
    return Layout(
        page_width_mm=pad.width_mm + 2 * quiet,
        page_height_mm=pad.height_mm + 2 * quiet,
        x_mm=x + quiet,
        y_mm=y + quiet,
        colors=colors,
    )


def crop(page: Layout, x0: float, y0: float, x1: float, y1: float) -> Layout:
    """The part of a layout inside a box; page coordinates, mm, stay as they are.

    Where the box holds nothing but quiet margin, `colors` is empty.
    """
    col, x_mm = _crop_edges(page.x_mm, x0, x1)
    row, y_mm = _crop_edges(page.y_mm, y0, y1)
    return Layout(page.page_width_mm, page.page_height_mm, x_mm, y_mm, page.colors[row, col])


def level_values(levels: int) -> NDArray[np.uint8]:
    """(Y,) uint8, the channel value of each level: 0 dark … 255 full, evenly spaced."""
    return np.round(np.linspace(0, 255, levels)).astype(np.uint8)


def corners_mm(pad: Pad, channel: Channel) -> Array:
    """True positions of a layer's cell corners in the pad frame, at the measured size.

    Returns
    -------
    (rows + 1, cols + 1, 3) float64
        Pad frame (origin at the pad's centre, Y up), mm.
    """
    layer = pad.layer(channel)
    if layer is None:
        raise KeyError(channel)
    grid = np.meshgrid(np.arange(layer.cols + 1.0), np.arange(layer.rows + 1.0))
    return lattice_mm(pad, layer, np.stack(grid, axis=-1))


def lattice_mm(pad: Pad, layer: Layer, coordinates: Array) -> Array:
    """Pad-frame positions (…, 3), mm, of a layer's lattice coordinates (…, 2): column, row.

    Cells lie between whole numbers; the pad has its measured size.
    """
    points = np.zeros((*coordinates.shape[:-1], 3))
    points[..., 0] = (coordinates[..., 0] * layer.cell_mm - pad.width_mm / 2) * pad.scale[0]
    points[..., 1] = (pad.height_mm / 2 - coordinates[..., 1] * layer.cell_mm) * pad.scale[1]
    return points


def lattice_of(pad: Pad, layer: Layer, points_mm: Array) -> Array:
    """The inverse of `lattice_mm`: coordinates (…, 2) of points of the pad's plane."""
    column = (points_mm[..., 0] / pad.scale[0] + pad.width_mm / 2) / layer.cell_mm
    row = (pad.height_mm / 2 - points_mm[..., 1] / pad.scale[1]) / layer.cell_mm
    return np.stack([column, row], axis=-1)


def outline_mm(pad: Pad) -> Array:
    """(4, 3) float64: the pad's corners, top left first, clockwise on the page, pad frame, mm."""
    w, h = pad.size_mm
    return np.array([[-w, h, 0], [w, h, 0], [w, -h, 0], [-w, -h, 0]]) / 2.0


def _crop_edges(edges: Array, start: float, end: float) -> tuple[slice, Array]:
    """The patches that reach into start … end, and their edges, clipped to it."""
    first = max(int(np.searchsorted(edges, start + 1e-6)) - 1, 0)
    last = min(int(np.searchsorted(edges, end - 1e-6)), len(edges) - 1)
    if last <= first:
        return slice(0, 0), np.array([start])
    return slice(first, last), np.clip(edges[first : last + 1], start, end)


def _edges(grids: list[Array]) -> Array:
    """Sorted union of edge positions; those nearer than a micrometre count as one."""
    values = np.unique(np.concatenate(grids))
    keep = [values[0]]
    for previous, value in pairwise(values):
        if value - previous > 1e-3:
            keep.append(value)
    return np.array(keep)
