"""The inner loop of the simulator: light that falls on each pixel.

Each pixel averages what its footprint on the ground sweeps over during its exposure. The shares of
cells are their areas, exactly, at as many instants as the path asks for. Where that costs too much
they come from samples on a rank-1 lattice over the pixel's two sides and the exposure
(Niederreiter, Random Number Generation and Quasi-Monte Carlo Methods, SIAM 1992, chapter 5).

Rows are independent of each other: the caller may give them to any number of threads.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import inlined_jit, pure_jit
from padstudio.simulate.radiance.area_kernel import Quad, quadrant_area
from padstudio.simulate.radiance.lay_kernel import Ray, ground_point, seen_point
from padstudio.simulate.radiance.litter_kernel import touches_litter
from padstudio.simulate.radiance.surface import FLAT, Illumination, Surface
from padstudio.simulate.radiance.surface_kernel import (
    Box,
    Rgb,
    color_at,
    ground_color,
    interval,
    light_at,
    patch_at,
    touches_disc,
)

# Samples of a pixel: of bare ground at rest, as a rule, and of many patches.
_COUNTS = (16, 64, 256)
# What a pixel's footprint holds.
_BARE, _PATCH, _MIXED, _LITTERED = 0, 1, 2, 3
# Beyond so many patches across a pixel, samples cost less than areas and do as well.
_EXACT_PATCHES = 6.0
# Beyond so many instants of an exposure too.
_EXACT_INSTANTS = 24
# Breadth of a footprint that reaches the horizon, for the choice of the texture's level.
_FAR_MM = 1e4


class View(NamedTuple):
    """What the pixels of a picture look along.

    Attributes
    ----------
    rays : (H + 2, W + 2, 3) float32
        Directions of pixel centres in the camera frame, of any length, with a border of one.
    tracks : (H or 1, T, 12) float64
        Poses at evenly spaced instants of each row's exposure: rotation, position.
    pieces : int
        Pieces of an exposure's path that are each as good as straight.
    lattices : (3, 256, 3) float64
        Sample positions in 0 … 1: along the row, along the column, during the exposure.
    """

    rays: NDArray[np.float32]
    tracks: Array
    pieces: int
    lattices: Array


class Pixel(NamedTuple):
    """A pixel's ray, and its steps along the row (u) and the column (v), camera frame."""

    x: float
    y: float
    z: float
    ux: float
    uy: float
    uz: float
    vx: float
    vy: float
    vz: float


@inlined_jit
def _ray(pixel: Pixel, a: float, b: float) -> Ray:
    """The ray a pixel's fractions off its centre."""
    return Ray(
        pixel.x + a * pixel.ux + b * pixel.vx,
        pixel.y + a * pixel.uy + b * pixel.vy,
        pixel.z + a * pixel.uz + b * pixel.vz,
    )


@inlined_jit
def _footprint(pixel: Pixel, pose: Array) -> tuple[bool, Box]:
    """Whether the pixel sees ground alone at an instant, and its bounding box there."""
    x0 = y0 = 1e30
    x1 = y1 = -1e30
    for corner in range(4):
        a = 0.5 if corner & 1 else -0.5
        b = 0.5 if corner & 2 else -0.5
        hit, x, y = ground_point(_ray(pixel, a, b), pose)
        if not hit:
            return False, Box(0.0, 0.0, 0.0, 0.0)
        x0, x1 = min(x0, x), max(x1, x)
        y0, y1 = min(y0, y), max(y1, y)
    return True, Box(x0, x1, y0, y1)


@inlined_jit
def _swept(pixel: Pixel, poses: Array, pieces: int) -> tuple[bool, Box]:
    """As `_footprint`, over the whole exposure; ``poses`` (T, 12)."""
    last = poses.shape[0] - 1
    whole, box = _footprint(pixel, poses[0])
    moments = 2 * pieces
    for moment in range(1, moments + 1 if last > 0 else 1):
        hit, other = _footprint(pixel, poses[moment * last // moments])
        whole = whole and hit
        box = Box(
            min(box.x0, other.x0),
            max(box.x1, other.x1),
            min(box.y0, other.y0),
            max(box.y1, other.y1),
        )
    return whole, box


@inlined_jit
def _instants(pixel: Pixel, narrow_mm: float, poses: Array, pieces: int) -> int:
    """Instants that resolve a pixel's path during the exposure: two a pixel of path."""
    times = len(poses)
    if times == 1:
        return 1
    length_mm = 0.0
    _, x0, y0 = ground_point(_ray(pixel, 0.0, 0.0), poses[0])
    for piece in range(1, pieces + 1):
        _, x1, y1 = ground_point(_ray(pixel, 0.0, 0.0), poses[piece * (times - 1) // pieces])
        length_mm += math.hypot(x1 - x0, y1 - y0)
        x0, y0 = x1, y1
    path = length_mm / max(narrow_mm, 1e-9)
    return min(times, 1 + pieces + int(2.0 * path))


@inlined_jit
def _swept_on_sheet(pixel: Pixel, poses: Array, pieces: int, surface: Surface) -> tuple[bool, Box]:
    """Whether a pixel keeps to one part of a sheet that is not flat, and its bounding box there."""
    last = poses.shape[0] - 1
    moments = 2 * pieces if last > 0 else 0
    x0 = y0 = 1e30
    x1 = y1 = -1e30
    _, _, _, first = seen_point(_ray(pixel, 0.0, 0.0), poses[0], surface)
    one = True
    for moment in range(moments + 1):
        pose = poses[moment * last // max(moments, 1)]
        for corner in range(4):
            a = 0.5 if corner & 1 else -0.5
            b = 0.5 if corner & 2 else -0.5
            _, x, y, part = seen_point(_ray(pixel, a, b), pose, surface)
            one = one and part == first
            x0, x1 = min(x0, x), max(x1, x)
            y0, y1 = min(y0, y), max(y1, y)
    return one, Box(x0, x1, y0, y1)


@inlined_jit
def _content(box: Box, surface: Surface) -> tuple[int, int, int]:
    """What a box on the ground holds: bare ground, one patch (its row and column), or a mixture."""
    if touches_disc(box, surface.discs) or touches_litter(box, surface.litter):
        return _LITTERED, 0, 0
    page = surface.to_page
    left, right = page[0] * box.x0 + page[1], page[0] * box.x1 + page[1]
    above, below = page[2] * box.y1 + page[3], page[2] * box.y0 + page[3]
    if right <= 0 or below <= 0 or left >= surface.x_edges[-1] or above >= surface.y_edges[-1]:
        return _BARE, 0, 0
    q, p = patch_at(box.x0, box.y1, surface)
    if p >= 0 and right <= surface.x_edges[p + 1] and below <= surface.y_edges[q + 1]:
        return _PATCH, q, p
    return _MIXED, 0, 0


@inlined_jit
def _page_point(ray: Ray, pose: Array, surface: Surface) -> tuple[float, float]:
    """Where a ray meets the page."""
    _, x, y, _ = seen_point(ray, pose, surface)
    page = surface.to_page
    return page[0] * x + page[1], page[2] * y + page[3]


@inlined_jit
def _quad(pixel: Pixel, pose: Array, surface: Surface) -> Quad:
    """A pixel's footprint on the page."""
    p = pixel
    ax, ay, az = (p.ux - p.vx) / 2, (p.uy - p.vy) / 2, (p.uz - p.vz) / 2
    bx, by, bz = (p.ux + p.vx) / 2, (p.uy + p.vy) / 2, (p.uz + p.vz) / 2
    x0, y0 = _page_point(Ray(p.x - bx, p.y - by, p.z - bz), pose, surface)
    x1, y1 = _page_point(Ray(p.x + ax, p.y + ay, p.z + az), pose, surface)
    x2, y2 = _page_point(Ray(p.x + bx, p.y + by, p.z + bz), pose, surface)
    x3, y3 = _page_point(Ray(p.x - ax, p.y - ay, p.z - az), pose, surface)
    return Quad(x0, y0, x1, y1, x2, y2, x3, y3)


@inlined_jit
def _exact(pixel: Pixel, pose: Array, spread_mm: float, surface: Surface) -> Rgb:
    """Mean colour of a pixel at an instant: each patch by the area that it has in it."""
    xs, ys = surface.x_edges, surface.y_edges
    quad = _quad(pixel, pose, surface)
    right = max(quad.x0, quad.x1, quad.x2, quad.x3)
    below = max(quad.y0, quad.y1, quad.y2, quad.y3)
    left = min(quad.x0, quad.x1, quad.x2, quad.x3)
    above = min(quad.y0, quad.y1, quad.y2, quad.y3)
    total = quadrant_area(quad, right, below)
    p0 = max(interval(left, xs, surface.x_bins, surface.bin_mm), 0)
    q = max(interval(above, ys, surface.y_bins, surface.bin_mm), 0)
    red = green = blue = covered = 0.0
    while q < ys.shape[0] - 1 and ys[q] < below:
        p = p0
        lower = quadrant_area(quad, xs[p], ys[q + 1])
        before = lower - quadrant_area(quad, xs[p], ys[q])
        while p < xs.shape[0] - 1 and xs[p] < right:
            lower = quadrant_area(quad, xs[p + 1], ys[q + 1])
            upper = quadrant_area(quad, xs[p + 1], ys[q])
            share = (lower - upper - before) / total
            before = lower - upper
            red += share * surface.patches[q, p, 0]
            green += share * surface.patches[q, p, 1]
            blue += share * surface.patches[q, p, 2]
            covered += share
            p += 1
        q += 1
    bare = 1.0 - covered
    if bare > 1e-6:
        _, x, y = ground_point(_ray(pixel, 0.0, 0.0), pose)
        r, g, b = ground_color(x, y, spread_mm, surface)
        red, green, blue = red + bare * r, green + bare * g, blue + bare * b
    return red, green, blue


@inlined_jit
def _average(
    pixel: Pixel, poses: Array, samples: Array, spread_mm: float, surface: Surface
) -> tuple[float, float, float, float]:
    """Mean colour over samples (N, 3) of a lattice, and the share of them that see the sky."""
    red = green = blue = 0.0
    hits, count = 0, len(samples)
    for n in range(count):
        s = samples[n, 0] - 0.5
        t = samples[n, 1] - 0.5
        k = int(samples[n, 2] * poses.shape[0])
        hit, x, y, _ = seen_point(_ray(pixel, s, t), poses[k], surface)
        if hit:
            hits += 1
            r, g, b = color_at(x, y, spread_mm, surface)
            red, green, blue = red + r, green + g, blue + b
    return red / count, green / count, blue / count, 1.0 - hits / count


@inlined_jit
def _along_path(
    pixel: Pixel, poses: Array, bare: bool, instants: int, spread_mm: float, surface: Surface
) -> Rgb:
    """Mean over evenly spaced instants of the exposure: exact areas, or the bare ground."""
    red = green = blue = 0.0
    for n in range(instants):
        pose = poses[(2 * n + 1) * poses.shape[0] // (2 * instants)]
        if bare:
            _, x, y = ground_point(_ray(pixel, 0.0, 0.0), pose)
            r, g, b = ground_color(x, y, spread_mm, surface)
        else:
            r, g, b = _exact(pixel, pose, spread_mm, surface)
        red, green, blue = red + r, green + g, blue + b
    return red / instants, green / instants, blue / instants


@inlined_jit
def _shade(
    pixel: Pixel, poses: Array, pieces: int, lattices: Array, surface: Surface
) -> tuple[float, float, float, float]:
    """Mean colour of what a pixel sweeps over, and the share of sky in it."""
    whole, box = _swept(pixel, poses, pieces)
    wide, narrow, which = _FAR_MM, _FAR_MM, 1
    if whole:
        one = True
        if surface.lay != FLAT:
            one, box = _swept_on_sheet(pixel, poses, pieces, surface)
        content, q, p = _content(box, surface)
        if not one:
            content = _LITTERED
        if content == _PATCH:
            r, g, b = surface.patches[q, p, 0], surface.patches[q, p, 1], surface.patches[q, p, 2]
            return r, g, b, 0.0
        _, box = _footprint(pixel, poses[poses.shape[0] // 2])
        wide, narrow = max(box.x1 - box.x0, box.y1 - box.y0), min(box.x1 - box.x0, box.y1 - box.y0)
        instants = _instants(pixel, narrow, poses, pieces)
        if content == _BARE:
            simple = wide < 2.0 * narrow
        else:
            small = wide < _EXACT_PATCHES * surface.patch_mm and instants <= _EXACT_INSTANTS
            simple = content == _MIXED and small
        if simple:
            bare = content == _BARE
            r, g, b = _along_path(pixel, poses, bare, instants, 0.7 * wide, surface)
            return r, g, b, 0.0
        if content == _BARE and instants == 1:
            which = 0
        elif wide > 3.0 * surface.patch_mm:
            which = 2
    count = _COUNTS[which]
    spread_mm = max(narrow / math.sqrt(count), wide / count)
    return _average(pixel, poses, lattices[which, :count], spread_mm, surface)


@inlined_jit
def _pixel_at(rays: NDArray[np.float32], row: int, col: int) -> Pixel:
    """The pixel at a place of the picture."""
    return Pixel(
        rays[row + 1, col + 1, 0],
        rays[row + 1, col + 1, 1],
        rays[row + 1, col + 1, 2],
        (rays[row + 1, col + 2, 0] - rays[row + 1, col, 0]) * 0.5,
        (rays[row + 1, col + 2, 1] - rays[row + 1, col, 1]) * 0.5,
        (rays[row + 1, col + 2, 2] - rays[row + 1, col, 2]) * 0.5,
        (rays[row + 2, col + 1, 0] - rays[row, col + 1, 0]) * 0.5,
        (rays[row + 2, col + 1, 1] - rays[row, col + 1, 1]) * 0.5,
        (rays[row + 2, col + 1, 2] - rays[row, col + 1, 2]) * 0.5,
    )


@pure_jit
def shade_rows(
    first: int,
    last: int,
    view: View,
    surface: Surface,
    light: Illumination,
    out: NDArray[np.float32],
) -> None:
    """Fill rows ``first`` … ``last`` − 1 of ``out`` (H, W, 3) with linear light."""
    sky = surface.sky
    for row in range(first, last):
        poses = view.tracks[row if view.tracks.shape[0] > 1 else 0]
        for col in range(out.shape[1]):
            pixel = _pixel_at(view.rays, row, col)
            hit, x, y = ground_point(_ray(pixel, 0.0, 0.0), poses[poses.shape[0] // 2])
            if not hit:
                # The border of one pixel between ground and sky needs no finer mixture.
                for c in range(3):
                    out[row, col, c] = sky[c]
                continue
            red, green, blue, clear = _shade(pixel, poses, view.pieces, view.lattices, surface)
            glow = light_at(x, y, light)
            out[row, col, 0] = red * glow + clear * sky[0]
            out[row, col, 1] = green * glow + clear * sky[1]
            out[row, col, 2] = blue * glow + clear * sky[2]
