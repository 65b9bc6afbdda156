"""Region of interest and binning of a ROS ``camera_info`` message, applied to a camera.

Matrix and size of the message are of the full sensor picture; the region is counted in its pixels,
and binning joins pixels of the region. Pixel 0 of a picture binned by b is centred on pixel
(b - 1) / 2 of the region (``image_geometry`` leaves that half pixel out).

References
----------
https://docs.ros.org/en/api/sensor_msgs/html/msg/CameraInfo.html
"""

from __future__ import annotations

from typing import Any, NamedTuple

from padstudio.arrays import Array
from padstudio.errors import CameraFormatError
from padstudio.geometry.camera_files.parts.values import one_number

_ROI_KEYS = {"x_offset", "y_offset", "width", "height", "do_rectify"}


class Window(NamedTuple):
    """A part of a sensor's picture, and how many of its pixels become one."""

    x: int
    y: int
    width: int
    height: int
    bin_x: int
    bin_y: int


def read_window(roi: Any, binning: tuple[Any, Any], size: tuple[int, int]) -> Window:
    """The window that a message names; without any, the whole picture.

    Raises
    ------
    CameraFormatError
        If it lies outside the picture, or contradicts itself.
    """
    width, height = size
    x, y, wide, high = _region(roi, size)
    if x + wide > width or y + high > height:
        raise CameraFormatError(
            f"its region of interest, {wide} x {high} at ({x}, {y}), does not lie in the picture "
            f"of {width} x {height}; matrix, size and roi must be of one message"
        )
    bin_x, bin_y = (max(1, _count(value, "binning")) for value in binning)
    if bin_x > wide or bin_y > high:
        raise CameraFormatError(f"it bins {bin_x} x {bin_y} pixels of {wide} x {high} into none")
    return Window(x, y, wide, high, bin_x, bin_y)


def apply_window(matrix: Array, window: Window) -> tuple[Array, tuple[int, int]]:
    """Matrix and size of the frames that the window gives."""
    out = matrix.copy()
    out[0, 2] -= window.x
    out[1, 2] -= window.y
    for row, by in ((0, window.bin_x), (1, window.bin_y)):
        out[row] /= by
        out[row, 2] += 0.5 / by - 0.5
    return out, (window.width // window.bin_x, window.height // window.bin_y)


def window_note(window: Window, size: tuple[int, int]) -> str | None:
    """What a user must know of it, or None where it is the whole picture."""
    if window == Window(0, 0, *size, 1, 1):
        return None
    parts = []
    if (window.width, window.height) != size:
        parts.append(f"region of interest {window.width} x {window.height}")
    if (window.bin_x, window.bin_y) != (1, 1):
        parts.append(f"binning {window.bin_x} x {window.bin_y}")
    frames = f"{window.width // window.bin_x} x {window.height // window.bin_y}"
    return f"{' and '.join(parts)} applied: the camera is of frames of {frames} px"


def _region(roi: Any, size: tuple[int, int]) -> tuple[int, int, int, int]:
    if roi is None:
        return 0, 0, *size
    if not isinstance(roi, dict) or not set(roi) <= _ROI_KEYS:
        raise CameraFormatError(
            "its roi is not x_offset, y_offset, width and height; remove it where it is not the "
            "part of the sensor that the frames show"
        )
    x, y, wide, high = (
        _count(roi.get(key, 0), f"roi {key}") for key in ("x_offset", "y_offset", "width", "height")
    )
    if (wide == 0) != (high == 0) or (wide == 0 and (x or y)):
        raise CameraFormatError(
            f"its region of interest is {wide} x {high} at ({x}, {y}); give all four, or 0 for the "
            "whole picture"
        )
    return (x, y, wide, high) if wide else (0, 0, *size)


def _count(value: Any, place: str) -> int:
    number = one_number(0 if value is None else value, place)
    if number < 0 or number != int(number):
        raise CameraFormatError(f"{place} is {number:g}; give a whole number of pixels")
    return int(number)
