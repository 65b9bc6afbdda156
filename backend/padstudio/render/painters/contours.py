"""Outlines of the regions of one colour, for machines that cut along them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray


def iter_contours(mask: NDArray[np.bool_]) -> Iterator[list[tuple[int, int]]]:
    """Closed outlines of the True cells of a grid.

    Cells that share a side are one region; cells that only touch at a corner are apart.

    Parameters
    ----------
    mask : (R, C) bool

    Yields
    ------
    list of (row, col)
        Corners of one outline in lattice coordinates, where it turns, the first not repeated.
        Cells lie to the right of the way: outer outlines run clockwise on the page, holes counter
        to it.
    """
    stride = mask.shape[1] + 1
    sides = _sides(mask)
    starts = np.flatnonzero(sides).tolist()
    leaving = bytearray(sides.tobytes())
    for start in starts:
        while leaving[start]:
            yield [divmod(point, stride) for point in _follow(leaving, start, stride)]


def _sides(mask: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """(R + 1, C + 1) bits: where a side of a region leaves each point: right, down, left, up."""
    padded = np.pad(mask, 1)
    here = padded[1:-1, 1:-1]
    leaving = np.zeros((mask.shape[0] + 1, mask.shape[1] + 1), np.uint8)
    leaving[:-1, :-1] |= (here & ~padded[:-2, 1:-1]).astype(np.uint8)
    leaving[:-1, 1:] |= (here & ~padded[1:-1, 2:]).astype(np.uint8) << 1
    leaving[1:, 1:] |= (here & ~padded[2:, 1:-1]).astype(np.uint8) << 2
    leaving[1:, :-1] |= (here & ~padded[1:-1, :-2]).astype(np.uint8) << 3
    return leaving


def _follow(leaving: bytearray, start: int, stride: int) -> list[int]:
    """Walk one outline from a lattice point and take its sides away."""
    steps = (1, stride, -1, -stride)
    heading = first = (leaving[start] & -leaving[start]).bit_length() - 1
    point = start
    corners = []
    while True:
        leaving[point] &= ~(1 << heading)
        point += steps[heading]
        bits = leaving[point]
        # A right turn first: it keeps to the same cell where two touch at a corner.
        for turn in (1, 0, 3):
            following = (heading + turn) % 4
            if bits >> following & 1:
                break
        else:
            break
        if following != heading:
            corners.append(point)
        heading = following
    if heading != first:
        corners.append(start)
    return corners
