"""A pad's pattern as a camera would see it, and the pixels of a frame that show it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.geometry.rolling_shutter import MovingPose, normalized
from padstudio.pad.layout import outline_mm
from padstudio.pad.spec import Pad
from padstudio.vision.frame.pyramid import Box, Pyramid
from padstudio.vision.pose import alignment_kernel
from padstudio.vision.pose.covariance import tiles_of

# Texture pixels per pixel of the frame, and the blur of lens, sensor and demosaicing, in the
# latter.
OVERSAMPLING = 2.0
_BLUR_PX = 0.8
# Textures are made at so many scales an octave.
_SCALES = 8
_LEAST_PIXELS = 150
# Pixels this near to the pad's rim see the ground.
_RIM_PX = 2.0


@dataclass(frozen=True, eq=False)
class Texture:
    """The pad's layers as brightness over the pad frame, at a frame's scale.

    Attributes
    ----------
    layers : (L, h, w) float32
        0 … 1, blurred as the camera does, in the order of ``pad.layers``.
    mm : (x, y) of float
        Size of a texture pixel.
    size_mm : (w, h) of float
        Measured size of the pad.
    """

    layers: NDArray[np.float32]
    mm: tuple[float, float]
    size_mm: tuple[float, float]

    @property
    def place(self) -> Array:
        """(4,) float64: of pad points, mm, the texture pixel is (p0 + p1 X, p2 + p3 Y)."""
        (x_mm, y_mm), (width, height) = self.mm, self.size_mm
        return np.array([width / 2 / x_mm - 0.5, 1 / x_mm, height / 2 / y_mm - 0.5, -1 / y_mm])


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
        Part of the picture, as of `padstudio.vision.pose.covariance.tiles_of`.
    values : (C, N) float32
        Of the channels of ``pad.layers``, in their order.
    """

    rays: Array
    moment: Array
    shade: Array
    tile: NDArray[np.intp]
    values: NDArray[np.float32]

    def thinned(self, most: int) -> Pixels:
        """At most ``most`` of the pixels, evenly spread."""
        stride = -(-len(self.moment) // most)
        if stride <= 1:
            return self
        return Pixels(
            np.ascontiguousarray(self.rays[::stride]),
            self.moment[::stride].copy(),
            np.ascontiguousarray(self.shade[::stride]),
            self.tile[::stride].copy(),
            np.ascontiguousarray(self.values[:, ::stride]),
        )


def pixels_of(
    pyramid: Pyramid, camera: Camera, pad: Pad, pose: MovingPose, most: int
) -> Pixels | None:
    """The pixels of a frame that show the pad, evenly thinned; None where they are too few."""
    box = _outline_box(camera, pad, pose)
    if box is None:
        return None
    stride = max(1, int(np.sqrt((box.x1 - box.x0) * (box.y1 - box.y0) / most)))
    x, y = np.meshgrid(np.arange(box.x0, box.x1, stride), np.arange(box.y0, box.y1, stride))
    xy = np.stack([x.ravel(), y.ravel()], axis=1)
    rays = np.column_stack([normalized(camera, xy.astype(float)), np.ones(len(xy))])
    points = on_pad(pose.pose, rays)
    width, height = pad.size_mm
    rim = _RIM_PX * float(pose.pose.position_mm[2]) / camera.focal_px
    inside = (np.abs(points[:, 0]) < width / 2 - rim) & (np.abs(points[:, 1]) < height / 2 - rim)
    which = np.flatnonzero(inside)
    if len(which) < _LEAST_PIXELS:
        return None
    if len(which) > most:
        which = which[np.linspace(0, len(which) - 1, most).astype(np.intp)]
    xy, rays = xy[which], rays[which]
    values = np.stack([pyramid.values_at(layer.channel, xy) for layer in pad.layers])
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
    # One picture serves all scales near it: they differ by less than the blur is known.
    return _texture(pad, round(_SCALES * math.log2(px_per_mm)))


@lru_cache(maxsize=4)
def _texture(pad: Pad, scale: int) -> Texture:
    width, height = pad.size_mm
    per_mm = 2.0 ** (scale / _SCALES) * OVERSAMPLING
    w, h = max(8, round(width * per_mm)), max(8, round(height * per_mm))
    mm = (width / w, height / h)
    sigma = _BLUR_PX * OVERSAMPLING
    layers = []
    for layer in pad.layers:
        cells = layer.field.astype(np.float32) / np.float32(pad.levels - 1)
        cell_px = [layer.cell_mm * pad.scale[k] / mm[k] for k in range(2)]
        wide = alignment_kernel.blurred_cells(np.ascontiguousarray(cells.T), cell_px[0], sigma, w)
        wide = np.ascontiguousarray(wide.T)
        layers.append(alignment_kernel.blurred_cells(wide, cell_px[1], sigma, h))
    return Texture(np.stack(layers), mm, (width, height))


def on_pad(pose: Pose, rays: Array) -> Array:
    """Where rays (N, 3) meet the pad, (N, 2) mm."""
    direction = rays @ pose.rotation.T
    reach = -pose.position_mm[2] / direction[:, 2]
    return np.asarray(pose.position_mm[:2] + reach[:, None] * direction[:, :2])
