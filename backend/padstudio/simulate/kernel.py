"""The inner loop of the simulator: light that falls on each pixel.

Each pixel averages what its footprint on the ground sweeps over during its exposure. Samples come
from a rank-1 lattice over the pixel's two sides and the exposure: its projections on each side are
evenly spaced, so that edges along rows or columns fall where they should (Niederreiter, Random
Number Generation and Quasi-Monte Carlo Methods, SIAM 1992, chapter 5).

A pixel that sees one cell alone takes one sample, others as many as their footprint asks for.
Rows are independent of each other: the caller may give them to any number of threads. All of it
stands in one file, because Numba's cache watches no other for changes.

The arguments ``surface`` and ``light`` are the records of `padstudio.simulate.surface`.
"""

from __future__ import annotations

import math
from typing import Any

import numba as nb

# Nothing here allocates. With Numba's run time on, every call counts its arrays' references
# atomically: four times the time on one thread, more on several.
_options: dict[str, Any] = {"nogil": True, "cache": True, "error_model": "numpy", "_nrt": False}
_jit = nb.njit(**_options)
_inline = nb.njit(forceinline=True, **_options)

_COUNTS = (16, 64, 256)
_BARE, _PATCH, _MIXED = 0, 1, 2
# Breadth of a footprint that reaches the horizon, for the choice of the texture's level.
_FAR_MM = 1e4


@_inline
def _ground_point(ray_x, ray_y, tracks, i, k):  # type: ignore[no-untyped-def]
    """Whether a ray meets the plane, and where; the pose is ``tracks[i, k]``."""
    dz = tracks[i, k, 6] * ray_x + tracks[i, k, 7] * ray_y + tracks[i, k, 8]
    if dz > -1e-6:
        return False, 0.0, 0.0
    s = -tracks[i, k, 11] / dz
    dx = tracks[i, k, 0] * ray_x + tracks[i, k, 1] * ray_y + tracks[i, k, 2]
    dy = tracks[i, k, 3] * ray_x + tracks[i, k, 4] * ray_y + tracks[i, k, 5]
    return True, tracks[i, k, 9] + s * dx, tracks[i, k, 10] + s * dy


@_inline
def _interval(value, edges, bins, bin_mm):  # type: ignore[no-untyped-def]
    """The interval between edges that a page coordinate falls into, -1 outside the sheet."""
    if value < 0.0 or value >= edges[edges.shape[0] - 1]:
        return -1
    i = bins[min(int(value / bin_mm), bins.shape[0] - 1)]
    while value >= edges[i + 1]:
        i += 1
    while value < edges[i]:
        i -= 1
    return i


@_inline
def _bilinear(u, v, base, size, texture):  # type: ignore[no-untyped-def]
    """Texture of the level at ``base``, at texel coordinates of that level."""
    x = math.floor(u - 0.5)
    y = math.floor(v - 0.5)
    fx = u - 0.5 - x
    fy = v - 0.5 - y
    left = int(x) & (size - 1)
    right = (left + 1) & (size - 1)
    above = base + (int(y) & (size - 1)) * size
    below = base + ((int(y) + 1) & (size - 1)) * size
    w00 = (1 - fx) * (1 - fy)
    w10 = fx * (1 - fy)
    w01 = (1 - fx) * fy
    w11 = fx * fy
    a, b, c, d = above + left, above + right, below + left, below + right
    return (
        w00 * texture[a, 0] + w10 * texture[b, 0] + w01 * texture[c, 0] + w11 * texture[d, 0],
        w00 * texture[a, 1] + w10 * texture[b, 1] + w01 * texture[c, 1] + w11 * texture[d, 1],
        w00 * texture[a, 2] + w10 * texture[b, 2] + w01 * texture[c, 2] + w11 * texture[d, 2],
    )


@_inline
def _ground(x, y, spread_mm, surface):  # type: ignore[no-untyped-def]
    """The texture averaged over about ``spread_mm`` (trilinear between levels)."""
    last = surface.offsets.shape[0] - 1
    depth = min(math.log2(max(spread_mm / surface.texel_mm, 1.0)), float(last))
    low = int(depth)
    share = depth - low
    size = surface.texture_size >> low
    u = x / (surface.texel_mm * (1 << low))
    v = y / (surface.texel_mm * (1 << low))
    r, g, b = _bilinear(u, v, surface.offsets[low], size, surface.texture)
    if share > 0:
        base = surface.offsets[low + 1]
        r1, g1, b1 = _bilinear(u * 0.5, v * 0.5, base, size >> 1, surface.texture)
        r += share * (r1 - r)
        g += share * (g1 - g)
        b += share * (b1 - b)
    return r, g, b


@_inline
def _disc_at(x, y, discs):  # type: ignore[no-untyped-def]
    """The uppermost disc at a ground point, -1 where there is none."""
    for k in range(discs.shape[0] - 1, -1, -1):
        dx = x - discs[k, 0]
        dy = y - discs[k, 1]
        if dx * dx + dy * dy < discs[k, 2]:
            return k
    return -1


@_inline
def _touches_disc(x0, x1, y0, y1, discs):  # type: ignore[no-untyped-def]
    for k in range(discs.shape[0]):
        dx = max(x0 - discs[k, 0], 0.0, discs[k, 0] - x1)
        dy = max(y0 - discs[k, 1], 0.0, discs[k, 1] - y1)
        if dx * dx + dy * dy < discs[k, 2]:
            return True
    return False


@_inline
def _light(x, y, light):  # type: ignore[no-untyped-def]
    slope = light.gradient[0] * x + light.gradient[1] * y
    value = light.level * min(max(1.0 + slope, 0.08), 4.0)
    shadows = light.shadows
    for k in range(shadows.shape[0]):
        dx = x - shadows[k, 1]
        dy = y - shadows[k, 2]
        if shadows[k, 0] > 0:
            depth = shadows[k, 3] - math.hypot(dx, dy)
        else:
            depth = dx * shadows[k, 3] + dy * shadows[k, 4]
        t = min(max(depth / max(shadows[k, 5], 1e-6) + 0.5, 0.0), 1.0)
        value *= 1.0 - shadows[k, 6] * t * t * (3.0 - 2.0 * t)
    return value


@_inline
def _sweep(rx, ry, ux, uy, vx, vy, tracks, i):  # type: ignore[no-untyped-def]
    """Whether the footprint sees ground alone during the exposure, and its bounding box.

    (rx, ry) is the pixel's ray, (ux, uy) and (vx, vy) its steps along the row and the column.
    """
    x0 = y0 = 1e30
    x1 = y1 = -1e30
    last = tracks.shape[1] - 1
    for moment in range(3 if last > 0 else 1):
        for corner in range(4):
            a = 0.5 if corner & 1 else -0.5
            b = 0.5 if corner & 2 else -0.5
            hit, x, y = _ground_point(
                rx + a * ux + b * vx, ry + a * uy + b * vy, tracks, i, moment * last // 2
            )
            if not hit:
                return False, 0.0, 0.0, 0.0, 0.0
            x0, x1 = min(x0, x), max(x1, x)
            y0, y1 = min(y0, y), max(y1, y)
    return True, x0, x1, y0, y1


@_inline
def _point(x, y, spread_mm, surface):  # type: ignore[no-untyped-def]
    """Colour of what lies at a ground point: a disc, else the sheet, else the ground."""
    k = _disc_at(x, y, surface.discs)
    if k >= 0:
        return surface.discs[k, 3], surface.discs[k, 4], surface.discs[k, 5]
    q, p = _patch(x, y, surface)
    if p >= 0:
        return surface.patches[q, p, 0], surface.patches[q, p, 1], surface.patches[q, p, 2]
    return _ground(x, y, spread_mm, surface)


@_inline
def _patch(x, y, surface):  # type: ignore[no-untyped-def]
    """Row and column of the patch at a ground point; column −1 off the sheet."""
    page = surface.to_page
    p = _interval(page[0] * x + page[1], surface.x_edges, surface.x_bins, surface.bin_mm)
    if p < 0:
        return -1, -1
    q = _interval(page[2] * y + page[3], surface.y_edges, surface.y_bins, surface.bin_mm)
    return q, (p if q >= 0 else -1)


@_inline
def _content(x0, x1, y0, y1, surface):  # type: ignore[no-untyped-def]
    """What a box on the ground holds: bare ground, one patch (its row and column), or a mixture."""
    if _touches_disc(x0, x1, y0, y1, surface.discs):
        return _MIXED, 0, 0
    page = surface.to_page
    if page[0] * x1 + page[1] < 0 or page[0] * x0 + page[1] >= surface.x_edges[-1]:
        return _BARE, 0, 0
    if page[2] * y0 + page[3] < 0 or page[2] * y1 + page[3] >= surface.y_edges[-1]:
        return _BARE, 0, 0
    q, p = _patch(x0, y1, surface)
    if p < 0:
        return _MIXED, 0, 0
    right = page[0] * x1 + page[1]
    below = page[2] * y0 + page[3]
    if right <= surface.x_edges[p + 1] and below <= surface.y_edges[q + 1]:
        return _PATCH, q, p
    return _MIXED, 0, 0


@_inline
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
            r, g, b = _point(x, y, spread_mm, surface)
            red, green, blue = red + r, green + g, blue + b
    return red / count, green / count, blue / count, 1.0 - hits / count


@_inline
def _pixel(rx, ry, ux, uy, vx, vy, tracks, i, lattices, surface, patch_mm):  # type: ignore[no-untyped-def]
    """Mean colour of what a pixel sweeps over, and the share of sky in it."""
    times = tracks.shape[1]
    whole, x0, x1, y0, y1 = _sweep(rx, ry, ux, uy, vx, vy, tracks, i)
    wide, narrow, which = _FAR_MM, _FAR_MM, 1
    if whole:
        wide, narrow = max(x1 - x0, y1 - y0), min(x1 - x0, y1 - y0)
        content, q, p = _content(x0, x1, y0, y1, surface)
        if content == _PATCH:
            r, g, b = surface.patches[q, p, 0], surface.patches[q, p, 1], surface.patches[q, p, 2]
            return r, g, b, 0.0
        if content == _BARE and times == 1 and wide < 2.0 * narrow:
            r, g, b = _ground((x0 + x1) / 2, (y0 + y1) / 2, 0.7 * wide, surface)
            return r, g, b, 0.0
        if content == _BARE:
            which = 0 if times == 1 else 1
        elif wide > 3.0 * patch_mm:
            which = 2
    count = _COUNTS[which]
    spread_mm = max(narrow / math.sqrt(count), wide / count)
    return _average(rx, ry, ux, uy, vx, vy, tracks, i, lattices[which], count, spread_mm, surface)


@_jit
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
            glow = _light(x, y, light)
            out[row, col, 0] = red * glow + clear * sky[0]
            out[row, col, 1] = green * glow + clear * sky[1]
            out[row, col, 2] = blue * glow + clear * sky[2]
