"""Reads the level of every visible cell of a lattice: the picture's half of the `decode` stage."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.pad.spec import Channel
from padstudio.vision.cells import cells_kernel, levels_kernel
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
#: Brightness is compared with that of a block of this many cells a side: about twice a window's, so
# that each level occurs, and few enough that light is even. 5 and 17 find the same stills of the
# score.
BLOCK = 9
# Squares of so many cells a side that span less than this part of what is usual, the upper tenth
# of so many of them, show no code: 25 cells of one level are rarer than glare and things on a pad.
_ALIKE_SIDE, _FLAT, _USUAL, _TELLING = 5, 0.1, 0.9, 400


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
        relative = np.ascontiguousarray(self.relative)
        cuts = levels_kernel.cuts(relative, self.seen, count, BLOCK)
        return levels_kernel.to_levels(relative, self.seen, cuts)

    def thresholds(self, count: int) -> NDArray[np.float32]:
        """Grey values (R, C, count−1) at which `levels` goes from one level to the next."""
        relative = np.ascontiguousarray(self.relative)
        cuts = levels_kernel.cuts(relative, self.seen, count, BLOCK)
        mean, deviation = cells_kernel.moments(self.values, self.seen, BLOCK)
        return np.asarray(mean[..., None] + deviation[..., None] * cuts, np.float32)


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
    nodes = np.empty((len(r), len(c), 2))
    nodes[..., 0], nodes[..., 1] = columns[0] + c, (rows[0] + r)[:, None]
    nodes = to_pixels(nodes.reshape(-1, 2)).reshape(nodes.shape)
    xy, seen, width = cells_kernel.locate(nodes, every, shape, (pyramid.width, pyramid.height))
    if not seen.any():
        return None
    values = cells_kernel.sample(pyramid.window(channel, _level(pyramid, width)), xy, seen)
    seen = with_contrast(values, seen)
    if not seen.any():
        return None
    relative = cells_kernel.relative(values, seen, BLOCK)
    return CellGrid(channel, columns[0], rows[0], values, seen, relative, xy, width)


def read_again(pyramid: Pyramid, channel: Channel, cells: CellGrid) -> NDArray[np.float32]:
    """What another channel has where cells were read: grey values (R, C), 0 where not seen."""
    window = pyramid.window(channel, _level(pyramid, cells.cell_px))
    return cells_kernel.sample(window, cells.xy, cells.seen)


def _level(pyramid: Pyramid, width_px: float) -> int:
    """The level at which cells so wide are read."""
    # A cell as wide as the frame is read at a scale that still has pixels to look between.
    widest = min(width_px, min(pyramid.width, pyramid.height) * _READING_WIDTH / _LEAST_SIDE)
    return math.floor(math.log2(max(widest / _READING_WIDTH, 1.0)))


def with_contrast(values: NDArray[np.float32], seen: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which of the cells (R, C) seen differ from those about them, as coded cells do.

    Where glare burns the picture out or something lies on the pad, all look alike.
    """
    square = np.ones((_ALIKE_SIDE, _ALIKE_SIDE), np.uint8)
    most = cv2.dilate(np.where(seen, values, np.float32(0)), square)
    span = most + cv2.dilate(np.where(seen, np.float32(255) - values, np.float32(0)), square)
    usual = np.sort(span[seen][:: max(1, int(seen.sum()) // _TELLING)])
    least = _FLAT * (usual[int(_USUAL * len(usual))] - 255)
    return np.asarray(seen & (span - 255 > least))


def relative_field(field: NDArray[np.uint8]) -> NDArray[np.float32]:
    """A pad's field (R, C) seen as `CellGrid.relative` would show it."""
    values = field.astype(np.float32) * 64
    return cells_kernel.relative(values, np.ones(field.shape, bool), BLOCK)
