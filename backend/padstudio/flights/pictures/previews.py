"""A frame with its pose drawn over it, without reading it again: quick enough to play a flight."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import cv2
import numpy as np

from padstudio.arrays import Array, Image
from padstudio.errors import ImageError
from padstudio.flights.pictures.outlines import pad_size_of, strokes
from padstudio.flights.pictures.stages import PictureJob, picture_of
from padstudio.geometry.camera import Camera

# JPEG's, of pictures that a page plays one after the other.
_QUALITY = 82
_COLOURS = {"side": (0, 220, 255), "x": (60, 60, 235), "y": (60, 200, 60), "z": (235, 120, 60)}


def preview(job: PictureJob, record: Mapping[str, Any], width: int) -> bytes:
    """Decode a frame and draw the pad where its result says that it lies.

    Parameters
    ----------
    job : PictureJob
        Its folder does not count.
    record : mapping
        The frame's line of a poses file.
    width : int
        Most pixels of the picture's width.

    Returns
    -------
    bytes
        JPEG.

    Raises
    ------
    ImageError
        If the decoder gives no picture for the frame.
    StudioError
        If its file cannot be read.
    """
    bgr = picture_of(job)
    height_px, width_px = bgr.shape[:2]
    scale = min(1.0, width / width_px)
    size = (max(1, round(width_px * scale)), max(1, round(height_px * scale)))
    picture = np.asarray(cv2.resize(bgr, size, interpolation=cv2.INTER_AREA), np.uint8)
    if record["status"] == "ok":
        camera = Camera.loads(job.recipe.camera).for_frame(width_px, height_px)
        draw_pose(picture, camera, pad_size_of(job.recipe, record), record, scale)
    done, data = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, _QUALITY])
    if not done:
        raise ImageError("the frame could not be encoded as JPEG")
    return data.tobytes()


def draw_pose(
    picture: Image,
    camera: Camera,
    pad_size_mm: tuple[float, float],
    record: Mapping[str, Any],
    scale: float,
) -> None:
    """Draw the pad's edge, and its axes (X red, Y green, Z blue) from its centre.

    Parameters
    ----------
    picture : (h, w, 3) uint8
        Drawn into.
    camera, pad_size_mm, record
        As of `padstudio.flights.pictures.outlines.strokes`.
    scale : float
        Pixels of the picture per pixel of the frame.
    """
    for role, pixels in strokes(camera, pad_size_mm, record):
        _stroke(picture, (pixels + 0.5) * scale - 0.5, _COLOURS[role])


def _stroke(picture: Image, pixels: Array, colour: tuple[int, int, int]) -> None:
    """Lines through pixels, those far outside of the picture left out."""
    room = 2 * max(picture.shape[:2])
    known = np.nan_to_num(pixels, nan=4.0 * room)
    near = np.asarray((np.abs(known) < room).all(axis=1), bool)
    # OpenCV takes fixed-point coordinates of 1/16 pixel.
    fixed = np.clip(known * 16, -16 * room, 16 * room).round().astype(np.int32)
    thick = max(2, picture.shape[1] // 500)
    for line_colour, thickness in (((0, 0, 0), thick + 2), (colour, thick)):
        for place in np.flatnonzero(near[:-1] & near[1:]):
            start, end = fixed[place].tolist(), fixed[place + 1].tolist()
            cv2.line(picture, start, end, line_colour, thickness, cv2.LINE_AA, 4)
