"""What the simulator's inner loop meets at a point of the ground, and the light there."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.compiled import inlined_jit
from padstudio.simulate.radiance.litter_kernel import litter_at
from padstudio.simulate.radiance.surface import Illumination, Surface

Rgb = tuple[float, float, float]


class Box(NamedTuple):
    """An upright box on the ground, mm."""

    x0: float
    x1: float
    y0: float
    y1: float


@inlined_jit
def interval(value: float, edges: Array, bins: NDArray[np.int32], bin_mm: float) -> int:
    """The interval between edges that a page coordinate falls into, -1 outside the sheet."""
    if value < 0.0 or value >= edges[edges.shape[0] - 1]:
        return -1
    i = int(bins[min(int(value / bin_mm), bins.shape[0] - 1)])
    while value >= edges[i + 1]:
        i += 1
    while value < edges[i]:
        i -= 1
    return i


@inlined_jit
def _bilinear(u: float, v: float, base: int, size: int, texture: NDArray[np.float32]) -> Rgb:
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


@inlined_jit
def ground_color(x: float, y: float, spread_mm: float, surface: Surface) -> Rgb:
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


@inlined_jit
def _disc_at(x: float, y: float, discs: Array) -> int:
    """The uppermost disc at a ground point, -1 where there is none."""
    for k in range(discs.shape[0] - 1, -1, -1):
        dx = x - discs[k, 0]
        dy = y - discs[k, 1]
        if dx * dx + dy * dy < discs[k, 2]:
            return k
    return -1


@inlined_jit
def touches_disc(box: Box, discs: Array) -> bool:
    """Whether a disc reaches into a box."""
    for k in range(discs.shape[0]):
        dx = max(box.x0 - discs[k, 0], 0.0, discs[k, 0] - box.x1)
        dy = max(box.y0 - discs[k, 1], 0.0, discs[k, 1] - box.y1)
        if dx * dx + dy * dy < discs[k, 2]:
            return True
    return False


@inlined_jit
def light_at(x: float, y: float, light: Illumination) -> float:
    """The light at a ground point, with its shadows."""
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
    return float(value)


@inlined_jit
def color_at(x: float, y: float, spread_mm: float, surface: Surface) -> Rgb:
    """Colour at a ground point: of a disc, else litter, else the sheet, else the ground."""
    k = _disc_at(x, y, surface.discs)
    if k >= 0:
        return surface.discs[k, 3], surface.discs[k, 4], surface.discs[k, 5]
    k = litter_at(x, y, surface.litter)
    if k >= 0:
        shapes = surface.litter.shapes
        return shapes[k, 7], shapes[k, 8], shapes[k, 9]
    q, p = patch_at(x, y, surface)
    if p >= 0:
        return surface.patches[q, p, 0], surface.patches[q, p, 1], surface.patches[q, p, 2]
    return ground_color(x, y, spread_mm, surface)


@inlined_jit
def patch_at(x: float, y: float, surface: Surface) -> tuple[int, int]:
    """Row and column of the patch at a ground point; column −1 off the sheet."""
    page = surface.to_page
    p = interval(page[0] * x + page[1], surface.x_edges, surface.x_bins, surface.bin_mm)
    if p < 0:
        return -1, -1
    q = interval(page[2] * y + page[3], surface.y_edges, surface.y_bins, surface.bin_mm)
    return q, (p if q >= 0 else -1)
