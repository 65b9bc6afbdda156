"""A frame with its pose drawn over it, without reading it again: quick enough to play a flight."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from typing import Any

import cv2
import numpy as np

from padstudio.arrays import Array, Image
from padstudio.errors import ImageError
from padstudio.flights.pictures.stages import PictureJob
from padstudio.flights.tasks.frames import BYTES_OF_TIMESTAMP, StillPart, read_still
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose, rotation_from_quaternion
from padstudio.pad.spec import Pad

# JPEG's, of pictures that a page plays one after the other.
_QUALITY = 82
# As lenses bend the sides.
_POINTS_A_SIDE = 24
_PAD_COLOUR = (0, 220, 255)
_AXIS_COLOURS = ((60, 60, 235), (60, 200, 60), (235, 120, 60))


def preview(job: PictureJob, record: Mapping[str, Any], width: int) -> bytes:
    """Decode a frame and draw the pad where its result says that it lies.

    Parameters
    ----------
    job : PictureJob
        Its folder and kind do not count.
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
    bgr = _decode(job)
    height_px, width_px = bgr.shape[:2]
    scale = min(1.0, width / width_px)
    size = (max(1, round(width_px * scale)), max(1, round(height_px * scale)))
    picture = np.asarray(cv2.resize(bgr, size, interpolation=cv2.INTER_AREA), np.uint8)
    if record["status"] == "ok":
        camera = Camera.loads(job.recipe.camera).for_frame(width_px, height_px)
        draw_pose(picture, camera, _pad_size_mm(job.recipe.pad), record, scale)
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

    Where only range and bearing are known, the axes are left out, as they would show an attitude.

    Parameters
    ----------
    picture : (h, w, 3) uint8
        Drawn into.
    camera : Camera
        Of the whole frame.
    pad_size_mm : (width, height)
    record : mapping
        Holds ``position_mm`` and ``quaternion_xyzw``.
    scale : float
        Pixels of the picture per pixel of the frame.
    """
    right, top = pad_size_mm[0] / 2, pad_size_mm[1] / 2
    corners = np.array([[-right, top, 0], [right, top, 0], [right, -top, 0], [-right, -top, 0]])
    length = min(pad_size_mm) / 5
    strokes = [(corners, corner, _PAD_COLOUR) for corner in range(4)]
    axes = [np.array([np.zeros(3), length * axis]) for axis in np.eye(3)]
    if record.get("quality") == "bearing":
        axes = []
    strokes += [(ends, 0, colour) for ends, colour in zip(axes, _AXIS_COLOURS, strict=True)]
    for ends, place, colour in strokes:
        start, end = ends[place], ends[(place + 1) % len(ends)]
        steps = np.linspace(0, 1, _POINTS_A_SIDE)[:, None]
        _stroke(picture, _project(start + steps * (end - start), camera, record, scale), colour)


def _decode(job: PictureJob) -> Image:
    part = job.part
    if isinstance(part, StillPart):
        return read_still(part, job.max_pixels)
    # The frames before it, which the detector would follow, are not needed.
    part = replace(part, pts=part.pts[-BYTES_OF_TIMESTAMP:])
    found = [picture.bgr for picture in part.read(job.max_pixels) if picture.bgr is not None]
    if not found:
        raise ImageError(
            "the decoder gives no picture for this frame: its data are missing or damaged",
            code="frame_lost",
        )
    return found[-1]


@lru_cache(maxsize=4)
def _pad_size_mm(pad: str) -> tuple[float, float]:
    return Pad.loads(pad).size_mm


def _project(points_mm: Array, camera: Camera, record: Mapping[str, Any], scale: float) -> Array:
    """Pixels of the picture of points in the pad frame; NaN behind the camera."""
    rotation = rotation_from_quaternion(record["quaternion_xyzw"])
    pose = Pose(np.asarray(record["position_mm"], float), rotation)
    return (camera.project(pose.to_camera(points_mm)) + 0.5) * scale - 0.5


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
