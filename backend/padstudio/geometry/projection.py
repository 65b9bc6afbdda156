"""Compiled projection of pad points, the innermost loop of everything that follows a pose.

Importing Numba takes half a second, so callers import this module where they first need it. Each
loop is the plain form of an equation that the calling module documents.
"""

from __future__ import annotations

import math

import numpy as np

from padstudio.arrays import Array
from padstudio.compiled import fast_jit

# Moments beyond the frame, of points out of view, count up to here.
_LATEST = 0.6
# Newton's steps for a lens: how many, the step of differences, the square that is near enough.
_MOST_STEPS, _TINY, _EXACT = 15, 1e-6, 1e-18


@fast_jit
def distorted(u: float, v: float, lens: Array) -> tuple[float, float]:
    """Where a lens puts a point of the plane z = 1, on that plane.

    ``lens`` (9,) holds 1 for an equidistant fisheye or 0, then OpenCV's coefficients.
    """
    r2 = u * u + v * v
    if lens[0] > 0:
        r = math.sqrt(r2)
        if r < 1e-12:
            return u, v
        angle = math.atan(r)
        t = angle * angle
        bent = angle * (1 + t * (lens[1] + t * (lens[2] + t * (lens[3] + t * lens[4]))))
        return u * bent / r, v * bent / r
    p1, p2 = lens[3], lens[4]
    above = 1 + r2 * (lens[1] + r2 * (lens[2] + r2 * lens[5]))
    radial = above / (1 + r2 * (lens[6] + r2 * (lens[7] + r2 * lens[8])))
    du = u * radial + 2 * p1 * u * v + p2 * (r2 + 2 * u * u)
    return du, v * radial + p1 * (r2 + 2 * v * v) + 2 * p2 * u * v


@fast_jit
def undistorted(pixels: Array, matrix: Array, lens: Array) -> Array:
    """Where pixels (N, 2) lie on the plane z = 1 without the lens, (N, 2), by Newton's steps."""
    out = np.empty((len(pixels), 2))
    for i in range(len(pixels)):
        v = (pixels[i, 1] - matrix[1, 2]) / matrix[1, 1]
        u = (pixels[i, 0] - matrix[0, 2] - matrix[0, 1] * v) / matrix[0, 0]
        x, y = u, v
        for _ in range(_MOST_STEPS):
            du, dv = distorted(x, y, lens)
            ax, ay = distorted(x + _TINY, y, lens)
            bx, by = distorted(x, y + _TINY, lens)
            xx, xy, yx, yy = ax - du, bx - du, ay - dv, by - dv
            scale = _TINY / (xx * yy - xy * yx)
            off_x, off_y = u - du, v - dv
            x += scale * (yy * off_x - xy * off_y)
            y += scale * (xx * off_y - yx * off_x)
            if off_x * off_x + off_y * off_y < _EXACT:
                break
        out[i, 0], out[i, 1] = x, y
    return out


@fast_jit
def picture(
    x: float, y: float, z: float, s: float, pose: Array, matrix: Array, lens: Array
) -> tuple[float, float]:
    """Pixel of a pad point at moment s, NaN behind the camera.

    ``pose`` (6, 3) holds the rotation, the centre, and the shift and turn within the frame.
    """
    dx = x - pose[3, 0] - s * pose[4, 0]
    dy = y - pose[3, 1] - s * pose[4, 1]
    dz = z - pose[3, 2] - s * pose[4, 2]
    x = dx * pose[0, 0] + dy * pose[1, 0] + dz * pose[2, 0]
    y = dx * pose[0, 1] + dy * pose[1, 1] + dz * pose[2, 1]
    z = dx * pose[0, 2] + dy * pose[1, 2] + dz * pose[2, 2]
    w0, w1, w2 = s * pose[5, 0], s * pose[5, 1], s * pose[5, 2]
    x, y, z = x - (w1 * z - w2 * y), y - (w2 * x - w0 * z), z - (w0 * y - w1 * x)
    if z <= 1e-6:
        return np.nan, np.nan
    du, dv = distorted(x / z, y / z, lens)
    px = matrix[0, 0] * du + matrix[0, 1] * dv + matrix[0, 2]
    return px, matrix[1, 1] * dv + matrix[1, 2]


@fast_jit
def seen_at(
    x: float, y: float, z: float, pose: Array, matrix: Array, lens: Array, height: int, still: bool
) -> tuple[float, float, float]:
    """Pixel of a pad point, and the moment at which its row is read.

    The row tells when the point was seen, and that where: the secant through two moments settles
    it to second order.
    """
    px, py = picture(x, y, z, 0.0, pose, matrix, lens)
    middle = (height - 1) / 2
    first = min(_LATEST, max(-_LATEST, (py - middle) / height))
    if still or not abs(first) > 1e-9:
        return px, py, first
    qx, qy = picture(x, y, z, first, pose, matrix, lens)
    along, down = (qx - px) / first, (qy - py) / first
    s = min(_LATEST, max(-_LATEST, (py - middle) / (height - down)))
    return px + s * along, py + s * down, s


@fast_jit
def project(
    points: Array, pose: Array, matrix: Array, lens: Array, height: int, still: bool
) -> Array:
    """Pixels (N, 2) of pad points (N, 3) under a moving pose, NaN behind the camera."""
    out = np.empty((len(points), 2))
    for i in range(len(points)):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        out[i, 0], out[i, 1], _ = seen_at(x, y, z, pose, matrix, lens, height, still)
    return out


@fast_jit
def ground_seen(
    rays: Array, rotation: Array, centre: Array, least_drop: float
) -> tuple[Array, Array]:
    """Least and largest x and y, mm, at which rays (N, 3) of a camera meet the pad's plane.

    Rays that fall by less than ``least_drop`` are left out; without any, least exceeds largest.
    """
    low, high = np.full(2, np.inf), np.full(2, -np.inf)
    for i in range(len(rays)):
        drop = 0.0
        for k in range(3):
            drop -= rotation[2, k] * rays[i, k]
        if drop <= least_drop:
            continue
        reach = centre[2] / drop
        for axis in range(2):
            at = 0.0
            for k in range(3):
                at += rotation[axis, k] * rays[i, k]
            at = centre[axis] + reach * at
            low[axis], high[axis] = min(low[axis], at), max(high[axis], at)
    return low, high
