"""The inner loop of the simulator: light that falls on each pixel.

Each pixel averages what its footprint on the ground sweeps over during its exposure. The shares of
cells are their areas, exactly, at as many instants as the path asks for. Where that costs too much
they come from samples on a rank-1 lattice over the pixel's two sides and the exposure
(Niederreiter, Random Number Generation and Quasi-Monte Carlo Methods, SIAM 1992, chapter 5).

Rows are independent of each other: the caller may give them to any number of threads. Numba's cache
watches this file alone: after a change in one of the other ``kernel_*`` files, touch it.

The arguments ``surface`` and ``light`` are the records of `padstudio.simulate.radiance.surface`.
"""

from __future__ import annotations

import math

from padstudio.compiled import inlined_jit, pure_jit
from padstudio.simulate.radiance.area_kernel import quadrant_area
from padstudio.simulate.radiance.surface_kernel import (
    color_at,
    ground_color,
    interval,
    light_at,
    patch_at,
    touches_disc,
)

_COUNTS = (16, 64, 256)
_BARE, _PATCH, _MIXED, _LITTERED = 0, 1, 2, 3
# Beyond so many patches across a pixel, samples cost less than areas and do as well.
_EXACT_PATCHES = 6.0
# Beyond so many instants of an exposure too.
_EXACT_INSTANTS = 24
# Breadth of a footprint that reaches the horizon, for the choice of the texture's level.
_FAR_MM = 1e4


@inlined_jit
def _ground_point(ray_x, ray_y, tracks, i, k):  # type: ignore[no-untyped-def]
    """Whether a ray meets the plane, and where; the pose is ``tracks[i, k]``."""
    dz = tracks[i, k, 6] * ray_x + tracks[i, k, 7] * ray_y + tracks[i, k, 8]
    if dz > -1e-6:
        return False, 0.0, 0.0
    s = -tracks[i, k, 11] / dz
    dx = tracks[i, k, 0] * ray_x + tracks[i, k, 1] * ray_y + tracks[i, k, 2]
    dy = tracks[i, k, 3] * ray_x + tracks[i, k, 4] * ray_y + tracks[i, k, 5]
    return True, tracks[i, k, 9] + s * dx, tracks[i, k, 10] + s * dy


@inlined_jit
def _footprint(rx, ry, ux, uy, vx, vy, tracks, i, k):  # type: ignore[no-untyped-def]
    """Whether the pixel sees ground alone at an instant, and its bounding box there.

    (rx, ry) is the pixel's ray, (ux, uy) and (vx, vy) its steps along the row and the column.
    """
    x0 = y0 = 1e30
    x1 = y1 = -1e30
    for corner in range(4):
        a = 0.5 if corner & 1 else -0.5
        b = 0.5 if corner & 2 else -0.5
        hit, x, y = _ground_point(rx + a * ux + b * vx, ry + a * uy + b * vy, tracks, i, k)
        if not hit:
            return False, 0.0, 0.0, 0.0, 0.0
        x0, x1 = min(x0, x), max(x1, x)
        y0, y1 = min(y0, y), max(y1, y)
    return True, x0, x1, y0, y1


@inlined_jit
def _sweep(rx, ry, ux, uy, vx, vy, tracks, i):  # type: ignore[no-untyped-def]
    """As `_footprint`, over the whole exposure."""
    last = tracks.shape[1] - 1
    whole, x0, x1, y0, y1 = _footprint(rx, ry, ux, uy, vx, vy, tracks, i, 0)
    for moment in range(1, 3 if last > 0 else 1):
        hit, a0, a1, b0, b1 = _footprint(rx, ry, ux, uy, vx, vy, tracks, i, moment * last // 2)
        whole = whole and hit
        x0, x1 = min(x0, a0), max(x1, a1)
        y0, y1 = min(y0, b0), max(y1, b1)
    return whole, x0, x1, y0, y1


@inlined_jit
def _instants(rx, ry, narrow_mm, tracks, i):  # type: ignore[no-untyped-def]
    """Instants that resolve a pixel's path during the exposure: two a pixel of path."""
    times = tracks.shape[1]
    if times == 1:
        return 1
    _, x0, y0 = _ground_point(rx, ry, tracks, i, 0)
    _, x1, y1 = _ground_point(rx, ry, tracks, i, times - 1)
    path = math.hypot(x1 - x0, y1 - y0) / max(narrow_mm, 1e-9)
    return min(times, 2 + int(2.0 * path))


@inlined_jit
def _content(x0, x1, y0, y1, surface):  # type: ignore[no-untyped-def]
    """What a box on the ground holds: bare ground, one patch (its row and column), or a mixture."""
    if touches_disc(x0, x1, y0, y1, surface.discs):
        return _LITTERED, 0, 0
    page = surface.to_page
    left, right = page[0] * x0 + page[1], page[0] * x1 + page[1]
    above, below = page[2] * y1 + page[3], page[2] * y0 + page[3]
    if right <= 0 or below <= 0 or left >= surface.x_edges[-1] or above >= surface.y_edges[-1]:
        return _BARE, 0, 0
    q, p = patch_at(x0, y1, surface)
    if p >= 0 and right <= surface.x_edges[p + 1] and below <= surface.y_edges[q + 1]:
        return _PATCH, q, p
    return _MIXED, 0, 0


@inlined_jit
def _page_corner(rx, ry, tracks, i, k, page):  # type: ignore[no-untyped-def]
    _, x, y = _ground_point(rx, ry, tracks, i, k)
    return page[0] * x + page[1], page[2] * y + page[3]


@inlined_jit
def _exact(rx, ry, ux, uy, vx, vy, tracks, i, k, spread_mm, surface):  # type: ignore[no-untyped-def]
    """Mean colour of a pixel at an instant: each patch by the area that it has in it."""
    page, xs, ys = surface.to_page, surface.x_edges, surface.y_edges
    ax, ay, bx, by = (ux - vx) / 2, (uy - vy) / 2, (ux + vx) / 2, (uy + vy) / 2
    x0, y0 = _page_corner(rx - bx, ry - by, tracks, i, k, page)
    x1, y1 = _page_corner(rx + ax, ry + ay, tracks, i, k, page)
    x2, y2 = _page_corner(rx + bx, ry + by, tracks, i, k, page)
    x3, y3 = _page_corner(rx - ax, ry - ay, tracks, i, k, page)
    right, below = max(x0, x1, x2, x3), max(y0, y1, y2, y3)
    total = quadrant_area(x0, y0, x1, y1, x2, y2, x3, y3, right, below)
    p0 = max(interval(min(x0, x1, x2, x3), xs, surface.x_bins, surface.bin_mm), 0)
    q = max(interval(min(y0, y1, y2, y3), ys, surface.y_bins, surface.bin_mm), 0)
    red = green = blue = covered = 0.0
    while q < ys.shape[0] - 1 and ys[q] < below:
        p = p0
        lower = quadrant_area(x0, y0, x1, y1, x2, y2, x3, y3, xs[p], ys[q + 1])
        before = lower - quadrant_area(x0, y0, x1, y1, x2, y2, x3, y3, xs[p], ys[q])
        while p < xs.shape[0] - 1 and xs[p] < right:
            lower = quadrant_area(x0, y0, x1, y1, x2, y2, x3, y3, xs[p + 1], ys[q + 1])
            upper = quadrant_area(x0, y0, x1, y1, x2, y2, x3, y3, xs[p + 1], ys[q])
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
        _, x, y = _ground_point(rx, ry, tracks, i, k)
        r, g, b = ground_color(x, y, spread_mm, surface)
        red, green, blue = red + bare * r, green + bare * g, blue + bare * b
    return red, green, blue


@inlined_jit
def _average(rx, ry, ux, uy, vx, vy, tracks, i, lattice, count, spread_mm, surface):  # type: ignore[no-untyped-def]
    """Mean colour over a lattice of samples, and the share of them that see the sky."""
    red = green = blue = 0.0
    hits = 0
    for n in range(count):
        s = lattice[n, 0] - 0.5
        t = lattice[n, 1] - 0.5
        k = int(lattice[n, 2] * tracks.shape[1])
        hit, x, y = _ground_point(rx + s * ux + t * vx, ry + s * uy + t * vy, tracks, i, k)
        if hit:
            hits += 1
            r, g, b = color_at(x, y, spread_mm, surface)
            red, green, blue = red + r, green + g, blue + b
    return red / count, green / count, blue / count, 1.0 - hits / count


@inlined_jit
def _along_path(rx, ry, ux, uy, vx, vy, tracks, i, content, instants, spread_mm, surface):  # type: ignore[no-untyped-def]
    """Mean over evenly spaced instants of the exposure: exact areas, or the bare ground."""
    red = green = blue = 0.0
    for n in range(instants):
        k = (2 * n + 1) * tracks.shape[1] // (2 * instants)
        if content == _BARE:
            _, x, y = _ground_point(rx, ry, tracks, i, k)
            r, g, b = ground_color(x, y, spread_mm, surface)
        else:
            r, g, b = _exact(rx, ry, ux, uy, vx, vy, tracks, i, k, spread_mm, surface)
        red, green, blue = red + r, green + g, blue + b
    return red / instants, green / instants, blue / instants


@inlined_jit
def _pixel(rx, ry, ux, uy, vx, vy, tracks, i, lattices, surface, patch_mm):  # type: ignore[no-untyped-def]
    """Mean colour of what a pixel sweeps over, and the share of sky in it."""
    middle = tracks.shape[1] // 2
    whole, x0, x1, y0, y1 = _sweep(rx, ry, ux, uy, vx, vy, tracks, i)
    wide, narrow, which = _FAR_MM, _FAR_MM, 1
    if whole:
        content, q, p = _content(x0, x1, y0, y1, surface)
        if content == _PATCH:
            r, g, b = surface.patches[q, p, 0], surface.patches[q, p, 1], surface.patches[q, p, 2]
            return r, g, b, 0.0
        _, x0, x1, y0, y1 = _footprint(rx, ry, ux, uy, vx, vy, tracks, i, middle)
        wide, narrow = max(x1 - x0, y1 - y0), min(x1 - x0, y1 - y0)
        instants = _instants(rx, ry, narrow, tracks, i)
        if content == _BARE:
            simple = wide < 2.0 * narrow
        else:
            small = wide < _EXACT_PATCHES * patch_mm and instants <= _EXACT_INSTANTS
            simple = content == _MIXED and small
        if simple:
            r, g, b = _along_path(
                rx, ry, ux, uy, vx, vy, tracks, i, content, instants, 0.7 * wide, surface
            )
            return r, g, b, 0.0
        if content == _BARE and instants == 1:
            which = 0
        elif wide > 3.0 * patch_mm:
            which = 2
    count = _COUNTS[which]
    spread_mm = max(narrow / math.sqrt(count), wide / count)
    return _average(rx, ry, ux, uy, vx, vy, tracks, i, lattices[which], count, spread_mm, surface)


@pure_jit
def shade_rows(first, last, rays, tracks, lattices, surface, light, patch_mm, out):  # type: ignore[no-untyped-def]
    """Fill rows ``first`` … ``last`` − 1 of ``out`` (H, W, 3) float32 with linear light.

    ``rays`` (H + 2, W + 2, 2) are normalized coordinates of pixel centres with a border of one;
    ``tracks`` (H or 1, T, 12) the poses during each row's exposure; ``lattices`` (3, 256, 3) the
    sample positions in 0 … 1; ``patch_mm`` the smallest patch.
    """
    sky = surface.sky
    for row in range(first, last):
        i = row if tracks.shape[0] > 1 else 0
        for col in range(out.shape[1]):
            rx, ry = rays[row + 1, col + 1, 0], rays[row + 1, col + 1, 1]
            hit, x, y = _ground_point(rx, ry, tracks, i, tracks.shape[1] // 2)
            if not hit:
                # The border of one pixel between ground and sky needs no finer mixture.
                for c in range(3):
                    out[row, col, c] = sky[c]
                continue
            ux = (rays[row + 1, col + 2, 0] - rays[row + 1, col, 0]) * 0.5
            uy = (rays[row + 1, col + 2, 1] - rays[row + 1, col, 1]) * 0.5
            vx = (rays[row + 2, col + 1, 0] - rays[row, col + 1, 0]) * 0.5
            vy = (rays[row + 2, col + 1, 1] - rays[row, col + 1, 1]) * 0.5
            red, green, blue, clear = _pixel(
                rx, ry, ux, uy, vx, vy, tracks, i, lattices, surface, patch_mm
            )
            glow = light_at(x, y, light)
            out[row, col, 0] = red * glow + clear * sky[0]
            out[row, col, 1] = green * glow + clear * sky[1]
            out[row, col, 2] = blue * glow + clear * sky[2]
