"""Reads the level of every visible cell of a lattice: the picture's half of the `decode` stage."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.pad.spec import Channel
from padstudio.vision.planes import Pyramid
from padstudio.vision.types import Array

#: Lattice coordinates (N, 2) to frame pixels (N, 2); NaN behind the camera.
ToPixels = Callable[[Array], Array]

# Cells are read at the level where they are at least this wide, pixels.
_READING_WIDTH = 3.0
# Under tilt cells narrower than this are left to the horizon, where enough others are wider.
_LEAST_WIDTH, _ENOUGH = 2.0, 60
# Where a cell is read whose centre is out of view: toward a side, then toward a corner, but not so
# far that its neighbour shows at the scale that cells are read at.
_OFF_CENTRE = 0.2 * np.array(
    [[1, 0], [-1, 0], [0, 1], [0, -1], [1, 1], [1, -1], [-1, 1], [-1, -1]], float
)
# Brightness is compared with that of a block of this many cells a side.
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
        return np.where(self.seen, to_levels(self.relative, count), -1).astype(np.int8)


def to_levels(relative: NDArray[np.float32], count: int) -> NDArray[np.int8]:
    """Levels of block-relative values, for levels that occur equally often.

    Evenly spaced, equally frequent levels 0 … Y−1 have mean (Y−1)/2 and variance (Y²−1)/12.
    """
    spread = math.sqrt((count * count - 1) / 12)
    return np.clip(np.round(relative * spread + (count - 1) / 2), 0, count - 1).astype(np.int8)


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
    from padstudio.vision import kernels_cells

    c, r = np.arange(*columns) + 0.5, np.arange(*rows) + 0.5
    if not len(c) or not len(r):
        return None
    grid = np.stack(np.meshgrid(c, r), axis=-1)
    xy = to_pixels(grid.reshape(-1, 2)).reshape(*grid.shape)
    seen = _within(pyramid, xy)
    if not seen.any():
        return None
    _reach_in(pyramid, to_pixels, grid, xy, seen)
    kernels_cells.leave_out_small(xy, seen, _LEAST_WIDTH, _ENOUGH)
    width = kernels_cells.width_px(xy, seen)
    level = max(0, math.floor(math.log2(max(width / _READING_WIDTH, 1.0))))
    plane = pyramid.window(channel, level)
    values = kernels_cells.sample(plane.values, xy, seen, plane.place)
    relative = _relative(values, seen)
    return CellGrid(channel, columns[0], rows[0], values, seen, relative, xy, width)


def _within(pyramid: Pyramid, xy: Array) -> NDArray[np.bool_]:
    """Which pixels (…, 2) lie in the frame; none that are NaN do."""
    with np.errstate(invalid="ignore"):
        return np.asarray(
            (xy[..., 0] >= 0)
            & (xy[..., 1] >= 0)
            & (xy[..., 0] <= pyramid.width - 1)
            & (xy[..., 1] <= pyramid.height - 1)
        )


def _reach_in(
    pyramid: Pyramid, to_pixels: ToPixels, grid: Array, xy: Array, seen: NDArray[np.bool_]
) -> None:
    """Read cells cut by the frame's edge off their centre, where a part of them is in view.

    Changes ``xy`` and ``seen``. Close to the ground such cells are a third of all.
    """
    edge = cv2.dilate(seen.astype(np.uint8), np.ones((3, 3), np.uint8)).astype(bool) & ~seen
    if not edge.any():
        return
    rows, cols = np.nonzero(edge)
    tried = (grid[rows, cols][:, None] + _OFF_CENTRE).reshape(-1, 2)
    at = to_pixels(tried).reshape(len(rows), len(_OFF_CENTRE), 2)
    here = _within(pyramid, at)
    first = here.argmax(axis=1)
    found = here.any(axis=1)
    xy[rows[found], cols[found]] = at[found, first[found]]
    seen[rows[found], cols[found]] = True


def _relative(values: NDArray[np.float32], seen: NDArray[np.bool_]) -> NDArray[np.float32]:
    """Block mean: each value against the mean and deviation of the block of cells round it."""
    weight = seen.astype(np.float32)
    filled = np.where(seen, values, 0).astype(np.float32)
    size = (_BLOCK, _BLOCK)
    count = cv2.boxFilter(weight, -1, size, normalize=False, borderType=cv2.BORDER_CONSTANT)
    total = cv2.boxFilter(filled, -1, size, normalize=False, borderType=cv2.BORDER_CONSTANT)
    square = cv2.boxFilter(
        filled * filled, -1, size, normalize=False, borderType=cv2.BORDER_CONSTANT
    )
    count = np.maximum(count, 1)
    mean = total / count
    deviation = np.sqrt(np.maximum(square / count - mean * mean, 0.25))
    return np.where(seen, (filled - mean) / deviation, 0).astype(np.float32)


def relative_field(field: NDArray[np.uint8]) -> NDArray[np.float32]:
    """A pad's field (R, C) seen as `CellGrid.relative` would show it."""
    return _relative(field.astype(np.float32) * 64, np.ones(field.shape, bool))
