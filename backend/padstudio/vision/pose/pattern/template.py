"""A pad's pattern as a camera would see it, and the pixels of a frame that show it."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.geometry.rolling_shutter import MovingPose, row_times
from padstudio.pad.layout import outline_mm
from padstudio.pad.spec import Pad
from padstudio.vision.frame.pyramid import Box, Pyramid
from padstudio.vision.pose.noise_kernel import tiles_of
from padstudio.vision.pose.pattern.alignment_kernel import Pixels, Texture, blurred_cells

# Texture pixels per pixel of the frame, and the blur of lens, sensor and demosaicing, in the
# latter.
OVERSAMPLING = 2.0
_BLUR_PX = 0.8
# Textures are made at so many scales an octave, so that none is off by more than 5 %.
_SCALES = 8
# Fewer pixels do not bear out two dozen unknowns of pose and brightness.
_LEAST_PIXELS = 150
# Pixels this near to the pad's rim, 2.5 deviations of the blur, see the ground.
_RIM_PX = 2.0


def pixels_of(
    pyramid: Pyramid, camera: Camera, pad: Pad, pose: MovingPose, most: int
) -> Pixels | None:
    """The pixels of a frame that show the pad, evenly thinned; None where they are too few."""
    box = _outline_box(camera, pad, pose)
    if box is None:
        return None
    xy = _spread(box, max(1, int(np.sqrt((box.x1 - box.x0) * (box.y1 - box.y0) / most))))
    rays = np.column_stack([camera.normalize(xy), np.ones(len(xy))])
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
    row_time = row_times(camera, xy[:, 1].astype(float))
    return Pixels(rays, row_time, shade, tiles_of(xy.astype(float)), values)


def _spread(box: Box, stride: int) -> NDArray[np.intp]:
    """Every so manieth pixel (N, 2) of a box along both axes, by rows.

    Even and odd columns and rows alike: colours are often the same for two by two pixels, and of
    those on one side alone would be off by half a pixel.
    """
    x, y = np.meshgrid(np.arange(box.x0, box.x1, stride), np.arange(box.y0, box.y1, stride))
    if stride % 2 == 0:
        row = np.arange(len(y))[:, None]
        x, y = x + row // 2 % 2, y + row % 2
    xy = np.stack([x.ravel(), y.ravel()], axis=1)
    return xy[(xy < [box.x1, box.y1]).all(axis=1)]


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


# A pad that is followed needs one, and the next as it comes nearer; each takes megabytes.
@lru_cache(maxsize=2)
def _texture(pad: Pad, scale: int) -> Texture:
    width, height = pad.size_mm
    per_mm = 2.0 ** (scale / _SCALES) * OVERSAMPLING
    w, h = max(8, round(width * per_mm)), max(8, round(height * per_mm))
    mm = (width / w, height / h)
    sigma = _BLUR_PX * OVERSAMPLING
    # Memory of this size costs more to touch first than the drawing does: it is touched once.
    layers = np.zeros((len(pad.layers), h, w), np.float32)
    for layer, drawn in zip(pad.layers, layers, strict=True):
        cells = layer.field.astype(np.float32) / np.float32(pad.levels - 1)
        cell_px = [layer.cell_mm * pad.scale[k] / mm[k] for k in range(2)]
        wide = np.zeros((w, layer.rows), np.float32)
        blurred_cells(np.ascontiguousarray(cells.T), cell_px[0], sigma, wide)
        blurred_cells(np.ascontiguousarray(wide.T), cell_px[1], sigma, drawn)
    place = [width / 2 / mm[0] - 0.5, 1 / mm[0], height / 2 / mm[1] - 0.5, -1 / mm[1]]
    return Texture(layers, np.array(place))


def on_pad(pose: Pose, rays: Array) -> Array:
    """Where rays (N, 3) meet the pad, (N, 2) mm."""
    direction = rays @ pose.rotation.T
    reach = -pose.position_mm[2] / direction[:, 2]
    return np.asarray(pose.position_mm[:2] + reach[:, None] * direction[:, :2])
