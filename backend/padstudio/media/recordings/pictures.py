"""Pictures of messages as frames: raw ones by their encoding, compressed ones as files.

References
----------
Encodings: ros2/common_interfaces, ``sensor_msgs/image_encodings.hpp``; formats of compressed
pictures: ros-perception/image_transport_plugins, ``compressed_image_transport``.
"""

from __future__ import annotations

from typing import NamedTuple

import cv2
import numpy as np

from padstudio.arrays import Image
from padstudio.errors import ImageError, LimitError, shown
from padstudio.media import images
from padstudio.media.recordings.messages import RecordedPicture
from padstudio.media.recordings.storage import RecordingError


class _Encoding(NamedTuple):
    """Channels and bytes of each, and what makes BGR of them; None: they are BGR."""

    channels: int
    depth: int
    conversion: int | None


_BAYER = {
    "rggb": cv2.COLOR_BayerRGGB2BGR,
    "bggr": cv2.COLOR_BayerBGGR2BGR,
    "gbrg": cv2.COLOR_BayerGBRG2BGR,
    "grbg": cv2.COLOR_BayerGRBG2BGR,
}
_ENCODINGS: dict[str, _Encoding] = {
    "8UC1": _Encoding(1, 1, cv2.COLOR_GRAY2BGR),
    "yuv422": _Encoding(2, 1, cv2.COLOR_YUV2BGR_UYVY),
    "uyvy": _Encoding(2, 1, cv2.COLOR_YUV2BGR_UYVY),
    "yuv422_yuy2": _Encoding(2, 1, cv2.COLOR_YUV2BGR_YUY2),
    "yuyv": _Encoding(2, 1, cv2.COLOR_YUV2BGR_YUY2),
}
for _bits, _depth in (("8", 1), ("16", 2)):
    _ENCODINGS[f"mono{_bits}"] = _Encoding(1, _depth, cv2.COLOR_GRAY2BGR)
    _ENCODINGS[f"bgr{_bits}"] = _Encoding(3, _depth, None)
    _ENCODINGS[f"rgb{_bits}"] = _Encoding(3, _depth, cv2.COLOR_RGB2BGR)
    _ENCODINGS[f"bgra{_bits}"] = _Encoding(4, _depth, cv2.COLOR_BGRA2BGR)
    _ENCODINGS[f"rgba{_bits}"] = _Encoding(4, _depth, cv2.COLOR_RGBA2BGR)
    for _order, _code in _BAYER.items():
        _ENCODINGS[f"bayer_{_order}{_bits}"] = _Encoding(1, _depth, _code)

#: Encodings of raw pictures that are read.
ENCODINGS = tuple(sorted(_ENCODINGS))
_COLOURS = ("rgb", "bgr")


def check_format(picture: RecordedPicture) -> None:
    """Refuse what is not read, by its name.

    Raises
    ------
    RecordingError
    """
    if picture.kind == "raw" and picture.format not in _ENCODINGS:
        raise RecordingError(
            f"the pictures' encoding {shown(picture.format)} is not read; there are "
            f"{', '.join(ENCODINGS)}",
            code="unknown_encoding",
        )
    if picture.kind == "compressed":
        told = picture.format.lower()
        if "compresseddepth" in told or told.startswith("bayer"):
            raise RecordingError(
                f"compressed pictures of the format {shown(picture.format)} are not read: they are "
                "no pictures in colours; record the raw topic, or one of rgb8 or bgr8",
                code="unknown_encoding",
            )


def size_of(picture: RecordedPicture, max_pixels: int) -> tuple[int, int]:
    """Width and height of a raw or compressed picture; raises as `to_bgr`."""
    if picture.kind == "raw":
        _check_pixels(picture.width, picture.height, max_pixels)
        return picture.width, picture.height
    header = images.read_header(bytes(picture.data), max_pixels)
    return header.width, header.height


def to_bgr(picture: RecordedPicture, max_pixels: int) -> Image:
    """A raw or compressed picture as (H, W, 3) uint8, BGR.

    Of 16 bits the upper 8 are taken, as of files with so many.

    Raises
    ------
    ImageError
        If its bytes do not make up the picture.
    LimitError
        If it has too many pixels.
    RecordingError
        If its encoding is not read.
    """
    check_format(picture)
    if picture.kind == "compressed":
        return _from_file(picture, max_pixels)
    _check_pixels(picture.width, picture.height, max_pixels)
    encoding = _ENCODINGS[picture.format]
    row_bytes = picture.width * encoding.channels * encoding.depth
    data = np.frombuffer(picture.data, np.uint8)
    if not (picture.width and picture.height) or picture.step < row_bytes:
        raise ImageError(
            f"a picture of {picture.width} x {picture.height} in {picture.format} has rows of "
            f"{picture.step} bytes, which cannot be"
        )
    if len(data) < picture.step * (picture.height - 1) + row_bytes:
        raise ImageError("a picture has fewer bytes than it needs", code="truncated_image")
    rows = np.lib.stride_tricks.as_strided(
        data, (picture.height, row_bytes), (picture.step, 1), writeable=False
    )
    if encoding.depth == 2:
        rows = rows[:, 0 if picture.is_big_endian else 1 :: 2]
    shape = (picture.height, picture.width, encoding.channels)
    pixels = np.ascontiguousarray(rows).reshape(shape if encoding.channels > 1 else shape[:2])
    if encoding.conversion is None:
        return pixels
    try:
        return np.asarray(cv2.cvtColor(pixels, encoding.conversion), np.uint8)
    except cv2.error as error:
        # Half a pair of pixels that share their colours, or a mosaic of one row.
        raise ImageError(
            f"a picture of {picture.width} x {picture.height} cannot be in {picture.format}"
        ) from error


def _from_file(picture: RecordedPicture, max_pixels: int) -> Image:
    bgr = images.decode(bytes(picture.data), max_pixels)
    before, semicolon, after = picture.format.lower().partition(";")
    # Before they named the order, publishers compressed RGB as if it were BGR.
    is_swapped = semicolon and "compressed" in after and "compressed bgr" not in after
    if is_swapped and before.strip().startswith(_COLOURS):
        return np.ascontiguousarray(bgr[:, :, ::-1])
    return bgr


def _check_pixels(width: int, height: int, max_pixels: int) -> None:
    if width * height > max_pixels:
        raise LimitError(
            f"the recording's pictures are {width} x {height}, more than {max_pixels / 1e6:g} "
            "megapixels; scale them down, or raise the limit in the settings",
            code="too_many_pixels",
        )
