"""Compiled loops of `hough`, `vanishing_points` and `line_grid`, which say what they compute."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import jit
from padstudio.vision.baseline.tiles_kernel import beside, tiled

# So few edge points fit no line.
_LEAST_POINTS = 8


@jit
def merge(pieces: Array, order: NDArray[np.intp], near: float) -> NDArray[np.intp]:
    """Groups of pieces (N, 2, 2) that lie on one line, by number, in the order of their first.

    A piece gathers all free ones beside its own line, and then those beside the line through these.
    """
    group = np.full(len(pieces), -1, np.intp)
    count = 0
    for k in order:
        if group[k] >= 0:
            continue
        _gather(group, pieces, count, _of_piece(pieces, k), near)
        group[k] = count
        _gather(group, pieces, count, _through_group(pieces, group, count), near)
        count += 1
    return group


@jit
def _gather(
    group: NDArray[np.intp],
    pieces: Array,
    count: int,
    line: tuple[float, float, float],
    near: float,
) -> None:
    """Give free pieces with both ends beside a line its group's number."""
    nx, ny, c = line
    for i in range(len(pieces)):
        if group[i] < 0:
            first = abs(pieces[i, 0, 0] * nx + pieces[i, 0, 1] * ny + c)
            last = abs(pieces[i, 1, 0] * nx + pieces[i, 1, 1] * ny + c)
            if first < near and last < near:
                group[i] = count


@jit
def _of_piece(pieces: Array, k: int) -> tuple[float, float, float]:
    """The line through a piece's two ends."""
    dx, dy = pieces[k, 1, 0] - pieces[k, 0, 0], pieces[k, 1, 1] - pieces[k, 0, 1]
    length = max(math.hypot(dx, dy), 1e-12)
    nx, ny = -dy / length, dx / length
    return nx, ny, -(nx * pieces[k, 0, 0] + ny * pieces[k, 0, 1])


@jit
def lines_through(pieces: Array) -> Array:
    """Lines (N, 3) through the ends of pieces (N, 2, 2): unit normals and offsets."""
    lines = np.empty((len(pieces), 3))
    for k in range(len(pieces)):
        lines[k, 0], lines[k, 1], lines[k, 2] = _of_piece(pieces, k)
    return lines


@jit
def _fitted(mx: float, my: float, xx: float, xy: float, yy: float) -> tuple[float, float, float]:
    """The line of total least squares, by sums about its points' mean."""
    angle = 0.5 * math.atan2(2 * xy, xx - yy)
    nx, ny = -math.sin(angle), math.cos(angle)
    return nx, ny, -(nx * mx + ny * my)


@jit
def _through_group(
    pieces: Array, group: NDArray[np.intp], number: int
) -> tuple[float, float, float]:
    """The line through the ends of a group's pieces."""
    count, mx, my = 0, 0.0, 0.0
    for i in range(len(pieces)):
        if group[i] == number:
            count += 2
            mx += pieces[i, 0, 0] + pieces[i, 1, 0]
            my += pieces[i, 0, 1] + pieces[i, 1, 1]
    mx, my = mx / count, my / count
    xx = xy = yy = 0.0
    for i in range(len(pieces)):
        if group[i] == number:
            for end in range(2):
                x, y = pieces[i, end, 0] - mx, pieces[i, end, 1] - my
                xx, xy, yy = xx + x * x, xy + x * y, yy + y * y
    return _fitted(mx, my, xx, xy, yy)


@jit
def join(pieces: Array, group: NDArray[np.intp]) -> tuple[Array, Array]:
    """Ends (M, 2, 2) of the lines through groups of pieces, and the length that they cover (M,)."""
    count = group.max() + 1
    ends, support = np.empty((count, 2, 2)), np.empty(count)
    for number in range(count):
        nx, ny, c = _through_group(pieces, group, number)
        members = np.flatnonzero(group == number)
        low, high = np.empty(len(members)), np.empty(len(members))
        for m, i in enumerate(members):
            first = pieces[i, 0, 1] * nx - pieces[i, 0, 0] * ny
            last = pieces[i, 1, 1] * nx - pieces[i, 1, 0] * ny
            low[m], high[m] = min(first, last), max(first, last)
        length, reach = 0.0, -np.inf
        for m in np.argsort(low):
            length += max(0.0, high[m] - max(low[m], reach))
            reach = max(reach, high[m])
        support[number] = length
        for end, at in enumerate((low.min(), reach)):
            ends[number, end, 0] = -c * nx - at * ny
            ends[number, end, 1] = -c * ny + at * nx
    return ends, support


@jit
def sharpen(ends: Array, points: Array, near: float) -> Array:
    """Lines (M, 2, 2) fitted to the edge points (P, 2) beside them, twice."""
    sharp = ends.copy()
    tiles = tiled(points, ends, 2 * near)
    close, fitting = np.empty(len(points), np.intp), np.empty(len(points), np.intp)
    for k in range(len(ends)):
        nx, ny, c = _of_piece(ends, k)
        ax, ay = -ny, nx
        first, last = (
            ends[k, 0, 0] * ax + ends[k, 0, 1] * ay,
            ends[k, 1, 0] * ax + ends[k, 1, 1] * ay,
        )
        low, high = min(first, last) - 1, max(first, last) + 1
        # The second line may leave the first by as much as its points do.
        most = beside(tiles, ends[k], 2 * near, close)
        for _ in range(2):
            count, mx, my = 0, 0.0, 0.0
            for p in close[:most]:
                x, y = points[p, 0], points[p, 1]
                if abs(x * nx + y * ny + c) < near and low <= x * ax + y * ay <= high:
                    fitting[count] = p
                    count, mx, my = count + 1, mx + x, my + y
            if count < _LEAST_POINTS:
                break
            mx, my = mx / count, my / count
            xx = xy = yy = 0.0
            for p in fitting[:count]:
                x, y = points[p, 0] - mx, points[p, 1] - my
                xx, xy, yy = xx + x * x, xy + x * y, yy + y * y
            nx, ny, c = _fitted(mx, my, xx, xy, yy)
        for end in range(2):
            foot = ends[k, end, 0] * nx + ends[k, end, 1] * ny + c
            sharp[k, end, 0] = ends[k, end, 0] - foot * nx
            sharp[k, end, 1] = ends[k, end, 1] - foot * ny
    return sharp


@jit
def uncrossed(ends: Array, family: NDArray[np.bool_], support: Array) -> NDArray[np.bool_]:
    """Which lines (M, 2, 2) of a family cross no better supported one within their own length.

    Lines that were found to cross one count no more for those that come before them.
    """
    keep = family.copy()
    for k in range(len(ends) - 1, -1, -1):
        if not family[k]:
            continue
        nx, ny, c = _of_piece(ends, k)
        for other in range(len(ends)):
            if not keep[other] or support[other] <= support[k]:
                continue
            mx, my, d = _of_piece(ends, other)
            first = ends[k, 0, 0] * mx + ends[k, 0, 1] * my + d
            last = ends[k, 1, 0] * mx + ends[k, 1, 1] * my + d
            start = ends[other, 0, 0] * nx + ends[other, 0, 1] * ny + c
            stop = ends[other, 1, 0] * nx + ends[other, 1, 1] * ny + c
            if first * last < 0 and start * stop < 0:
                keep[k] = False
                break
    return keep


@jit
def crossings(lines: Array, low: Array, high: Array) -> Array:
    """Where pairs of lines (M, 3) meet, outside a box: homogeneous points (N, 3) of length 1."""
    points, count = np.empty((len(lines) * (len(lines) - 1) // 2, 3)), 0
    for i in range(len(lines)):
        for j in range(i + 1, len(lines)):
            a, b = lines[i], lines[j]
            x, y = a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2]
            w = a[0] * b[1] - a[1] * b[0]
            size = math.sqrt(x * x + y * y + w * w)
            if size <= 1e-9:
                continue
            if w != 0 and low[0] < x / w < high[0] and low[1] < y / w < high[1]:
                continue
            points[count, 0], points[count, 1], points[count, 2] = x / size, y / size, w / size
            count += 1
    return points[:count].copy()


@jit
def pointed_at(points: Array, ends: Array, weight: Array, aligned_rad: float) -> Array:
    """The weight (N,) of the lines (M, 2, 2) that point at each of some points (N, 3)."""
    out = np.zeros(len(points))
    steepest = math.tan(aligned_rad)
    for p in range(len(points)):
        for k in range(len(ends)):
            ax, ay = ends[k, 1, 0] - ends[k, 0, 0], ends[k, 1, 1] - ends[k, 0, 1]
            mx, my = (ends[k, 0, 0] + ends[k, 1, 0]) / 2, (ends[k, 0, 1] + ends[k, 1, 1]) / 2
            tx, ty = points[p, 0] - points[p, 2] * mx, points[p, 1] - points[p, 2] * my
            if abs(ax * ty - ay * tx) < steepest * abs(ax * tx + ay * ty):
                out[p] += weight[k]
    return out
