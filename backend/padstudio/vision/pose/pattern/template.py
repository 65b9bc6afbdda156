"""A pad's pattern as a camera would see it, and the pixels of a frame that show it."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from padstudio.arrays import Array
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.layout import outline_mm
from padstudio.pad.spec import Pad
from padstudio.vision.frame.pixels_kernel import values_at
from padstudio.vision.frame.pyramid import Box, Pyramid
from padstudio.vision.pose.noise_kernel import tiles_of
from padstudio.vision.pose.pattern import template_kernel
from padstudio.vision.pose.pattern.block_kernel import Pixels, Texture
from padstudio.vision.pose.pattern.template_kernel import blurred_cells

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
    stride = max(1, int(math.sqrt((box.x1 - box.x0) * (box.y1 - box.y0) / most)))
    width, height = pad.size_mm
    rim = _RIM_PX * float(pose.pose.position_mm[2]) / camera.focal_px
    corners, sides = (box.x0, box.y0, box.x1, box.y1), (width / 2 - rim, height / 2 - rim)
    every = template_kernel.pixels_on_pad(corners, stride, pose.projector(camera), sides)
    if len(every.xy) < _LEAST_PIXELS:
        return None
    (xy, rays), row_time, shade = template_kernel.thinned(
        every, most, max(box.side / 2, 1.0), camera.height
    )
    windows = (pyramid.window(layer.channel, 0) for layer in pad.layers)
    values = np.stack([values_at(window, xy) for window in windows])
    return Pixels(rays, row_time, shade, tiles_of(xy), values)


def _outline_box(camera: Camera, pad: Pad, pose: MovingPose) -> Box | None:
    corners = pose.project(camera, outline_mm(pad))
    if not np.isfinite(corners).all():
        return None
    low = np.clip(np.floor(corners.min(axis=0)), 0, None).astype(int)
    high = np.ceil(corners.max(axis=0)).astype(int) + 1
    right, below = min(camera.width, int(high[0])), min(camera.height, int(high[1]))
    box = Box(int(low[0]), int(low[1]), right, below)
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
