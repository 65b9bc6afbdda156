"""Viewing rays of every pixel, and what a lens must satisfy to be simulated."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.errors import LimitError, SpecError
from padstudio.geometry.camera import Camera

# Of lenses whose rays are kept at z = 1, where they grow without bound toward 180 degrees.
MAX_FIELD_OF_VIEW_DEG = 170.0
# A picture's light takes 12 bytes a pixel, 600 MB.
MAX_PIXELS = 50_000_000
# Pixels from one exactly inverted ray to the next; those between are interpolated.
_STEP = 16
# Angles of a fisheye's table: linear between them to 1e-10.
_ANGLES = 100_001
# Two rays that differ by less, relatively, are one.
_SAME_RAY = 1e-3
# A small frame bends as much from side to side as a large one.
_INTERVALS = 64


@lru_cache(maxsize=3)
def ray_map(camera: Camera) -> NDArray[np.float32]:
    """Directions of all pixel centres in the camera frame, with a border of one pixel.

    Returns
    -------
    (H + 2, W + 2, 3) float32
        Element (r, c) belongs to pixel (c − 1, r − 1). At z = 1, or of length 1 for a fisheye that
        sees more than `MAX_FIELD_OF_VIEW_DEG`; beyond the lens those at its rim.

    Raises
    ------
    LimitError
        If the frame is beyond `MAX_PIXELS`, or the view beyond `MAX_FIELD_OF_VIEW_DEG` with a lens
        that is no fisheye.
    SpecError
        If the lens model cannot be inverted over the whole frame.
    """
    check_lens(camera)
    if is_wide(camera):
        return _wide_ray_map(camera)
    # Undistortion iterates; it is smooth enough to be interpolated between knots.
    rows, row_weights = _cubic_weights(camera.height)
    cols, col_weights = _cubic_weights(camera.width)
    knots = np.stack(np.meshgrid(cols, rows), axis=-1).reshape(-1, 2)
    nodes = camera.normalize(knots).reshape(len(rows), len(cols), 2)
    out = np.ones((camera.height + 2, camera.width + 2, 3), np.float32)
    for axis in range(2):
        out[..., axis] = row_weights @ nodes[..., axis] @ col_weights.T
    out.setflags(write=False)
    return out


def check_lens(camera: Camera) -> None:
    """Refuse a camera that cannot be simulated; raises as `ray_map`."""
    if camera.width * camera.height > MAX_PIXELS:
        raise LimitError(
            f"camera {camera.name!r} has {camera.width} x {camera.height} pixels; the simulator's "
            f"limit is {MAX_PIXELS} pixels",
            code="frame_too_large",
        )
    if is_wide(camera):
        return
    border = frame_border(camera)
    view = field_of_view_deg(camera)
    if not view <= MAX_FIELD_OF_VIEW_DEG:
        raise LimitError(
            f"camera {camera.name!r} sees {view:.1f} degrees across; the simulator's limit is "
            f"{MAX_FIELD_OF_VIEW_DEG:.0f}, give a longer focal length",
            code="field_of_view_too_wide",
            detail={"field_of_view_deg": view, "limit_deg": MAX_FIELD_OF_VIEW_DEG},
        )
    rays = camera.normalize(border)
    error = np.abs(camera.denormalize(rays) - border).max() if np.isfinite(rays).all() else np.inf
    if not error < 0.01:
        raise SpecError(
            f"camera {camera.name!r}: its distortion cannot be inverted at the frame's border "
            f"(off by {error:.3g} px, the limit is 0.01); calibrate again or drop coefficients",
            code="lens_not_invertible",
        )


def frame_border(camera: Camera, points: int = 33) -> Array:
    """(4 · points, 2) pixel positions along the frame's outer border."""
    x = np.linspace(-0.5, camera.width - 0.5, points)
    y = np.linspace(-0.5, camera.height - 0.5, points)
    low, right, bottom = np.full(points, -0.5), x[-1], y[-1]
    return np.concatenate(
        [
            np.stack([x, low], 1),
            np.stack([np.full(points, right), y], 1),
            np.stack([x[::-1], np.full(points, bottom)], 1),
            np.stack([low, y[::-1]], 1),
        ]
    )


def border_rays(camera: Camera) -> Array:
    """(N, 3) directions, of any length, along the frame's outer border."""
    border = frame_border(camera)
    if is_wide(camera):
        return directions(camera, border)
    return np.column_stack([camera.normalize(border), np.ones(len(border))])


def field_of_view_deg(camera: Camera) -> float:
    """Twice the largest angle between the optical axis and a ray at the frame's border, degrees."""
    border = frame_border(camera)
    if camera.model == "fisheye":
        return 2 * math.degrees(_fisheye_angle(camera, border))
    rays = camera.normalize(border)
    if not np.isfinite(rays).all():
        return 180.0
    return 2 * math.degrees(math.atan(float(np.hypot(rays[:, 0], rays[:, 1]).max())))


def is_wide(camera: Camera) -> bool:
    """Whether a camera is a fisheye beyond `MAX_FIELD_OF_VIEW_DEG`, whose rays are directions."""
    return camera.model == "fisheye" and field_of_view_deg(camera) > MAX_FIELD_OF_VIEW_DEG


def directions(camera: Camera, pixels: Array) -> Array:
    """Unit directions (N, 3) in the camera frame of a wide fisheye's pixels (N, 2)."""
    theta, radius = _fisheye_table(camera)
    u, v = _bent_back(camera, pixels)
    away = np.hypot(u, v)
    angle = np.interp(away, radius, theta)
    # sin θ / r tends to 1 on the axis.
    side = np.where(away > 1e-12, np.sin(angle) / np.maximum(away, 1e-12), 1.0)
    return np.stack([u * side, v * side, np.cos(angle)], axis=-1)


def beyond_lens(camera: Camera) -> NDArray[np.bool_] | None:
    """(H, W): pixels of a wide fisheye that its lens throws no light on; None for other lenses."""
    if not is_wide(camera):
        return None
    rim = _fisheye_table(camera)[1][-1]
    x, y = np.arange(camera.width, dtype=float), np.arange(camera.height, dtype=float)
    grid = np.stack(np.meshgrid(x, y), axis=-1)
    u, v = _bent_back(camera, grid.reshape(-1, 2))
    return np.asarray(np.hypot(u, v) > rim).reshape(camera.height, camera.width)


def pixels_of_points(camera: Camera, points: Array) -> Array:
    """Pixels (N, 2) of points (N, 3) of the camera frame; NaN where the lens does not see them."""
    if not is_wide(camera):
        return camera.project(points)
    theta, radius = _fisheye_table(camera)
    side = np.hypot(points[:, 0], points[:, 1])
    angle = np.arctan2(side, points[:, 2])
    bent = np.where(angle <= theta[-1], np.interp(angle, theta, radius), np.nan)
    # On the axis a point has no direction sideways: in front it is the principal point.
    scale = np.where(side > 0, bent / np.maximum(side, 1e-300), np.where(angle < 1, 1.0, np.nan))
    return points[:, :2] * scale[:, None] @ camera.matrix[:2, :2].T + camera.matrix[:2, 2]


def in_picture(camera: Camera, points: Array) -> NDArray[np.bool_]:
    """Which points (N, 3) of the camera frame the picture shows, (N,).

    A lens's polynomial may bring points from far beyond the frame back into it; such are left out.
    """
    pixels = pixels_of_points(camera, points)
    size = np.array([camera.width, camera.height])
    inside = np.asarray(((pixels > -0.5) & (pixels < size - 0.5)).all(axis=1))
    if not is_wide(camera) and inside.any():
        seen = points[inside]
        ray = seen[:, :2] / seen[:, 2:]
        off = np.abs(camera.normalize(pixels[inside]) - ray).max(axis=1)
        inside[inside] = off < _SAME_RAY * (1 + np.abs(ray).max(axis=1))
    return inside


def _wide_ray_map(camera: Camera) -> NDArray[np.float32]:
    """As `ray_map`, of a wide fisheye, pixel by pixel."""
    out = np.empty((camera.height + 2, camera.width + 2, 3), np.float32)
    x = np.arange(-1.0, camera.width + 1.0)
    for row in range(camera.height + 2):
        pixels = np.stack([x, np.full(x.shape, row - 1.0)], axis=-1)
        out[row] = directions(camera, pixels)
    out.setflags(write=False)
    return out


def _bent_back(camera: Camera, pixels: Array) -> tuple[Array, Array]:
    """Pixels (N, 2) on the plane of the distorted coordinates."""
    K = camera.matrix
    v = (pixels[:, 1] - K[1, 2]) / K[1, 1]
    return (pixels[:, 0] - K[0, 2] - K[0, 1] * v) / K[0, 0], v


@lru_cache(maxsize=8)
def _fisheye_table(camera: Camera) -> tuple[Array, Array]:
    """Angles to the axis, radians, and their distorted radii, as far as these grow, to 180°."""
    theta = np.linspace(0.0, math.pi, _ANGLES)
    k = np.zeros(4)
    k[: len(camera.distortion)] = camera.distortion
    square = theta**2
    grown = theta * (1 + square * (k[0] + square * (k[1] + square * (k[2] + square * k[3]))))
    falls = np.nonzero(np.diff(grown) <= 0)[0]
    end = falls[0] + 1 if len(falls) else len(theta)
    return theta[:end], grown[:end]


def _fisheye_angle(camera: Camera, pixels: Array) -> float:
    """The largest angle to the axis, radians; π where the polynomial turns back before it."""
    theta, grown = _fisheye_table(camera)
    K = camera.matrix
    radius = np.hypot((pixels[:, 0] - K[0, 2]) / K[0, 0], (pixels[:, 1] - K[1, 2]) / K[1, 1]).max()
    return float(np.interp(radius, grown, theta)) if radius <= grown[-1] else math.pi


def _cubic_weights(length: int) -> tuple[Array, Array]:
    """Knots over −1 … length, and the (length + 2, K) weights of cubic Lagrange interpolation."""
    count = max(4, math.ceil((length + 1) / _STEP), min(_INTERVALS, length + 1)) + 1
    knots = np.linspace(-1.0, float(length), count)
    at = np.arange(-1.0, length + 1.0)
    position = (at + 1.0) / (knots[1] - knots[0])
    first = np.clip(np.floor(position).astype(int) - 1, 0, count - 4)
    t = position - first
    weights = np.zeros((len(at), count))
    for k in range(4):
        others = [j for j in range(4) if j != k]
        value = np.prod([(t - j) / (k - j) for j in others], axis=0)
        weights[np.arange(len(at)), first + k] = value
    return knots, weights
