"""Finds the pictures that paths, folders and patterns stand for."""

from __future__ import annotations

import glob
import re
from collections.abc import Iterable
from pathlib import Path

from padstudio.errors import NotFoundError

#: File name endings that folders and patterns are searched for.
SUFFIXES = frozenset({".bmp", ".jpeg", ".jpg", ".png", ".tif", ".tiff", ".webp"})


def find_stills(sources: Iterable[str]) -> list[Path]:
    """Picture files from paths, folders and glob patterns, in that order, each once.

    A folder stands for the pictures right in it; a pattern may hold ``**``. Those of one folder or
    pattern are sorted by name, with numbers by value. A file named outright is taken whatever its
    ending.

    Raises
    ------
    NotFoundError
        If a source does not exist or holds no picture.
    """
    found: dict[Path, None] = {}
    for source in sources:
        some = _expand(source)
        if not some:
            raise NotFoundError(
                f"{source}: no picture there; give existing files, folders or patterns",
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
        return [p for p in path.iterdir() if _is_picture(p)]
    # A name that exists is that file, even if it looks like a pattern.
    if path.exists():
        return [path]
    return [p for p in map(Path, glob.glob(source, recursive=True)) if _is_picture(p)]


def _is_picture(path: Path) -> bool:
    return path.suffix.lower() in SUFFIXES and path.is_file()


def by_number(name: str) -> list[tuple[int, int, str]]:
    """Sorts names with the numbers in them by value: ``a2`` before ``a10``."""
    parts = re.split(r"(\d+)", name)
    return [(0, int(part), "") if part.isdecimal() else (1, 0, part) for part in parts]
