"""What a fisheye of any width sees of a pad on grey ground, sky and black rim included."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.pad.layout import lattice_of
from padstudio.pad.spec import Pad
from padstudio.vision.frame.pyramid import BGR_INDEX

# Samples a side of a pixel.
_OVER = 3


def wide_camera(view_deg: float, width: int = 800, height: int = 600) -> Camera:
    """An equidistant fisheye that sees so many degrees across its height; what is left is black."""
    focal = (height / 2 - 4) / np.radians(view_deg / 2)
    matrix = np.array([[focal, 0, (width - 1) / 2], [0, focal, (height - 1) / 2], [0, 0, 1]])
    return Camera(width, height, matrix, np.zeros(4), "fisheye")


def wide_view(pad: Pad, camera: Camera, pose: Pose, view_deg: float) -> NDArray[np.uint8]:
    """A frame, (H, W, 3) uint8 BGR."""
    over = (np.arange(_OVER * max(camera.width, camera.height)) + 0.5) / _OVER - 0.5
    x, y = np.meshgrid(over[: _OVER * camera.width], over[: _OVER * camera.height])
    u, v = ((x - camera.matrix[0, 2]), (y - camera.matrix[1, 2])) / camera.matrix[0, 0]
    angle = np.hypot(u, v)
    share = np.sin(angle) / np.maximum(angle, 1e-12)
    rays = np.stack([u * share, v * share, np.cos(angle)], axis=-1) @ pose.rotation.T
    with np.errstate(divide="ignore", invalid="ignore"):
        reach = -pose.position_mm[2] / rays[..., 2:]
        ground = pose.position_mm + reach * rays
    picture = np.full((*x.shape, 3), 90.0)
    for layer in pad.layers:
        at = np.floor(lattice_of(pad, layer, ground[..., :2].reshape(-1, 2))).reshape(*x.shape, 2)
        on = ((at >= 0) & (at < (layer.cols, layer.rows))).all(axis=-1)
        cell = np.where(on[..., None], at, 0).astype(np.intp)
        ink = 40.0 + 140.0 * layer.field[cell[..., 1], cell[..., 0]] / (pad.levels - 1)
        picture[on, BGR_INDEX[layer.channel]] = ink[on]
        picture[on, 1] = 50.0
    picture[rays[..., 2] >= 0] = 200.0
    picture[angle > np.radians(view_deg / 2)] = 0.0
    size = (camera.width, camera.height)
    picture = cv2.resize(picture, size, interpolation=cv2.INTER_AREA)
    noise = np.random.default_rng(1).normal(0, 1.5, picture.shape)
    return np.clip(np.round(picture + noise), 0, 255).astype(np.uint8)
