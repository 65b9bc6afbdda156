"""What a stage says as data, for pages that draw it themselves: lines, cells, outlines, axes.

All places are frame pixels; (0, 0) is the centre of the frame's first pixel.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.vision.cells.sampling import CellGrid

LineKind = Literal["found", "inserted", "dropped"]
# Of more cells only those are told that differ from the pad: the rest would hide the picture.
_MOST_CELLS = 3000


@dataclass(frozen=True, eq=False)
class Line:
    """A line of a family.

    Attributes
    ----------
    xy : (N, 2) float64
        Along it.
    family : {0, 1} or None
        Lines of constant column, of constant row; None where it belongs to neither.
    kind : {"found", "inserted", "dropped"}
    number : int or None
        Its lattice coordinate.
    text : str
        What it rests on, or why it was dropped.
    """

    xy: Array
    family: int | None
    kind: LineKind
    number: int | None = None
    text: str = ""

    def to_dict(self) -> dict[str, Any]:
        """JSON-serialisable."""
        points = [[round(float(x), 1), round(float(y), 1)] for x, y in self.xy]
        return {
            "points": points, "family": self.family, "kind": self.kind,
            "number": self.number, "text": self.text,
        }  # fmt: skip


@dataclass(eq=False)
class Marks:
    """What is laid over a stage's picture.

    Attributes
    ----------
    lines : list of Line
    cells : list of (x, y, is_wrong)
    cell_px : float
        Side of a cell.
    outlines : list of (N, 2) float64
        Closed.
    points : list of (x, y, counts)
        Measured borders; 0 where one does not count.
    axes : (4, 2) float64 or None
        The pad's origin as shown, and the ends of X, Y, Z.
    """

    lines: list[Line] = field(default_factory=list)
    cells: list[tuple[float, float, int]] = field(default_factory=list)
    cell_px: float = 0.0
    outlines: list[Array] = field(default_factory=list)
    points: list[tuple[float, float, int]] = field(default_factory=list)
    axes: Array | None = None

    def add_cells(self, cells: CellGrid, expected: NDArray[np.int8]) -> None:
        """Read cells against what the pad has there."""
        levels = cells.levels(max(int(expected.max()) + 1, 2))
        shown = cells.seen & (expected >= 0)
        wrong = levels != expected
        if int(shown.sum()) > _MOST_CELLS:
            shown &= wrong
        at = cells.xy[shown]
        self.cells += [
            (round(float(x), 1), round(float(y), 1), int(is_wrong))
            for (x, y), is_wrong in zip(at, wrong[shown], strict=True)
        ]
        self.cell_px = cells.cell_px

    def add_points(self, xy: Array, counts: NDArray[np.bool_]) -> None:
        """Measured borders."""
        self.points += [
            (round(float(x), 1), round(float(y), 1), int(is_counted))
            for (x, y), is_counted in zip(xy, counts, strict=True)
        ]

    def add_axes(self, pose: Pose, camera: Camera, points_mm: Array) -> None:
        """The pad's axes amid some of its points, (N, 3) mm."""
        origin = points_mm.mean(axis=0)
        length = 0.4 * float(np.ptp(points_mm[:, :2], axis=0).min())
        ends = np.vstack([origin, origin + length * np.eye(3)])
        xy = MovingPose(pose).project(camera, ends)
        self.axes = xy if np.isfinite(xy).all() else None

    def to_dict(self) -> dict[str, Any]:
        """JSON-serialisable."""
        return {
            "lines": [line.to_dict() for line in self.lines],
            "cells": self.cells,
            "cell_px": round(self.cell_px, 2),
            "outlines": [np.round(xy, 1).tolist() for xy in self.outlines],
            "points": self.points,
            "axes": None if self.axes is None else np.round(self.axes, 1).tolist(),
        }


Marker = Callable[[Marks, Any, Camera], None]
