"""Reads the level of every visible cell of a lattice: the picture's half of the `decode` stage."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.pad.spec import Channel
from padstudio.vision.cells import cells_kernel
from padstudio.vision.frame.pyramid import Pyramid

#: Lattice coordinates (N, 2) to frame pixels (N, 2); NaN behind the camera.
ToPixels = Callable[[Array], Array]

# Cells are read at the level where they are at least this wide, pixels. At 1.5 neighbours show
# through, and one still of the score is lost; 6 finds the same stills.
_READING_WIDTH = 3.0
# Pixels a side that a level must have, to be looked at between pixels.
_LEAST_SIDE = 4
# From so many cells on only each of so many is projected, along rows and columns: projecting all
# would cost more than reading them.
_MANY, _EVERY = 2000, 4
# Brightness is compared with that of a block of this many cells a side: about twice a window's, so
# that each level occurs, and few enough that light is even. 5 and 17 find the same stills of the
# score.
_BLOCK = 9


@dataclass(frozen=True, eq=False)
class CellGrid:
    """Cells of a part of a lattice as read from one channel.

    Attributes
    ----------
    channel : {"red", "green", "blue"}
    column0, row0 : int
        Lattice coordinates of the first cell's top-left corner.
    values : (R, C) float32
        Grey value at each cell's centre, averaged over a third of a cell or so.
    seen : (R, C) bool
        True where a good part of the cell lies in the frame, and is not far smaller than others.
    relative : (R, C) float32
        Values less their block's mean over their block's deviation; 0 where not seen.
    xy : (R, C, 2) float64
        Where the cells were read, their centres mostly, frame pixels.
    cell_px : float
        Median side of a cell, frame pixels.
    """

    channel: Channel
    column0: int
    row0: int
    values: NDArray[np.float32]
    seen: NDArray[np.bool_]
    relative: NDArray[np.float32]
    xy: Array
    cell_px: float

    def levels(self, count: int) -> NDArray[np.int8]:
        """Levels 0 … count−1 as the picture alone tells them, −1 where not seen; (R, C)."""
        return cells_kernel.to_levels(np.ascontiguousarray(self.relative), self.seen, count)


def read_cells(
    pyramid: Pyramid,
    channel: Channel,
    to_pixels: ToPixels,
    columns: tuple[int, int],
    rows: tuple[int, int],
) -> CellGrid | None:
    """Read the cells between two columns and two rows of a lattice.

    Parameters
    ----------
    pyramid : Pyramid
    channel : {"red", "green", "blue"}
    to_pixels : callable
    columns, rows : (first, last)
        Lattice coordinates of the outer corners.

    Returns
    -------
    CellGrid or None
        None where no cell's centre lies in the frame.
    """
    shape = (rows[1] - rows[0], columns[1] - columns[0])
    if min(shape) <= 0:
        return None
    # Between a few of many cells the picture of a plane bends by a small part of a cell.
    every = 1 if shape[0] * shape[1] < _MANY else _EVERY
    c, r = (np.arange(0, count + every - 1, every) + 0.5 for count in (shape[1], shape[0]))
    nodes = np.stack(np.meshgrid(columns[0] + c, rows[0] + r), axis=-1)
    nodes = to_pixels(nodes.reshape(-1, 2)).reshape(nodes.shape)
    xy, seen, width = cells_kernel.locate(nodes, every, shape, (pyramid.width, pyramid.height))
    if not seen.any():
        return None
    # A cell as wide as the frame is read at a scale that still has pixels to look between.
    widest = min(width, min(pyramid.width, pyramid.height) * _READING_WIDTH / _LEAST_SIDE)
    level = math.floor(math.log2(max(widest / _READING_WIDTH, 1.0)))
    values = cells_kernel.sample(pyramid.window(channel, level), xy, seen)
    relative = cells_kernel.relative(values, seen, _BLOCK)
    return CellGrid(channel, columns[0], rows[0], values, seen, relative, xy, width)


def relative_field(field: NDArray[np.uint8]) -> NDArray[np.float32]:
    """A pad's field (R, C) seen as `CellGrid.relative` would show it."""
    values = field.astype(np.float32) * 64
    return cells_kernel.relative(values, np.ones(field.shape, bool), _BLOCK)
