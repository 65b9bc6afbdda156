"""Compiled projection of pad points: lens, moving pose and rolling shutter.

Pad points go to the camera frame, to the plane z = 1, through the lens to pixels. The lens models
are OpenCV's: radial-tangential with up to eight coefficients, and the equidistant fisheye.

References
----------
Brown, D. C. (1966). Decentering distortion of lenses. Photogrammetric Engineering 32(3).
Kannala, J. and Brandt, S. S. (2006). A generic camera model and calibration method for
conventional, wide-angle, and fish-eye lenses. doi:10.1109/TPAMI.2006.153
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from padstudio.arrays import Array
from padstudio.compiled import fast_inlined_jit, fast_jit

# Row times are −0.5 … 0.5; those of points out of view are extrapolated up to here: cells that the
# rim cuts are asked for, nothing further out is.
_LATEST = 0.6
#: Points nearer to the camera's plane than this, mm, have no picture.
NEAREST = 1e-6
# Newton's steps for a lens: how many, the step of differences, the square that is near enough (the
# step after it is exact to rounding).
_MOST_STEPS, _TINY, _EXACT = 15, 1e-6, 1e-18
# Rays of a fisheye at 90 degrees and beyond count as this near to it: they miss the plane z = 1.
_STEEPEST = math.pi / 2 - 1e-6


class Lens(NamedTuple):
    """A camera as compiled loops take it.

    Attributes
    ----------
    matrix : (3, 3) float64
        OpenCV's K, pixels.
    coefficients : (9,) float64
        1 for an equidistant fisheye or 0, then OpenCV's distortion coefficients.
    width, height : int
        Size of the frame, pixels.
    """

    matrix: Array
    coefficients: Array
    width: int
    height: int


class PoseState(NamedTuple):
    """A pose that changes within a frame, as compiled loops take it.

    Attributes
    ----------
    rotation : (3, 3) float64
        Takes camera vectors to pad vectors, at the middle row.
    centre : (3,) float64
        The camera's centre at the middle row, pad frame, mm.
    shift, rotvec : (3,) float64
        As ``shift_mm`` and ``rotvec`` of `padstudio.geometry.rolling_shutter.MovingPose`.
    """

    rotation: Array
    centre: Array
    shift: Array
    rotvec: Array


class Projector(NamedTuple):
    """A pose and the camera that has it."""

    pose: PoseState
    lens: Lens
    still: bool


@fast_inlined_jit
def distorted(u: float, v: float, lens: Array) -> tuple[float, float]:
    """Where a lens, (9,) as of `Lens`, puts a point of the plane z = 1, on that plane."""
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
def undistorted(pixels: Array, lens: Lens) -> Array:
    """Where pixels (N, 2) lie on the plane z = 1 without the lens, (N, 2), by Newton's steps."""
    out = np.empty((len(pixels), 2))
    for i in range(len(pixels)):
        out[i, 0], out[i, 1] = ray_of(pixels[i, 0], pixels[i, 1], lens)
    return out


@fast_inlined_jit
def ray_of(x: float, y: float, lens: Lens) -> tuple[float, float]:
    """Where a pixel lies on the plane z = 1 without the lens."""
    matrix, bend = lens.matrix, lens.coefficients
    v = (y - matrix[1, 2]) / matrix[1, 1]
    u = (x - matrix[0, 2] - matrix[0, 1] * v) / matrix[0, 0]
    if bend[0] > 0:
        return without_fisheye(u, v, bend)
    for k in range(1, len(bend)):
        if bend[k] != 0:
            return without_radtan(u, v, bend)
    return u, v


@fast_jit
def without_radtan(u: float, v: float, lens: Array) -> tuple[float, float]:
    """The point of the plane z = 1 that `distorted` takes to another."""
    x, y = u, v
    for _ in range(_MOST_STEPS):
        du, dv = distorted(x, y, lens)
        ax, ay = distorted(x + _TINY, y, lens)
        bx, by = distorted(x, y + _TINY, lens)
        xx, xy, yx, yy = ax - du, bx - du, ay - dv, by - dv
        determinant = xx * yy - xy * yx
        # Where a lens's polynomial turns back it has no inverse.
        if not determinant > 0:
            break
        off_x, off_y = u - du, v - dv
        step_x = _TINY * (yy * off_x - xy * off_y) / determinant
        step_y = _TINY * (xx * off_y - yx * off_x) / determinant
        # Near there steps would lead anywhere.
        length = math.sqrt(step_x * step_x + step_y * step_y)
        share = 1.0 if length < 1 else 1 / length
        x, y = x + share * step_x, y + share * step_y
        if off_x * off_x + off_y * off_y < _EXACT:
            break
    return x, y


@fast_jit
def without_fisheye(u: float, v: float, lens: Array) -> tuple[float, float]:
    """As `without_radtan`, by the angle alone."""
    bent = math.sqrt(u * u + v * v)
    if bent < 1e-12:
        return u, v
    angle = min(bent, _STEEPEST)
    for _ in range(_MOST_STEPS):
        t = angle * angle
        value = angle * (1 + t * (lens[1] + t * (lens[2] + t * (lens[3] + t * lens[4]))))
        slope = 1 + t * (3 * lens[1] + t * (5 * lens[2] + t * (7 * lens[3] + t * 9 * lens[4])))
        off = bent - value
        angle = min(max(angle + off / slope, 0.0), _STEEPEST)
        if off * off < _EXACT:
            break
    scale = math.tan(angle) / bent
    return u * scale, v * scale


@fast_inlined_jit
def pixel_of(x: float, y: float, z: float, lens: Lens) -> tuple[float, float]:
    """Pixel of a point of the camera frame, NaN behind the camera."""
    if not z > NEAREST:
        return np.nan, np.nan
    matrix = lens.matrix
    du, dv = distorted(x / z, y / z, lens.coefficients)
    px = matrix[0, 0] * du + matrix[0, 1] * dv + matrix[0, 2]
    return px, matrix[1, 1] * dv + matrix[1, 2]


@fast_jit
def pixels_of(points: Array, lens: Lens) -> Array:
    """Pixels (N, 2) of points (N, 3) of the camera frame, NaN behind the camera."""
    out = np.empty((len(points), 2))
    for i in range(len(points)):
        out[i, 0], out[i, 1] = pixel_of(points[i, 0], points[i, 1], points[i, 2], lens)
    return out


@fast_inlined_jit
def in_camera(
    x: float, y: float, z: float, s: float, pose: PoseState
) -> tuple[float, float, float]:
    """A pad point in the camera frame at row time s.

    The change of attitude within one frame is small, so that first order suffices.
    """
    rotation, centre, shift = pose.rotation, pose.centre, pose.shift
    dx = x - centre[0] - s * shift[0]
    dy = y - centre[1] - s * shift[1]
    dz = z - centre[2] - s * shift[2]
    x = dx * rotation[0, 0] + dy * rotation[1, 0] + dz * rotation[2, 0]
    y = dx * rotation[0, 1] + dy * rotation[1, 1] + dz * rotation[2, 1]
    z = dx * rotation[0, 2] + dy * rotation[1, 2] + dz * rotation[2, 2]
    w0, w1, w2 = s * pose.rotvec[0], s * pose.rotvec[1], s * pose.rotvec[2]
    return x - (w1 * z - w2 * y), y - (w2 * x - w0 * z), z - (w0 * y - w1 * x)


@fast_inlined_jit
def picture(x: float, y: float, z: float, s: float, camera: Projector) -> tuple[float, float]:
    """Pixel of a pad point at row time s, NaN behind the camera."""
    cx, cy, cz = in_camera(x, y, z, s, camera.pose)
    return pixel_of(cx, cy, cz, camera.lens)


@fast_inlined_jit
def seen_at(x: float, y: float, z: float, camera: Projector) -> tuple[float, float, float]:
    """Pixel of a pad point, and the time at which its row is read, −0.5 … 0.5 of the frame.

    The row tells when the point was seen, and that where: the secant through two times settles it
    to second order.
    """
    height = camera.lens.height
    px, py = picture(x, y, z, 0.0, camera)
    middle = (height - 1) / 2
    first = min(_LATEST, max(-_LATEST, (py - middle) / height))
    if camera.still or not abs(first) > 1e-9:
        return px, py, first
    qx, qy = picture(x, y, z, first, camera)
    along, down = (qx - px) / first, (qy - py) / first
    s = min(_LATEST, max(-_LATEST, (py - middle) / (height - down)))
    return px + s * along, py + s * down, s


@fast_jit
def project(points: Array, camera: Projector) -> Array:
    """Pixels (N, 2) of pad points (N, 3) under a moving pose, NaN behind the camera."""
    out = np.empty((len(points), 2))
    for i in range(len(points)):
        out[i, 0], out[i, 1], _ = seen_at(points[i, 0], points[i, 1], points[i, 2], camera)
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
