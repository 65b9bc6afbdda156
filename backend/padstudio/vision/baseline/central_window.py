"""Stage `grid`, paper: the central window of the lines."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from padstudio.arrays import Array
from padstudio.geometry.rolling_shutter import cross
from padstudio.vision.baseline.line_grid import Family, LineGrid
from padstudio.vision.frame.pyramid import Plane
from padstudio.vision.stage.trace import Reason, StageFailure

# Windows that are looked at together, the nearest first: one by one takes longer.
_AT_ONCE = 16


@dataclass(frozen=True, eq=False)
class CentralWindow:
    """The b × b cells round the middle of the lines.

    Attributes
    ----------
    grid : LineGrid
    column, row : int
        Lattice coordinates of its top-left corner.
    size : int
        b.
    centre_xy : (2,) float64
        The centre point of the crossings of the middle lines, frame pixels.
    corners_xy : (4, 2) float64
        Crossings of the four lines round it, frame pixels; top left first, clockwise.
    area_px : float
        Area of the window, frame pixels.
    """

    grid: LineGrid
    column: int
    row: int
    size: int
    centre_xy: Array
    corners_xy: Array
    area_px: float

    @property
    def plane(self) -> Plane:
        """What the lines were found in."""
        return self.grid.found.edges.plane

    @property
    def corners(self) -> Array:
        """(4, 2) float64, lattice coordinates (column, row) of the corners."""
        square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)
        return np.asarray(np.array([self.column, self.row]) + self.size * square, float)

    @property
    def cell_px(self) -> float:
        """Mean side of a cell of the window, frame pixels."""
        return float(np.sqrt(self.area_px)) / self.size

    def to_pixels(self, coordinates: Array) -> Array:
        """Frame pixels (N, 2) of lattice coordinates (N, 2); NaN beyond the horizon."""
        local = _plane_pixels(self.grid, coordinates)
        return self.plane.to_frame(self.grid.found.edges.bend(local))


def central_window(grid: LineGrid, size: int) -> CentralWindow | StageFailure:
    """Choose the middle lines, their centre point, and the four lines round the central window.

    Of an even number of lines the middle two count, of an odd number the middle one; the centre
    point is the mean of the crossings of both families' middle lines. Where the window cannot be
    symmetric about it (an odd number of lines and an odd b), the window lies half a cell to its
    left or above. A line that only cuts a corner of the picture counts like any other, so that the
    middle can lie at the rim: then the nearest window is taken that lies in view.

    Parameters
    ----------
    grid : LineGrid
    size : int
        b, the side of a window in cells.
    """
    families = (grid.columns, grid.rows)
    counts = [len(family.lines) for family in families]
    if min(counts) < size + 1:
        return StageFailure(
            "grid",
            Reason.CELLS_TOO_LARGE,
            f"{counts[0]} x {counts[1]} lines in {grid.found.edges.plane.channel} hold no window "
            f"of {size} x {size} cells, which has {size + 1} x {size + 1}",
            "fly higher, or print smaller cells",
        )
    starts = _in_view(grid, size, (counts[0] - size - 1) // 2, (counts[1] - size - 1) // 2)
    edges = grid.found.edges
    plane = edges.plane
    centre = np.mean([_cross(u, v) for u in _middle(families[0]) for v in _middle(families[1])], 0)
    left, right = (families[0].lines[starts[0] + k] for k in (0, size))
    top, bottom = (families[1].lines[starts[1] + k] for k in (0, size))
    round_it = ((left, top), (right, top), (right, bottom), (left, bottom))
    corners = plane.to_frame(edges.bend(np.array([_cross(u, v) for u, v in round_it])))
    return CentralWindow(
        grid=grid,
        column=grid.columns.first + starts[0],
        row=grid.rows.first + starts[1],
        size=size,
        centre_xy=plane.to_frame(edges.bend(centre[None]))[0],
        corners_xy=corners,
        area_px=float(cv2.contourArea(corners.astype(np.float32))),
    )


def _in_view(grid: LineGrid, size: int, column: int, row: int) -> tuple[int, int]:
    """The window nearest to a first choice whose corner cells' centres lie in the frame."""
    spans = [len(family.lines) - size for family in (grid.columns, grid.rows)]
    starts = np.stack(np.meshgrid(*(np.arange(span) for span in spans), indexing="ij"), axis=-1)
    starts = starts.reshape(-1, 2)
    order = np.argsort(np.abs(starts - (column, row)).sum(axis=1), kind="stable")
    first = np.array([grid.columns.first, grid.rows.first])
    centres = np.array([(c, r) for c in (0.5, size - 0.5) for r in (0.5, size - 0.5)])
    camera = grid.found.edges.camera
    limit = np.array([camera.width, camera.height]) - 1
    for begin in range(0, len(order), _AT_ONCE):
        some = starts[order[begin : begin + _AT_ONCE]]
        at = _plane_pixels(grid, (first + some[:, None] + centres).reshape(-1, 2))
        pixels = grid.found.edges.plane.to_frame(grid.found.edges.bend(at))
        inside = ((pixels >= 0) & (pixels <= limit)).reshape(len(some), -1).all(axis=1)
        if inside.any():
            nearest = some[int(np.argmax(inside))]
            return int(nearest[0]), int(nearest[1])
    return column, row


def _plane_pixels(grid: LineGrid, coordinates: Array) -> Array:
    """Undistorted plane pixels (N, 2) of lattice coordinates (N, 2); NaN beyond the horizon."""
    plane_from_lattice = np.linalg.inv(grid.lattice_from_plane)
    middle = np.array(
        [(family.first + family.last) / 2 for family in (grid.columns, grid.rows)] + [1.0]
    )
    h = np.column_stack([coordinates, np.ones(len(coordinates))]) @ plane_from_lattice.T
    ahead = h[:, 2] * (plane_from_lattice[2] @ middle) > 0
    local = np.full((len(h), 2), np.nan)
    local[ahead] = h[ahead, :2] / h[ahead, 2:]
    return local


def _middle(family: Family) -> Array:
    count = len(family.lines)
    return family.lines[(count - 1) // 2 : count // 2 + 1]


def _cross(a: Array, b: Array) -> Array:
    point = cross(a, b)
    return np.asarray(point[:2] / point[2], float)
