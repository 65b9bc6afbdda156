"""Finds the pictures and videos that paths, folders and patterns stand for."""

from __future__ import annotations

import glob
import re
from collections.abc import Iterable
from pathlib import Path

from padstudio.errors import NotFoundError
from padstudio.media import content
from padstudio.media.content import ContentError

#: Endings of the names of pictures; with those of videos, what folders are searched for.
SUFFIXES = frozenset({".bmp", ".jpeg", ".jpg", ".png", ".tif", ".tiff", ".webp"})
VIDEO_SUFFIXES = frozenset(
    {".avi", ".m2ts", ".m4v", ".mkv", ".mov", ".mp4", ".mts", ".ts", ".webm"}
)


def find_frames(sources: Iterable[str]) -> list[Path]:
    """Pictures and videos from paths, folders and glob patterns, in that order, each once.

    A folder stands for the pictures and videos right in it; a pattern may hold ``**``. Those of one
    folder or pattern are sorted by name, with numbers by value. A file named outright is taken
    whatever its ending.

    Raises
    ------
    NotFoundError
        If a source does not exist or holds neither.
    """
    found: dict[Path, None] = {}
    for source in sources:
        some = _expand(source)
        if not some:
            raise NotFoundError(
                f"{source}: no picture or video there; give existing files, folders or patterns",
                code="no_such_file",
            )
        found |= dict.fromkeys(sorted(some, key=lambda path: by_number(str(path))))
    return list(found)


def _expand(source: str) -> list[Path]:
    path = Path(source)
    # An empty text is no name, though it would make the path of the current folder.
    if not source:
        return []
    if path.is_dir():
        return [p for p in path.iterdir() if _is_wanted(p)]
    # A name that exists is that file, even if it looks like a pattern.
    if path.exists():
        return [path]
    return [p for p in map(Path, glob.glob(source, recursive=True)) if _is_wanted(p)]


def _is_wanted(path: Path) -> bool:
    return path.suffix.lower() in SUFFIXES | VIDEO_SUFFIXES and path.is_file()


def is_video(path: Path) -> bool:
    """True for a video by its content, or, where the content is nothing known, by its name."""
    try:
        with path.open("rb") as file:
            return content.identify(file.read(content.HEAD_BYTES)).kind == "video"
    except (ContentError, OSError):
        return path.suffix.lower() in VIDEO_SUFFIXES


def by_number(name: str) -> list[tuple[int, int, str]]:
    """Sorts names with the numbers in them by value: ``a2`` before ``a10``."""
    parts = re.split(r"(\d+)", name)
    return [(0, int(part), "") if part.isdecimal() else (1, 0, part) for part in parts]
