"""Compiled half of `padstudio.vision.pose.pattern.template`."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import fast_jit
from padstudio.geometry.projection import Projector, ray_of


@fast_jit
def blurred_cells(
    cells: NDArray[np.float32], cell_px: float, sigma_px: float, out: NDArray[np.float32]
) -> None:
    """Rows of cells (n, w) drawn ``cell_px`` high and blurred by a Gaussian, added to (h, w)."""
    n, w = cells.shape
    bend = 1 / (sigma_px * math.sqrt(2.0))
    for y in range(len(out)):
        # Four standard deviations hold all but a ten-thousandth of the light.
        first = max(0, int((y + 0.5 - 4 * sigma_px) / cell_px))
        last = min(n, int((y + 0.5 + 4 * sigma_px) / cell_px) + 1)
        for k in range(first, last):
            upper, lower = k * cell_px - y - 0.5, (k + 1) * cell_px - y - 0.5
            share = np.float32(0.5 * (math.erf(lower * bend) - math.erf(upper * bend)))
            for x in range(w):
                out[y, x] += share * cells[k, x]


class Spread(NamedTuple):
    """Some pixels of a frame.

    Attributes
    ----------
    xy : (N, 2) float64
    rays : (3, N) float64
    """

    xy: Array
    rays: Array


@fast_jit
def pixels_on_pad(
    box: tuple[int, int, int, int], stride: int, camera: Projector, sides: tuple[float, float]
) -> Spread:
    """Every so manieth pixel of a box along both axes, by rows, that shows the pad.

    Even and odd columns and rows alike: colours are often the same for two by two pixels, and of
    those on one side alone would be off by half a pixel.

    Parameters
    ----------
    box : (x0, y0, x1, y1) of int
    stride : int
    camera : Projector
        A motion within the frame is left out.
    sides : (width, height) of float
        Half of them, mm, of the part of the pad that counts.
    """
    x0, y0, x1, y1 = box
    rotation, centre = camera.pose.rotation, camera.pose.centre
    most = -(-(x1 - x0) // stride) * -(-(y1 - y0) // stride)
    xy, rays, found = np.empty((most, 2)), np.empty((3, most)), 0
    for row in range(-(-(y1 - y0) // stride)):
        aside = row // 2 % 2 if stride % 2 == 0 else 0
        y = y0 + row * stride + (row % 2 if stride % 2 == 0 else 0)
        for x in range(x0 + aside, x1 if y < y1 else x0, stride):
            u, v = ray_of(float(x), float(y), camera.lens)
            reach = -centre[2] / (rotation[2, 0] * u + rotation[2, 1] * v + rotation[2, 2])
            across = rotation[0, 0] * u + rotation[0, 1] * v + rotation[0, 2]
            along = rotation[1, 0] * u + rotation[1, 1] * v + rotation[1, 2]
            if (
                abs(centre[0] + reach * across) < sides[0]
                and abs(centre[1] + reach * along) < sides[1]
            ):
                xy[found, 0], xy[found, 1] = x, y
                rays[0, found], rays[1, found], rays[2, found] = u, v, 1.0
                found += 1
    return Spread(xy[:found], rays[:, :found])


@fast_jit
def thinned(spread: Spread, most: int, side: float, height: int) -> tuple[Spread, Array, Array]:
    """At most so many pixels, evenly spread, with their row times (N,) and shading terms (6, N).

    Parameters
    ----------
    spread : Spread
    most : int
    side : float
        Half the longer side of their box, pixels.
    height : int
        Of the frame.
    """
    given = len(spread.xy)
    count = min(given, most)
    xy, rays = np.empty((count, 2)), np.empty((3, count))
    row_time, shade = np.empty(count), np.empty((6, count))
    middle_x = middle_y = 0.0
    for i in range(count):
        k = i if given == count else i * (given - 1) // (count - 1)
        x, y = spread.xy[k, 0], spread.xy[k, 1]
        middle_x, middle_y = middle_x + x, middle_y + y
        xy[i, 0], xy[i, 1], row_time[i] = x, y, (y - (height - 1) / 2) / height
        for axis in range(3):
            rays[axis, i] = spread.rays[axis, k]
    middle_x, middle_y = middle_x / count, middle_y / count
    for i in range(count):
        u, v = (xy[i, 0] - middle_x) / side, (xy[i, 1] - middle_y) / side
        shade[0, i], shade[1, i], shade[2, i] = 1.0, u, v
        shade[3, i], shade[4, i], shade[5, i] = u * u, u * v, v * v
    return Spread(xy, rays), row_time, shade
