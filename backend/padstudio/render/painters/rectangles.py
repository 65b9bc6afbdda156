"""Rectangles of one colour that paint a layout, and what hides the seams between them.

Anti-aliasing viewers let the ground show through the seam of two abutting rectangles. Therefore
colours are ranked and painted in that order, and a thin lozenge lies along every seam between two
cells above the base, in the lower of their two ranks: the lower cell (or both, of one rank) then
reaches under the seam, and the edge is drawn by the higher cell alone. A lozenge comes to a point
at its ends, so that it stays hidden wherever three or four colours meet.

The darkest colour is painted once, under everything, but stays clear of the layout's sides: there
each cell ends in its own colour.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.pad.layout import Layout

Ranks = NDArray[np.int32]


@dataclass(frozen=True, eq=False)
class Shapes:
    """What to paint in one colour.

    Attributes
    ----------
    color : (r, g, b)
        8-bit RGB.
    boxes_mm : (N, 4) float64
        x0, y0, x1, y1 of each rectangle, page coordinates (y down).
    wide_mm, tall_mm : (M, 4) float64
        Boxes round the lozenges that lie along the page's x and y.
    """

    color: tuple[int, int, int]
    boxes_mm: Array
    wide_mm: Array
    tall_mm: Array


def iter_shapes(layout: Layout, *, seams: bool = True) -> Iterator[Shapes]:
    """What to paint, colour by colour, lowest first.

    The first begins with the base, the rectangle under everything.

    Parameters
    ----------
    layout : Layout
    seams : bool
        Whether to hide seams; painters without anti-aliasing need not.
    """
    if not layout.colors.size:
        return
    palette, order = _ranks(layout.colors)
    x, y = layout.x_mm, layout.y_mm
    reach = min(np.diff(x).min(), np.diff(y).min()) / 4
    row, first, last, rank = _runs(order, outer_rows=True)
    boxes = _Sorted(rank, np.stack([x[first], y[row], x[last], y[row + 1]], axis=1))
    wide = tall = _Sorted(np.zeros(0, np.int32), np.zeros((0, 4)))
    if seams:
        row, first, last, rank = _runs(np.minimum(order[:-1], order[1:]))
        at = y[row + 1]
        wide = _Sorted(rank, np.stack([x[first], at - reach, x[last], at + reach], axis=1))
        lower = np.minimum(order[:, :-1], order[:, 1:])
        # Equal neighbours in a row are one rectangle: no seam.
        lower[order[:, :-1] == order[:, 1:]] = -1
        col, first, last, rank = _runs(np.ascontiguousarray(lower.T))
        at = x[col + 1]
        tall = _Sorted(rank, np.stack([at - reach, y[first], at + reach, y[last]], axis=1))
    base_box = np.array([[x[0] + reach, y[0] + reach, x[-1] - reach, y[-1] - reach]])
    for number, (red, green, blue) in enumerate(palette.tolist()):
        base = [base_box] if number == 0 else []
        yield Shapes(
            color=(red, green, blue),
            boxes_mm=np.concatenate([*base, boxes[number]]),
            wide_mm=wide[number],
            tall_mm=tall[number],
        )


class _Sorted:
    """Boxes that are found by their rank."""

    def __init__(self, rank: Ranks, boxes: Array) -> None:
        place = np.argsort(rank, kind="stable")
        self._rank, self._boxes = rank[place], boxes[place]

    def __getitem__(self, rank: int) -> Array:
        start, end = np.searchsorted(self._rank, [rank, rank + 1])
        return self._boxes[start:end]


def _ranks(colors: NDArray[np.uint8]) -> tuple[NDArray[np.int64], Ranks]:
    """The palette (K, 3), dark first, and each patch's place (R, C) in it."""
    packed = colors.astype(np.int64) @ np.array([1 << 8, 1 << 16, 1])
    values, order = np.unique(packed, return_inverse=True)
    palette = (values[:, None] >> np.array([8, 16, 0])) & 255
    return palette, order.reshape(packed.shape).astype(np.int32)


def _runs(
    order: Ranks, *, outer_rows: bool = False
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp], Ranks]:
    """Runs of equal rank along each row: row, first column, column after, rank.

    Those of rank 0 only where they reach an end of their row, or in an outer row where asked for:
    the base is under all others. Those below 0 not at all.
    """
    rows, cols = order.shape
    change = np.ones((rows, cols + 1), bool)
    change[:, 1:-1] = order[:, 1:] != order[:, :-1]
    row, first = np.nonzero(change[:, :-1])
    last = np.nonzero(change[:, 1:])[1] + 1
    rank = order[row, first]
    outer = (first == 0) | (last == cols)
    if outer_rows:
        outer |= (row == 0) | (row == rows - 1)
    keep = (rank > 0) | (outer & (rank == 0))
    return row[keep], first[keep], last[keep], rank[keep]
