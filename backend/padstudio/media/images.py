"""Reads uploaded pictures: what they are by their content, their size before they are decoded.

Formats: JPEG, PNG, WebP, TIFF, BMP. Orientation tags are ignored: a pose belongs to the picture as
the sensor saw it, which is also what the camera was calibrated with.
"""

from __future__ import annotations

import io
import re
import struct
import warnings
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image as PillowImage
from PIL import UnidentifiedImageError

from padstudio.bounded_files import read_whole
from padstudio.errors import ImageError, LimitError
from padstudio.media import content
from padstudio.media.content import ContentError

#: Pixels of one picture, unless the caller sets another limit.
MAX_PIXELS = 50_000_000
#: Bytes of one picture's file.
MAX_BYTES = 256_000_000

_FORMATS = ("JPEG", "PNG", "WEBP", "TIFF", "BMP")
_READABLE = "JPEG, PNG, WebP, TIFF or BMP"
_FLAGS = cv2.IMREAD_COLOR | cv2.IMREAD_IGNORE_ORIENTATION
# Within the coded data of a JPEG, FF 00 is data and FF D0 … D7 are restarts; FF FF is filling.
_JPEG_MARKER = re.compile(rb"\xff+([^\x00\xd0-\xd7\xff])", re.DOTALL)
_JPEG_END, _JPEG_BARE = 0xD9, (0x01, 0xD8)


@dataclass(frozen=True)
class ImageHeader:
    """What a picture's file says of itself.

    Attributes
    ----------
    format : str
        JPEG, PNG, WEBP, TIFF or BMP.
    width, height : int
        Pixels, as stored.
    """

    format: str
    width: int
    height: int


def read(path: Path, max_pixels: int = MAX_PIXELS) -> NDArray[np.uint8]:
    """Decode a picture's file; returns and raises as `decode`."""
    return decode(read_file(path), max_pixels)


def read_file(path: Path) -> bytes:
    """A picture's file.

    Raises
    ------
    ImageError, LimitError
        If it cannot be read, or is larger than any picture.
    """
    try:
        data = read_whole(path, MAX_BYTES)
    except OSError as error:
        raise ImageError(f"cannot read {path.name}: {error.strerror}") from error
    if len(data) > MAX_BYTES:
        raise LimitError(f"{path.name} is larger than {MAX_BYTES // 1_000_000} MB")
    return data


def decode(data: bytes, max_pixels: int = MAX_PIXELS) -> NDArray[np.uint8]:
    """Decode a picture.

    Parameters
    ----------
    data : bytes
        A whole file.
    max_pixels : int

    Returns
    -------
    (H, W, 3) uint8
        BGR, as stored: orientation tags are ignored.

    Raises
    ------
    ImageError
        If it is no picture of a known format, or damaged or cut off.
    LimitError
        If it has more pixels; known from its header, nothing is decoded.
    """
    header = read_header(data, max_pixels)
    if _cut_off(header.format, data):
        raise ImageError(
            f"the {header.format} file is cut off: it ends before the picture does; copy it again "
            "from its source",
            code="truncated_image",
        )
    try:
        image = cv2.imdecode(np.frombuffer(data, np.uint8), _FLAGS)
    except cv2.error as error:
        if "Insufficient memory" in str(error):
            raise
        image = None
    if image is None or image.shape != (header.height, header.width, 3):
        raise ImageError(
            f"the {header.format} file is damaged and cannot be decoded; copy it again from its "
            "source, or save it anew as PNG or JPEG"
        )
    return np.asarray(image, np.uint8)


def read_header(data: bytes, max_pixels: int = MAX_PIXELS) -> ImageHeader:
    """Format and size of a picture, without decoding it; raises as `decode`."""
    if not data:
        raise ImageError("the file is empty; choose a picture", code="empty_file")
    try:
        content.refuse_raw(data)
        with warnings.catch_warnings():
            # Nothing is decoded here, and the size is checked below.
            warnings.simplefilter("ignore")
            with PillowImage.open(io.BytesIO(data), formats=_FORMATS) as image:
                width, height = image.size
                # A JPEG with a preview inside counts as JPEG.
                name = "JPEG" if image.format == "MPO" else str(image.format)
    except PillowImage.DecompressionBombError as error:
        raise LimitError(
            f"the picture has more than {max_pixels / 1e6:g} megapixels, the limit; scale it "
            "down, or cut it",
            code="too_many_pixels",
        ) from error
    except ContentError as error:
        raise ImageError(error.message, code="not_an_image") from error
    except (UnidentifiedImageError, OSError, ValueError, SyntaxError, struct.error) as error:
        _refuse_by_name(data)
        raise ImageError(
            f"the file is no picture that can be read; send a {_READABLE} file",
            code="not_an_image",
        ) from error
    if width < 1 or height < 1:
        raise ImageError("the picture has no pixels; choose another")
    if width * height > max_pixels:
        raise LimitError(
            f"the picture is {width} x {height}, {width * height / 1e6:.0f} megapixels; the limit "
            f"is {max_pixels / 1e6:g}: scale it down, or cut it",
            code="too_many_pixels",
            detail={"width": width, "height": height, "max_pixels": max_pixels},
        )
    return ImageHeader(name, width, height)


def _refuse_by_name(data: bytes) -> None:
    """Say what a file is that is known and cannot be read."""
    try:
        content.identify(data[: content.HEAD_BYTES])
    except ContentError as error:
        if error.error_code == ContentError.code and content.READABLE not in error.message:
            raise ImageError(error.message, code="not_an_image") from error


def _cut_off(name: str, data: bytes) -> bool:
    """True where the file ends early; decoders fill the rest with grey, or say nothing."""
    if name == "JPEG":
        return not _jpeg_ends(data)
    if name == "PNG":
        return not _png_ends(data)
    if name == "WEBP":
        return len(data) < 8 + int.from_bytes(data[4:8], "little")
    if name == "BMP":
        return len(data) < int.from_bytes(data[2:6], "little")
    return False


def _jpeg_ends(data: bytes) -> bool:
    """Follow the segments of the first picture (ITU-T T.81, annex B) to its end marker."""
    place = 0
    while marker := _JPEG_MARKER.search(data, place):
        kind, place = marker[1][0], marker.end()
        if kind == _JPEG_END:
            return True
        if kind not in _JPEG_BARE:
            place += int.from_bytes(data[place : place + 2], "big")
    return False


def _png_ends(data: bytes) -> bool:
    """Follow the chunks (ISO/IEC 15948, clause 5) to IEND."""
    place = 8
    while place + 12 <= len(data):
        length, kind = struct.unpack_from(">I4s", data, place)
        place += 12 + length
        if kind == b"IEND":
            return bool(place <= len(data))
    return False
