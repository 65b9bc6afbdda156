"""Small pictures of a flight's frames, written while the frames are decoded anyway.

A page steps, jumps and plays through these *proxies*, whatever keyframes the video has. They lie in
groups of frames that follow each other, one file or a few a group: a file holds the frames that one
task had of the group. A file is written whole or not at all, and never changed.
"""

from __future__ import annotations

import json
import logging
import os
import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from padstudio.arrays import Array, Image, YuvFrame
from padstudio.media.video_frames import VideoPicture

logger = logging.getLogger(__name__)

#: Frames of a group.
GROUP_FRAMES = 16
#: A picture is halved until it is no wider. Halving is what OpenCV does ten times as fast as any
#: other reduction: the whole proxy costs 2 to 4 ms of a frame's 40 to 80.
MOST_WIDTH_PX = 1024
# Of JPEG. 60 KB a picture of noisy ground; at 80 a quarter more, and it looks alike.
_QUALITY = 70
_LENGTH_BYTES = 4
_NAME = re.compile(r"(\d{7,})-(\d\d)-(\d\d)\.proxies")
# Of red and blue in brightness; ITU-R BT.601 and BT.709.
_WEIGHTS = {"bt601": (0.299, 0.114), "bt709": (0.2126, 0.0722)}


@dataclass(frozen=True)
class ProxyTarget:
    """Where the proxies of a flight's frames lie.

    Attributes
    ----------
    folder : str
        Made where it is missing.
    phase, stride : int
        Frame ``phase + place * stride`` has that place; `GROUP_FRAMES` places are a group.
    """

    folder: str
    phase: int
    stride: int

    def place(self, frame: int) -> tuple[int, int]:
        """The group of a frame, and its place there."""
        return divmod((frame - self.phase) // self.stride, GROUP_FRAMES)

    def frames(self, group: int) -> range:
        """The numbers of a group's frames."""
        first = self.phase + group * GROUP_FRAMES * self.stride
        return range(first, first + GROUP_FRAMES * self.stride, self.stride)

    def files(self) -> dict[int, list[Path]]:
        """The files of each group."""
        found: dict[int, list[Path]] = {}
        for name in _names(self.folder):
            match = _NAME.fullmatch(name)
            if match:
                found.setdefault(int(match[1]), []).append(Path(self.folder, name))
        return found


@dataclass(frozen=True)
class Proxy:
    """One frame's small picture.

    Attributes
    ----------
    frame : int
    time_s : float or None
    size : (width, height)
        Pixels of the whole frame; (0, 0) where it was lost.
    scale : int
        Pixels of the frame per pixel of the proxy; odd rests at the right and below are left out.
    jpeg : bytes
        Empty where the frame was lost.
    """

    frame: int
    time_s: float | None
    size: tuple[int, int] = (0, 0)
    scale: int = 1
    jpeg: bytes = b""


class ProxyWriter:
    """Writes the proxies of frames that come in the order of their numbers.

    Parameters
    ----------
    target : ProxyTarget or None
        None writes nothing.
    must : bool
        Raise what goes wrong. Beside an analysis it is logged and costs no frame its result, as
        proxies can be made again.
    """

    def __init__(self, target: ProxyTarget | None, *, must: bool = False) -> None:
        self._target, self._group, self._must = target, -1, must
        self._held: list[Proxy] = []
        self._known = _covered(target) if target else set()

    def __enter__(self) -> ProxyWriter:
        return self

    def __exit__(self, *_: object) -> None:
        self._guarded(self._flush)

    def beside(
        self,
        pictures: Iterable[VideoPicture],
        frames: Iterable[int],
        time_of: Callable[[int], float],
    ) -> Iterator[VideoPicture]:
        """The pictures of a video with these numbers, each kept on the way."""
        for picture, frame in zip(pictures, frames, strict=False):
            self.add(frame, time_of(picture.pts), picture.frame)
            yield picture

    def add(self, frame: int, time_s: float | None, picture: Image | YuvFrame | None) -> None:
        """Take the next frame; None where it was lost."""
        if self._target is not None and frame not in self._known:
            self._guarded(lambda: self._add(frame, time_s, picture))

    def _add(self, frame: int, time_s: float | None, picture: Image | YuvFrame | None) -> None:
        assert self._target is not None
        group, place = self._target.place(frame)
        if group != self._group:
            self._flush()
            self._group = group
        self._held.append(encode(frame, time_s, picture))
        if place == GROUP_FRAMES - 1:
            self._flush()

    def _flush(self) -> None:
        held, self._held = self._held, []
        if not held or self._target is None:
            return
        places = [self._target.place(proxy.frame)[1] for proxy in held]
        folder = Path(self._target.folder)
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / f"{self._group:07d}-{places[0]:02d}-{places[-1]:02d}.proxies"
        # Two tasks may be at the same frames, of two runs of one video.
        part = path.with_suffix(f".{os.getpid()}")
        part.write_bytes(packed(held, {}))
        part.replace(path)

    def _guarded(self, act: Callable[[], None]) -> None:
        try:
            act()
        except (OSError, cv2.error):
            if self._must:
                raise
            logger.exception("proxies cannot be written; going on without")
            self._target, self._held = None, []


def encode(frame: int, time_s: float | None, picture: Image | YuvFrame | None) -> Proxy:
    """The proxy of a frame: halved until it is small, as JPEG.

    Planes are reduced as they lie in the decoder's memory, and only then turned into colours.
    """
    if picture is None:
        return Proxy(frame, time_s)
    height, width = picture.shape[:2]
    halvings = max(0, int(np.ceil(np.log2(width / MOST_WIDTH_PX))))
    if isinstance(picture, YuvFrame):
        small = _colours(picture, halvings)
    else:
        small = _halved(picture, halvings)
    done, data = cv2.imencode(".jpg", small, [cv2.IMWRITE_JPEG_QUALITY, _QUALITY])
    if not done:
        raise cv2.error("a proxy could not be encoded")
    return Proxy(frame, time_s, (width, height), 2**halvings, data.tobytes())


def packed(proxies: list[Proxy], about: dict[str, Any]) -> bytes:
    """A file of proxies: the length of a JSON object, uint32 little-endian, the object, and JPEGs.

    Parameters
    ----------
    proxies : list of Proxy
    about : dict
        More members of the object, whose ``frames`` lists the proxies with the ``bytes`` of each.
    """
    listed = [
        {
            "frame": proxy.frame,
            "time_s": proxy.time_s,
            "width": proxy.size[0],
            "height": proxy.size[1],
            "scale": proxy.scale,
            "bytes": len(proxy.jpeg),
        }
        for proxy in proxies
    ]
    head = json.dumps(about | {"frames": listed}, separators=(",", ":")).encode()
    return b"".join(
        [len(head).to_bytes(_LENGTH_BYTES, "little"), head, *(proxy.jpeg for proxy in proxies)]
    )


def unpacked(data: bytes) -> list[Proxy]:
    """The proxies of a file that `packed` made."""
    start = _LENGTH_BYTES + int.from_bytes(data[:_LENGTH_BYTES], "little")
    proxies = []
    for entry in json.loads(data[_LENGTH_BYTES:start])["frames"]:
        end = start + entry["bytes"]
        size = entry["width"], entry["height"]
        proxies.append(
            Proxy(entry["frame"], entry["time_s"], size, entry["scale"], data[start:end])
        )
        start = end
    return proxies


def _covered(target: ProxyTarget) -> set[int]:
    """Frames that have a proxy already."""
    found: set[int] = set()
    for name in _names(target.folder):
        match = _NAME.fullmatch(name)
        if match:
            group, first, last = map(int, match.groups())
            found.update(target.frames(group)[first : last + 1])
    return found


def _names(folder: str) -> list[str]:
    try:
        return os.listdir(folder)
    except OSError:
        # Not made yet; who writes there learns of anything worse.
        return []


def _halved(plane: Image, times: int) -> Image:
    for _ in range(times):
        height, width = (max(2, side // 2 * 2) for side in plane.shape[:2])
        even = plane[:height, :width]
        # Whole pairs, which alone are quick; a side of one pixel has none.
        size = (max(1, even.shape[1] // 2), max(1, even.shape[0] // 2))
        plane = np.asarray(cv2.resize(even, size, interpolation=cv2.INTER_AREA), np.uint8)
    return plane


def _colours(frame: YuvFrame, halvings: int) -> Image:
    """BGR of a frame in planes; colour is half as fine as brightness, and halved once less."""
    y = _halved(np.asarray(frame.y[:, : frame.width]), halvings)
    height, width = y.shape
    half = -(-frame.width // 2)
    u, v = (_halved(np.asarray(p[:, :half]), max(0, halvings - 1)) for p in (frame.u, frame.v))
    if u.shape != y.shape:
        u, v = (np.asarray(cv2.resize(p, (width, height)), np.uint8) for p in (u, v))
    planes = cv2.merge([y, u, v])
    return np.asarray(cv2.transform(planes, _matrix(frame)), np.uint8)


def _matrix(frame: YuvFrame) -> Array:
    """(3, 4) from brightness and colour differences to BGR."""
    red, blue = _WEIGHTS[frame.standard]
    green = 1 - red - blue
    gain, black = frame.gain
    # Colour differences span 224 steps, or all 255.
    chroma = 1.0 if frame.full_range else 255 / 224
    of_u, of_v = 2 * (1 - blue) * chroma, 2 * (1 - red) * chroma
    rows = np.array(
        [
            [gain, of_u, 0.0],
            [gain, -of_u * blue / green, -of_v * red / green],
            [gain, 0.0, of_v],
        ]
    )
    offset = -rows @ np.array([black, 128.0, 128.0])
    return np.column_stack([rows, offset])
