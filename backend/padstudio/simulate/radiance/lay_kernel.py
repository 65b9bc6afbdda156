"""Where a ray meets the ground, or a sheet that does not lie flat and whole on it."""

from __future__ import annotations

import math
from typing import NamedTuple

from padstudio.arrays import Array
from padstudio.compiled import inlined_jit
from padstudio.simulate.radiance.surface import FLAT, RAISED, Surface

# Beside the sheet: far off it, at the same place of the ground's texture.
_TILES_AWAY = 64
# Steps of a ray's way to a raised sheet, and the step that ends it, mm.
_MOST_STEPS, _NEAR_MM = 24, 1e-5
# Part of a point that is on no sheet.
_BARE = -1


class Ray(NamedTuple):
    """A direction in the camera frame, of any length."""

    x: float
    y: float
    z: float


@inlined_jit
def ground_point(ray: Ray, pose: Array) -> tuple[bool, float, float]:
    """Whether a ray meets the plane, and where; ``pose`` (12,)."""
    dz = pose[6] * ray.x + pose[7] * ray.y + pose[8] * ray.z
    if dz > -1e-6:
        return False, 0.0, 0.0
    s = -pose[11] / dz
    dx = pose[0] * ray.x + pose[1] * ray.y + pose[2] * ray.z
    dy = pose[3] * ray.x + pose[4] * ray.y + pose[5] * ray.z
    return True, pose[9] + s * dx, pose[10] + s * dy


@inlined_jit
def seen_point(ray: Ray, pose: Array, surface: Surface) -> tuple[bool, float, float, int]:
    """What a ray meets first: whether anything, the point of the flat pad frame, and its part.

    The point is where what is seen there lies on the flat, whole sheet; beside a sheet that does
    not lie so it is moved off it. Parts are sheets of a tiling; all ground is one part.
    """
    hit, x, y = ground_point(ray, pose)
    if surface.lay == FLAT or not hit:
        return hit, x, y, 0
    if surface.lay == RAISED:
        part, u, v = _on_relief(ray, pose, x, y, surface)
    else:
        part, u, v = _on_tiles(x, y, surface.tiles)
    if part == _BARE:
        return True, x + _TILES_AWAY * surface.texture_size * surface.texel_mm, y, _BARE
    return True, u, v, part


@inlined_jit
def _on_relief(
    ray: Ray, pose: Array, x: float, y: float, surface: Surface
) -> tuple[int, float, float]:
    """The paper's point that a ray meets, by fixed-point steps from that of the plane.

    Each step brings the ray to the height of the paper where the last one ended; it converges
    where the paper's slope is below the ray's own, and takes the nearer of two points as a rule.
    """
    half_x, half_y = surface.half_mm[0], surface.half_mm[1]
    reach = surface.half_mm[2]
    sideways = reach * (1.0 + math.hypot(x - pose[9], y - pose[10]) / pose[11])
    if abs(x) > half_x + sideways or abs(y) > half_y + sideways:
        return _BARE, x, y
    dx = pose[0] * ray.x + pose[1] * ray.y + pose[2] * ray.z
    dy = pose[3] * ray.x + pose[4] * ray.y + pose[5] * ray.z
    dz = pose[6] * ray.x + pose[7] * ray.y + pose[8] * ray.z
    u, v = x, y
    for _ in range(_MOST_STEPS):
        east, north, height = _bent(u, v, surface)
        s = (height - pose[11]) / dz
        next_u, next_v = pose[9] + s * dx - east, pose[10] + s * dy - north
        step = abs(next_u - u) + abs(next_v - v)
        u, v = next_u, next_v
        if step < _NEAR_MM:
            break
    if abs(u) <= half_x and abs(v) <= half_y:
        return 0, u, v
    return _BARE, x, y


@inlined_jit
def _bent(u: float, v: float, surface: Surface) -> tuple[float, float, float]:
    """How far a point of the paper lies east and north of its flat place, and over the ground."""
    nodes = surface.relief
    rows, cols = nodes.shape[0], nodes.shape[1]
    p = min(max((u / surface.half_mm[0] + 1.0) * 0.5, 0.0), 1.0) * (cols - 1)
    q = min(max((v / surface.half_mm[1] + 1.0) * 0.5, 0.0), 1.0) * (rows - 1)
    c, r = min(int(p), cols - 2), min(int(q), rows - 2)
    f, g = p - c, q - r
    w00, w01, w10, w11 = (1 - f) * (1 - g), f * (1 - g), (1 - f) * g, f * g
    return (
        w00 * nodes[r, c, 0]
        + w01 * nodes[r, c + 1, 0]
        + w10 * nodes[r + 1, c, 0]
        + w11 * nodes[r + 1, c + 1, 0],
        w00 * nodes[r, c, 1]
        + w01 * nodes[r, c + 1, 1]
        + w10 * nodes[r + 1, c, 1]
        + w11 * nodes[r + 1, c + 1, 1],
        w00 * nodes[r, c, 2]
        + w01 * nodes[r, c + 1, 2]
        + w10 * nodes[r + 1, c, 2]
        + w11 * nodes[r + 1, c + 1, 2],
    )


@inlined_jit
def _on_tiles(x: float, y: float, tiles: Array) -> tuple[int, float, float]:
    """The uppermost sheet of a tiling at a ground point, and the point's place on the whole print.

    ``tiles`` (N, 8): centre, cosine and sine of the turn, half sides, centre on the whole print.
    """
    for k in range(tiles.shape[0] - 1, -1, -1):
        dx, dy = x - tiles[k, 0], y - tiles[k, 1]
        u = tiles[k, 2] * dx + tiles[k, 3] * dy
        v = tiles[k, 2] * dy - tiles[k, 3] * dx
        if abs(u) <= tiles[k, 4] and abs(v) <= tiles[k, 5]:
            return k, u + tiles[k, 6], v + tiles[k, 7]
    return _BARE, x, y
