"""Viewing rays of every pixel, and what a lens must satisfy to be simulated."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.errors import LimitError, SpecError
from padstudio.geometry.camera import Camera

# Normalized coordinates grow without bound toward 180 degrees.
MAX_FIELD_OF_VIEW_DEG = 170.0
# A picture's light takes 12 bytes a pixel, 600 MB.
MAX_PIXELS = 50_000_000
# Pixels from one exactly inverted ray to the next; those between are interpolated.
_STEP = 16
# A small frame bends as much from side to side as a large one.
_INTERVALS = 64


@lru_cache(maxsize=3)
def ray_map(camera: Camera) -> NDArray[np.float32]:
    """Normalized coordinates of all pixel centres, with a border of one pixel.

    Returns
    -------
    (H + 2, W + 2, 2) float32
        Element (r, c) belongs to pixel (c − 1, r − 1).

    Raises
    ------
    LimitError
        If the frame is beyond `MAX_PIXELS`, or the view beyond `MAX_FIELD_OF_VIEW_DEG`.
    SpecError
        If the lens model cannot be inverted over the whole frame.
    """
    check_lens(camera)
    # Undistortion iterates; it is smooth enough to be interpolated between knots.
    rows, row_weights = _cubic_weights(camera.height)
    cols, col_weights = _cubic_weights(camera.width)
    knots = np.stack(np.meshgrid(cols, rows), axis=-1).reshape(-1, 2)
    nodes = camera.normalize(knots).reshape(len(rows), len(cols), 2)
    out = np.empty((camera.height + 2, camera.width + 2, 2), np.float32)
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


def field_of_view_deg(camera: Camera) -> float:
    """Twice the largest angle between the optical axis and a ray at the frame's border, degrees."""
    border = frame_border(camera)
    if camera.model == "fisheye":
        return 2 * math.degrees(_fisheye_angle(camera, border))
    rays = camera.normalize(border)
    if not np.isfinite(rays).all():
        return 180.0
    return 2 * math.degrees(math.atan(float(np.hypot(rays[:, 0], rays[:, 1]).max())))


def _fisheye_angle(camera: Camera, pixels: Array) -> float:
    """The largest angle to the axis, radians; π where the polynomial turns back before it."""
    K = camera.matrix
    radius = np.hypot((pixels[:, 0] - K[0, 2]) / K[0, 0], (pixels[:, 1] - K[1, 2]) / K[1, 1]).max()
    theta = np.linspace(0.0, math.pi, 3142)
    k = np.zeros(4)
    k[: len(camera.distortion)] = camera.distortion
    square = theta**2
    grown = theta * (1 + square * (k[0] + square * (k[1] + square * (k[2] + square * k[3]))))
    beyond = np.nonzero(grown >= radius)[0]
    return float(theta[beyond[0]]) if len(beyond) else math.pi


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
