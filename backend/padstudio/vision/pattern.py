"""A pad's pattern as a camera would see it, and the pixels of a frame that show it."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.geometry.camera import Camera
from padstudio.pad.layout import outline_mm
from padstudio.pad.spec import Channel, Pad
from padstudio.vision.covariance import tiles_of
from padstudio.vision.motion import MovingPose, cross
from padstudio.vision.planes import Box, Pyramid
from padstudio.vision.types import Array

# Texture pixels per pixel of the frame, and the blur of lens, sensor and demosaicing, in the
# latter.
OVERSAMPLING = 2.0
_BLUR_PX = 0.8
# More pixels than this are thinned evenly.
_MOST_PIXELS = 16_000
_LEAST_PIXELS = 150
# Pixels this near to the pad's rim see the ground.
_RIM_PX = 2.0


@dataclass(frozen=True, eq=False)
class Texture:
    """The pad's layers as brightness over the pad frame, at a frame's scale.

    Attributes
    ----------
    layers : tuple of (h, w) float32
        0 … 1, blurred as the camera does, in the order of ``pad.layers``.
    mm : (x, y) of float
        Size of a texture pixel.
    size_mm : (w, h) of float
        Measured size of the pad.
    """

    layers: tuple[NDArray[np.float32], ...]
    mm: tuple[float, float]
    size_mm: tuple[float, float]

    def coordinates(self, points: Array) -> tuple[Array, Array]:
        """Texture pixels of pad points (N, 2), mm."""
        x = (points[:, 0] + self.size_mm[0] / 2) / self.mm[0] - 0.5
        y = (self.size_mm[1] / 2 - points[:, 1]) / self.mm[1] - 0.5
        return x, y


@dataclass(frozen=True, eq=False)
class Pixels:
    """Pixels of the frame that show the pad.

    Attributes
    ----------
    rays : (N, 3) float64
    moment : (N,) float64
        When they were read, −0.5 … 0.5 of the frame.
    shade : (N, 6) float64
        Terms of a smooth shading.
    tile : (N,) int
        Part of the picture, as of `padstudio.vision.covariance.tiles_of`.
    values : mapping of channel to (N,) float64
    """

    rays: Array
    moment: Array
    shade: Array
    tile: NDArray[np.intp]
    values: dict[Channel, Array]


def pixels_of(pyramid: Pyramid, camera: Camera, pad: Pad, pose: MovingPose) -> Pixels | None:
    """The pixels of a frame that show the pad, or None where they are too few."""
    box = _outline_box(camera, pad, pose)
    if box is None:
        return None
    stride = max(1, int(np.sqrt((box.x1 - box.x0) * (box.y1 - box.y0) / _MOST_PIXELS)))
    x, y = np.meshgrid(np.arange(box.x0, box.x1, stride), np.arange(box.y0, box.y1, stride))
    xy = np.stack([x.ravel(), y.ravel()], axis=1)
    rays = np.column_stack([camera.normalize(xy), np.ones(len(xy))])
    points, _ = on_pad(pose, rays, np.zeros(len(xy)))
    width, height = pad.size_mm
    rim = _RIM_PX * float(pose.pose.position_mm[2]) / camera.focal_px
    inside = (np.abs(points[:, 0]) < width / 2 - rim) & (np.abs(points[:, 1]) < height / 2 - rim)
    if int(inside.sum()) < _LEAST_PIXELS:
        return None
    xy, rays = xy[inside], rays[inside]
    values = {}
    for layer in pad.layers:
        plane = pyramid.plane(layer.channel, 0, box).values
        values[layer.channel] = plane[xy[:, 1] - box.y0, xy[:, 0] - box.x0].astype(float)
    u, v = ((xy - xy.mean(axis=0)) / max(box.side / 2, 1)).T
    shade = np.stack([np.ones_like(u), u, v, u * u, u * v, v * v], axis=1)
    moment = pose.moment(camera, xy[:, 1].astype(float))
    return Pixels(rays, moment, shade, tiles_of(xy.astype(float)), values)


def _outline_box(camera: Camera, pad: Pad, pose: MovingPose) -> Box | None:
    corners = pose.project(camera, outline_mm(pad))
    if not np.isfinite(corners).all():
        return None
    low = np.clip(np.floor(corners.min(axis=0)), 0, None).astype(int)
    high = np.ceil(corners.max(axis=0)).astype(int) + 1
    box = Box(low[0], low[1], min(camera.width, high[0]), min(camera.height, high[1]))
    return box if min(box.x1 - box.x0, box.y1 - box.y0) >= 4 else None


def texture_of(pad: Pad, px_per_mm: float) -> Texture:
    """The pad as a picture of about the frame's resolution, blurred as the camera does."""
    width, height = pad.size_mm
    w = max(8, round(width * px_per_mm * OVERSAMPLING))
    h = max(8, round(height * px_per_mm * OVERSAMPLING))
    mm = (width / w, height / h)
    sigma = _BLUR_PX * OVERSAMPLING
    layers = []
    for layer in pad.layers:
        field = layer.field.astype(np.float32) / (pad.levels - 1)
        cover = (
            round(layer.width_mm * pad.scale[0] / mm[0]),
            round(layer.height_mm * pad.scale[1] / mm[1]),
        )
        # Averaging over areas is exact only downwards, so the cells are enlarged first.
        factor = max(1, -(-cover[0] // field.shape[1]), -(-cover[1] // field.shape[0]))
        large = np.repeat(np.repeat(field, factor, axis=0), factor, axis=1)
        shown = cv2.resize(large, cover, interpolation=cv2.INTER_AREA)
        canvas = np.zeros((h, w), np.float32)
        canvas[: shown.shape[0], : shown.shape[1]] = shown[:h, :w]
        layers.append(np.asarray(cv2.GaussianBlur(canvas, (0, 0), sigma), np.float32))
    return Texture(tuple(layers), mm, (width, height))


def on_pad(pose: MovingPose, rays: Array, moment: Array) -> tuple[Array, Array]:
    """Where rays meet the pad (N, 2), mm, and their directions (N, 3) in the pad frame."""
    s = moment[:, None]
    turned = rays if pose.still else rays + s * cross(np.broadcast_to(pose.turn, rays.shape), rays)
    direction = turned @ pose.pose.rotation.T
    centre = pose.pose.position_mm + s * pose.shift_mm
    reach = -centre[:, 2] / direction[:, 2]
    return centre[:, :2] + reach[:, None] * direction[:, :2], direction


def by_pose(pose: MovingPose, rays: Array, direction: Array) -> Array:
    """Change of the points on the pad with the pose, (N, 2, 6): centre, then turn."""
    height = float(pose.pose.position_mm[2])
    dx, dy, dz = direction.T
    out = np.zeros((len(rays), 2, 6))
    out[:, 0, 0] = out[:, 1, 1] = 1
    out[:, 0, 2], out[:, 1, 2] = -dx / dz, -dy / dz
    for k in range(3):
        axis = np.zeros(3)
        axis[k] = 1
        turned = cross(np.broadcast_to(axis, rays.shape), rays) @ pose.pose.rotation.T
        out[:, 0, 3 + k] = height / dz * (-turned[:, 0] + dx / dz * turned[:, 2])
        out[:, 1, 3 + k] = height / dz * (-turned[:, 1] + dy / dz * turned[:, 2])
    return out


def look_up(texture: Texture, layer: NDArray[np.float32], points: Array) -> tuple[Array, Array]:
    """Brightness (N,) at pad points, and its slope (N, 2) per mm of X and Y."""
    from padstudio.vision import kernels

    x, y = texture.coordinates(points)
    value, slope = kernels.look_up(layer, x, y)
    return value, slope / np.array([texture.mm[0], -texture.mm[1]])
