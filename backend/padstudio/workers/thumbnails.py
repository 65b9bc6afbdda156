"""Small pictures by which a pad or a camera is recognised in a list."""

from __future__ import annotations

import cv2
import numpy as np

from padstudio.arrays import Image
from padstudio.geometry.camera import Camera
from padstudio.pad.spec import Pad
from padstudio.vision.frame.pyramid import BGR_INDEX

#: The longer side of a thumbnail, pixels.
SIDE_PX = 240
# Lines of the grid along the longer side, and the points by which each is bent.
_LINES, _POINTS = 16, 60
_PAPER, _INK = 255, 96


def of_pad(content: str) -> bytes:
    """The print of a pad without its margin, as PNG.

    Parameters
    ----------
    content : str
        A pad file.
    """
    pad = Pad.loads(content)
    width_mm, height_mm = pad.size_mm
    scale = SIDE_PX / max(width_mm, height_mm)
    picture = np.zeros((max(1, round(height_mm * scale)), max(1, round(width_mm * scale)), 3))
    for layer in pad.layers:
        values = (layer.field * (255.0 / (pad.levels - 1))).astype(np.float32)
        width = max(1, round(layer.cols * layer.cell_mm * scale))
        height = max(1, round(layer.rows * layer.cell_mm * scale))
        # Cells of less than a pixel are averaged, larger ones keep their sides.
        shrinks = width < layer.cols
        way = cv2.INTER_AREA if shrinks else cv2.INTER_NEAREST
        shown = cv2.resize(values, (width, height), interpolation=way)
        picture[:height, :width, BGR_INDEX[layer.channel]] = shown[
            : picture.shape[0], : picture.shape[1]
        ]
    return _png(picture.astype(np.uint8))


def of_camera(content: str) -> bytes:
    """A square grid across the optical axis as a camera shows it, as PNG: its view and its lens.

    Parameters
    ----------
    content : str
        A camera file.
    """
    camera = Camera.loads(content)
    scale = SIDE_PX / max(camera.width, camera.height)
    size = (max(1, round(camera.height * scale)), max(1, round(camera.width * scale)))
    picture = np.full((*size, 3), _PAPER, np.uint8)
    # So far out that the picture's corners are reached; at 85 degrees for those beyond.
    reach = min(1.2 * max(camera.width, camera.height) / camera.focal_px, np.tan(np.radians(85)))
    places = np.linspace(-reach, reach, _LINES + 1)
    along = np.linspace(-reach, reach, _POINTS)
    for place in places:
        for x, y in ((along, np.full(_POINTS, place)), (np.full(_POINTS, place), along)):
            pixels = camera.project(np.stack([x, y, np.ones(_POINTS)], axis=1)) * scale
            _stroke(picture, pixels)
    return _png(picture)


def _stroke(picture: Image, pixels: np.ndarray) -> None:
    room = 4.0 * SIDE_PX
    known = np.nan_to_num(pixels, nan=2 * room)
    near = (np.abs(known) < room).all(axis=1)
    fixed = (np.clip(known, -room, room) * 16).round().astype(np.int32)
    for start, end, seen in zip(fixed[:-1], fixed[1:], near[:-1] & near[1:], strict=True):
        if seen:
            cv2.line(picture, start.tolist(), end.tolist(), (_INK,) * 3, 1, cv2.LINE_AA, 4)


def _png(picture: Image) -> bytes:
    _, data = cv2.imencode(".png", picture)
    return data.tobytes()
