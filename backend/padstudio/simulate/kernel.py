"""The inner loop of the simulator: light that falls on each pixel.

Each pixel averages what its footprint on the ground sweeps over during its exposure. Samples come
from a rank-1 lattice over the pixel's two sides and the exposure: its projections on each side are
evenly spaced, so that edges along rows or columns fall where they should (Niederreiter, Random
Number Generation and Quasi-Monte Carlo Methods, SIAM 1992, chapter 5).

A pixel that sees one cell alone takes one sample, others as many as their footprint asks for.
Rows are independent of each other: the caller may give them to any number of threads.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numba as nb
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_jit = nb.njit(nogil=True, cache=True, error_model="numpy")


class Surface(NamedTuple):
    """The ground and what lies on it.

    ``patches`` (R, C, 3) are linear colours between ``x_edges`` (C + 1,) and ``y_edges`` (R + 1,),
    page coordinates, mm; ``x_bins`` and ``y_bins`` give the patch at the start of each step of
    ``bin_mm``. ``to_page`` is (ax, bx, ay, by). ``discs`` (N, 6) are x, y, squared radius, colour.
    ``texture`` (M, 3) holds all levels of a square tile of ``texture_size`` texels, finest first,
    at ``offsets`` (L,).
    """

    patches: NDArray[np.float32]
    x_edges: Floats
    y_edges: Floats
    x_bins: NDArray[np.int32]
    y_bins: NDArray[np.int32]
    bin_mm: float
    to_page: Floats
    discs: Floats
    texture: NDArray[np.float32]
    offsets: NDArray[np.int64]
    texture_size: int
    texel_mm: float
    sky: Floats


class Illumination(NamedTuple):
    """``level``, ``gradient`` (2,) per mm, ``shadows`` (N, 7): disc?, x, y, a, b, softness, density.

    For a disc ``a`` is its radius; for a half plane (a, b) is the unit vector into the shadow.
    """

    level: float
    gradient: Floats
    shadows: Floats


@_jit
def _ground_point(ray_x, ray_y, m, out):  # type: ignore[no-untyped-def]
    """Where a ray meets the plane; False where it does not. m: 9 of rotation, 3 of position."""
    dz = m[6] * ray_x + m[7] * ray_y + m[8]
    if dz > -1e-6:
        return False
    s = -m[11] / dz
    out[0] = m[9] + s * (m[0] * ray_x + m[1] * ray_y + m[2])
    out[1] = m[10] + s * (m[3] * ray_x + m[4] * ray_y + m[5])
    return True


@_jit
def _index(value, edges, bins, bin_mm):  # type: ignore[no-untyped-def]
    """The patch that a page coordinate falls into, -1 outside the sheet."""
    if not 0.0 <= value < edges[-1]:
        return -1
    i = bins[min(int(value / bin_mm), len(bins) - 1)]
    while value >= edges[i + 1]:
        i += 1
    while value < edges[i]:
        i -= 1
    return i


@_jit
def _bilinear(level, u, v, surface, channel_scale, out):  # type: ignore[no-untyped-def]
    size = max(1, surface.texture_size >> level)
    base = surface.offsets[level]
    x = u / (1 << level) - 0.5
    y = v / (1 << level) - 0.5
    x0 = math.floor(x)
    y0 = math.floor(y)
    fx = x - x0
    fy = y - y0
    i0 = int(x0) & (size - 1)
    j0 = int(y0) & (size - 1)
    i1 = (i0 + 1) & (size - 1)
    j1 = (j0 + 1) & (size - 1)
    w00 = (1 - fx) * (1 - fy) * channel_scale
    w10 = fx * (1 - fy) * channel_scale
    w01 = (1 - fx) * fy * channel_scale
    w11 = fx * fy * channel_scale
    t = surface.texture
    for c in range(3):
        out[c] += (
            w00 * t[base + j0 * size + i0, c]
            + w10 * t[base + j0 * size + i1, c]
            + w01 * t[base + j1 * size + i0, c]
            + w11 * t[base + j1 * size + i1, c]
        )


@_jit
def _add_ground(x, y, spread_mm, weight, surface, out):  # type: ignore[no-untyped-def]
    """Add the texture, averaged over about spread_mm (trilinear between levels)."""
    last = len(surface.offsets) - 1
    depth = math.log2(max(spread_mm / surface.texel_mm, 1.0))
    depth = min(depth, float(last))
    low = min(int(depth), last)
    share = depth - low
    u = x / surface.texel_mm
    v = y / surface.texel_mm
    _bilinear(low, u, v, surface, weight * (1 - share), out)
    if share > 0:
        _bilinear(min(low + 1, last), u, v, surface, weight * share, out)


@_jit
def _add_point(x, y, spread_mm, weight, discs, surface, out):  # type: ignore[no-untyped-def]
    """Add what lies at a ground point: a disc, else a patch of the sheet, else the ground."""
    if discs:
        d = surface.discs
        for k in range(len(d) - 1, -1, -1):
            if (x - d[k, 0]) ** 2 + (y - d[k, 1]) ** 2 < d[k, 2]:
                for c in range(3):
                    out[c] += weight * d[k, 3 + c]
                return
    page = surface.to_page
    col = _index(page[0] * x + page[1], surface.x_edges, surface.x_bins, surface.bin_mm)
    if col >= 0:
        row = _index(page[2] * y + page[3], surface.y_edges, surface.y_bins, surface.bin_mm)
        if row >= 0:
            for c in range(3):
                out[c] += weight * surface.patches[row, col, c]
            return
    _add_ground(x, y, spread_mm, weight, surface, out)


@_jit
def _light(x, y, light):  # type: ignore[no-untyped-def]
    value = 1.0 + light.gradient[0] * x + light.gradient[1] * y
    value = light.level * min(max(value, 0.08), 4.0)
    for k in range(len(light.shadows)):
        s = light.shadows[k]
        if s[0] > 0:
            depth = s[3] - math.hypot(x - s[1], y - s[2])
        else:
            depth = (x - s[1]) * s[3] + (y - s[2]) * s[4]
        t = min(max(depth / max(s[5], 1e-6) + 0.5, 0.0), 1.0)
        value *= 1.0 - s[6] * t * t * (3.0 - 2.0 * t)
    return value


@_jit
def _touches_disc(box, discs):  # type: ignore[no-untyped-def]
    for k in range(len(discs)):
        dx = max(box[0] - discs[k, 0], 0.0, discs[k, 0] - box[1])
        dy = max(box[2] - discs[k, 1], 0.0, discs[k, 1] - box[3])
        if dx * dx + dy * dy < discs[k, 2]:
            return True
    return False


@_jit
def _sweep(ray, steps, track, box, point):  # type: ignore[no-untyped-def]
    """Bounding box of the footprint over the exposure; False where a part of it sees the sky."""
    box[0] = box[2] = 1e30
    box[1] = box[3] = -1e30
    last = len(track) - 1
    for k in range(3 if last > 0 else 1):
        m = track[k * last // 2]
        for corner in range(4):
            a = 0.5 if corner & 1 else -0.5
            b = 0.5 if corner & 2 else -0.5
            rx = ray[0] + a * steps[0] + b * steps[2]
            ry = ray[1] + a * steps[1] + b * steps[3]
            if not _ground_point(rx, ry, m, point):
                return False
            box[0] = min(box[0], point[0])
            box[1] = max(box[1], point[0])
            box[2] = min(box[2], point[1])
            box[3] = max(box[3], point[1])
    return True


@_jit
def _plain_patch(box, surface):  # type: ignore[no-untyped-def]
    """0: the box lies off the sheet, 1: within one patch, 2: neither."""
    page = surface.to_page
    x0 = page[0] * box[0] + page[1]
    x1 = page[0] * box[1] + page[1]
    y0 = page[2] * box[3] + page[3]
    y1 = page[2] * box[2] + page[3]
    if x1 < 0 or y1 < 0 or x0 > surface.x_edges[-1] or y0 > surface.y_edges[-1]:
        return 0
    col = _index(x0, surface.x_edges, surface.x_bins, surface.bin_mm)
    row = _index(y0, surface.y_edges, surface.y_bins, surface.bin_mm)
    if col < 0 or row < 0 or x1 > surface.x_edges[col + 1] or y1 > surface.y_edges[row + 1]:
        return 2
    return 1


@_jit
def _stride_of(box, kind, moving, surface, patch_mm):  # type: ignore[no-untyped-def]
    """Which lattice a pixel needs: 0, 1, 2 for 16, 64, 256 samples."""
    wide = max(box[1] - box[0], box[3] - box[2])
    if kind == 0:
        return 1 if moving else 0
    if wide > 3.0 * patch_mm:
        return 2
    return 1


@_jit
def shade_rows(first, last, rays, tracks, lattices, surface, light, patch_mm, out):  # type: ignore[no-untyped-def]
    """Fill rows ``first`` … ``last`` − 1 of ``out`` (H, W, 3) float32 with linear light.

    ``rays`` (H + 2, W + 2, 2) are normalized coordinates of pixel centres with a border of one;
    ``tracks`` (H or 1, T, 12) the poses during each row's exposure; ``lattices`` (3, 256, 3) the
    sample positions in 0 … 1; ``patch_mm`` the smallest patch.
    """
    counts = (16, 64, 256)
    point = np.zeros(2)
    box = np.zeros(4)
    acc = np.zeros(3)
    steps = np.zeros(4)
    ray = np.zeros(2)
    times = tracks.shape[1]
    for row in range(first, last):
        track = tracks[row if len(tracks) > 1 else 0]
        middle = track[times // 2]
        for col in range(out.shape[1]):
            for c in range(2):
                ray[c] = rays[row + 1, col + 1, c]
                steps[c] = (rays[row + 1, col + 2, c] - rays[row + 1, col, c]) * 0.5
                steps[2 + c] = (rays[row + 2, col + 1, c] - rays[row, col + 1, c]) * 0.5
            acc[:] = 0.0
            whole = _sweep(ray, steps, track, box, point)
            if not whole and not _ground_point(ray[0], ray[1], middle, point):
                # The border of one pixel between ground and sky needs no finer mixture.
                out[row, col] = surface.sky
                continue
            if whole:
                kind = _plain_patch(box, surface)
                discs = _touches_disc(box, surface.discs)
                stride = _stride_of(box, kind, times > 1, surface, patch_mm)
                wide = max(box[1] - box[0], box[3] - box[2])
                narrow = min(box[1] - box[0], box[3] - box[2])
            else:
                kind, discs, stride, wide, narrow = 2, len(surface.discs) > 0, 1, 1e4, 1e4
            _ground_point(ray[0], ray[1], middle, point)
            glow = _light(point[0], point[1], light)
            if not discs and (kind == 1 or (kind == 0 and times == 1 and wide < 2.0 * narrow)):
                _add_point(point[0], point[1], 0.7 * wide, 1.0, False, surface, acc)
            else:
                count = counts[stride]
                spread = max(narrow / math.sqrt(count), wide / count)
                hits = 0
                for i in range(count):
                    a = lattices[stride, i, 0] - 0.5
                    b = lattices[stride, i, 1] - 0.5
                    m = track[int(lattices[stride, i, 2] * times)]
                    rx = ray[0] + a * steps[0] + b * steps[2]
                    ry = ray[1] + a * steps[1] + b * steps[3]
                    if _ground_point(rx, ry, m, point):
                        hits += 1
                        _add_point(point[0], point[1], spread, 1.0 / count, discs, surface, acc)
                for c in range(3):
                    acc[c] += surface.sky[c] * (1.0 - hits / count) / max(glow, 1e-9)
            for c in range(3):
                out[row, col, c] = acc[c] * glow
