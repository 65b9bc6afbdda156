"""Finds the pictures, videos and recordings that paths, folders and patterns stand for."""

from __future__ import annotations

import glob
import re
from collections.abc import Iterable
from pathlib import Path

from padstudio.bounded_files import open_regular
from padstudio.errors import NotFoundError
from padstudio.media import content
from padstudio.media.content import ContentError

#: Endings of the names of pictures; with those of videos, what folders are searched for.
SUFFIXES = frozenset({".bmp", ".jpeg", ".jpg", ".png", ".tif", ".tiff", ".webp"})
VIDEO_SUFFIXES = frozenset(
    {".avi", ".m2ts", ".m4v", ".mkv", ".mov", ".mp4", ".mts", ".ts", ".webm"}
)

RECORDING_SUFFIXES = frozenset({".bag", ".db3", ".mcap"})
#: The file that makes a folder a ROS 2 bag.
BAG_METADATA = "metadata.yaml"


def find_frames(sources: Iterable[str]) -> list[Path]:
    """Pictures, videos and recordings from paths, folders and glob patterns, each once.

    A folder stands for those right in it, but a ROS 2 bag's folder for the bag; a pattern may hold
    ``**``. Those of one folder or pattern are sorted by name, with numbers by value. A file named
    outright is taken whatever its ending.

    Raises
    ------
    NotFoundError
        If a source does not exist or holds none.
    """
    found: dict[Path, None] = {}
    for source in sources:
        some = _expand(source)
        if not some:
            raise NotFoundError(
                f"{source}: no picture, video or recording there; give existing files, folders or "
                "patterns",
                code="no_such_file",
            )
        found |= dict.fromkeys(sorted(some, key=lambda path: by_number(str(path))))
    return list(found)


def _expand(source: str) -> list[Path]:
    path = Path(source)
    # An empty text is no name, though it would make the path of the current folder.
    if not source:
        return []
    if is_bag(path):
        return [path]
    if path.is_dir():
        return [p for p in path.iterdir() if _is_wanted(p)]
    # A name that exists is that file, even if it looks like a pattern.
    if path.exists():
        if not path.is_file():
            raise NotFoundError(
                f"{source} is no file but a device, a pipe or a socket; give a file, or read a "
                "stream with padstudio live",
                code="no_regular_file",
            )
        return [path]
    return [p for p in map(Path, glob.glob(source, recursive=True)) if _is_wanted(p)]


def _is_wanted(path: Path) -> bool:
    known = SUFFIXES | VIDEO_SUFFIXES | RECORDING_SUFFIXES
    return is_bag(path) or (path.suffix.lower() in known and path.is_file())


def is_bag(path: Path) -> bool:
    """True for a ROS 2 bag's folder."""
    return path.is_dir() and (path / BAG_METADATA).is_file()


def kind_of(path: Path) -> content.Kind:
    """What a source is: by its content, or, where that is nothing known, by its name."""
    if is_bag(path):
        return "recording"
    try:
        with open_regular(path) as file:
            return content.identify(file.read(content.HEAD_BYTES)).kind
    except (ContentError, OSError):
        suffix = path.suffix.lower()
        if suffix in RECORDING_SUFFIXES:
            return "recording"
        return "video" if suffix in VIDEO_SUFFIXES else "still"


def by_number(name: str) -> list[tuple[int, int, str]]:
    """Sorts names with the numbers in them by value: ``a2`` before ``a10``."""
    parts = re.split(r"(\d+)", name)
    digits = [part.lstrip("0") if part.isdecimal() else None for part in parts]
    # Of numbers without leading zeros the longer one is larger, however long they are.
    return [
        (1, 0, part) if number is None else (0, len(number), number)
        for part, number in zip(parts, digits, strict=True)
    ]
