"""Pictures for a calibration: stills, zips of stills, and the sharpest frames of a clip.

They are decoded whenever they are asked for: sixty of them together would not fit into a worker.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import overload

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Image
from padstudio.bounded_files import open_regular
from padstudio.calibration.calibrate import MOST_PICTURES, check_count
from padstudio.errors import CalibrationError, LimitError, StudioError
from padstudio.media import content, images, zip_stills
from padstudio.media.recordings import frames as recordings
from padstudio.media.recordings import index as recordings_index
from padstudio.media.recordings.folders import members_of
from padstudio.media.sources import is_bag
from padstudio.media.video_frames import VideoPicture, read_frames
from padstudio.media.video_index import read_index

#: Of a clip so many frames are taken.
CLIP_PICTURES = 24
# From so many frames, evenly spread, each of them is the sharpest.
_CANDIDATES = 5
#: Of all pictures together; a calibration keeps 3 bytes of each pixel at the most.
MOST_PIXELS = 750_000_000
# Frames are packed without loss, and fast rather than small.
_PACKED = [cv2.IMWRITE_PNG_COMPRESSION, 1]


@dataclass(frozen=True, eq=False)
class NamedPicture:
    """A picture and what it is called.

    Attributes
    ----------
    name : str
        The file's, and in a clip the frame's number.
    size : (width, height)
    decode : callable
        Gives the picture.
    """

    name: str
    size: tuple[int, int]
    decode: Callable[[], Image]

    @property
    def image(self) -> Image:
        """The picture (H, W, 3) uint8, BGR, decoded anew."""
        with _said_of(self.name):
            return self.decode()


class DecodedInTurn(Sequence[Image]):
    """Pictures that are decoded whenever they are asked for.

    Parameters
    ----------
    shown : sequence of NamedPicture
    """

    def __init__(self, shown: Sequence[NamedPicture]) -> None:
        self._shown = shown

    def __len__(self) -> int:
        return len(self._shown)

    @overload
    def __getitem__(self, which: int) -> Image: ...
    @overload
    def __getitem__(self, which: slice) -> Sequence[Image]: ...
    def __getitem__(self, which: int | slice) -> Image | Sequence[Image]:
        if isinstance(which, slice):
            return DecodedInTurn(self._shown[which])
        return self._shown[which].image


def read_pictures(
    files: Sequence[tuple[str, Path]],
    *,
    max_pixels: int = images.MAX_PIXELS,
    read: Callable[[], None] = lambda: None,
) -> list[NamedPicture]:
    """Find what a calibration is to rest on, and see that all of it can be read.

    Parameters
    ----------
    files : sequence of (name, path)
        Stills, zips of stills, videos. They must stay where they are.
    max_pixels : int
        Of one picture.
    read : callable
        Called after each picture.

    Raises
    ------
    CalibrationError
        If there are fewer than 3 pictures, or more than 60, or they differ in size.
    ImageError, LimitError, VideoError, ContentError
        If a file cannot be read, which the message names, or they are too large together.
    """
    out: list[NamedPicture] = []
    for name, path in files:
        for picture in _pictures_of(name, path, max_pixels):
            out.append(picture)
            _check_number(len(out))
            _check_size(picture, out[0], len(out))
            read()
    check_count(len(out))
    return out


def _check_number(count: int) -> None:
    if count > MOST_PICTURES:
        raise CalibrationError(
            f"these are more than {MOST_PICTURES} pictures; choose those that differ most"
        )


def _check_size(picture: NamedPicture, first: NamedPicture, count: int) -> None:
    (width, height), (first_width, first_height) = picture.size, first.size
    if picture.size != first.size:
        raise CalibrationError(
            f"{picture.name} is {width} x {height}, {first.name} {first_width} x {first_height}; "
            "give pictures of one camera in one mode"
        )
    if count * width * height > MOST_PIXELS:
        raise LimitError(
            f"these are more than {MOST_PIXELS // (width * height)} pictures of {width} x "
            f"{height}, {MOST_PIXELS / 1e6:g} megapixels, the limit; choose those that differ most",
            code="too_many_pixels",
        )


def _pictures_of(name: str, path: Path, max_pixels: int) -> Iterator[NamedPicture]:
    with _said_of(name):
        kind = _kind_of(path)
    if kind in ("video", "recording"):
        yield from _sharpest_frames(name, path, max_pixels, kind)
    elif kind == "stills":
        with _said_of(name):
            stills = zip_stills.list_stills(path)
        _check_number(len(stills))
        for still in stills:
            yield _named(still, partial(_still_of, path, still, max_pixels))
    else:
        yield _named(name, partial(images.read, path, max_pixels))


def _kind_of(path: Path) -> content.Kind:
    if is_bag(path):
        return "recording"
    with open_regular(path) as file:
        kind = content.identify(file.read(content.HEAD_BYTES)).kind
    if kind == "stills" and members_of(path, zip_stills.ZipLimits()):
        return "recording"
    return kind


def _named(name: str, decode: Callable[[], Image]) -> NamedPicture:
    """A picture that can be decoded, as is seen here."""
    with _said_of(name):
        height, width = decode().shape[:2]
    return NamedPicture(name, (width, height), decode)


def _still_of(path: Path, still: str, max_pixels: int) -> Image:
    return images.decode(zip_stills.read_still(path, still), max_pixels)


@contextmanager
def _said_of(name: str) -> Iterator[None]:
    """Begin messages of errors with the name of the file that they are about."""
    try:
        yield
    except StudioError as error:
        message = error.message if name in error.message else f"{name}: {error.message}"
        raise type(error)(message, code=error.error_code, detail=error.detail) from error


def _sharpest_frames(
    name: str, path: Path, max_pixels: int, kind: content.Kind
) -> Iterator[NamedPicture]:
    """The sharpest of each few frames, evenly spread over a clip."""
    with _said_of(name):
        numbers, shown = _spread_frames(path.as_posix(), max_pixels, kind)
        best: tuple[float, int, Image] | None = None
        per_picture = -(-len(numbers) // CLIP_PICTURES)
        for place, (number, picture) in enumerate(zip(numbers, shown, strict=False)):
            image = None if picture.is_damaged else picture.bgr
            if image is not None:
                sharpness = _sharpness(image)
                if best is None or sharpness > best[0]:
                    best = sharpness, number, image
            if (place + 1) % per_picture == 0 or place + 1 == len(numbers):
                if best is not None:
                    yield _packed(f"{name} #{best[1]}", best[2])
                best = None


def _packed(name: str, image: Image) -> NamedPicture:
    """A frame as a file in memory; from the clip it would take all frames since a keyframe."""
    _, data = cv2.imencode(".png", image, _PACKED)
    packed = data.tobytes()
    height, width = image.shape[:2]
    return NamedPicture(name, (width, height), partial(_unpacked, packed))


def _unpacked(packed: bytes) -> Image:
    return np.asarray(cv2.imdecode(np.frombuffer(packed, np.uint8), cv2.IMREAD_COLOR), np.uint8)


def _sharpness(image: Image) -> float:
    """Variance of the Laplacian at half the scale, where noise counts less."""
    grey = cv2.cvtColor(cv2.pyrDown(image), cv2.COLOR_BGR2GRAY)
    return float(cv2.Laplacian(grey, cv2.CV_32F).var())


def _spread_frames(
    source: str, max_pixels: int, kind: content.Kind
) -> tuple[NDArray[np.int64], Iterator[VideoPicture]]:
    """Numbers of evenly spread frames of a video or a recording, and these frames."""
    if kind == "recording":
        found = recordings_index.read_index(source, max_pixels=max_pixels)
        numbers = _spread(len(found.video.pts))
        pts = found.video.pts[numbers].tolist()
        return numbers, recordings.read_frames(source, pts, found.times, max_pixels=max_pixels)
    index = read_index(source, max_pixels=max_pixels)
    numbers = _spread(len(index.pts))
    pts = index.pts[numbers].tolist()
    return numbers, read_frames(source, pts, is_counted=index.is_counted, max_pixels=max_pixels)


def _spread(frames: int) -> NDArray[np.int64]:
    count = min(frames, CLIP_PICTURES * _CANDIDATES)
    return np.unique(np.linspace(0, frames - 1, count).round().astype(np.int64))
