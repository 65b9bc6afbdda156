"""Stills of zips that lie wherever fsspec reaches."""

from __future__ import annotations

from pathlib import Path

from padstudio.media import zip_stills
from padstudio.media.remote import local_path


def list_members(url: str) -> list[str]:
    """As `padstudio.media.zip_stills.list_stills`."""
    return zip_stills.list_stills(_at_hand(url))


def read_member(url: str, name: str) -> bytes:
    """As `padstudio.media.zip_stills.read_still`."""
    return zip_stills.read_still(_at_hand(url), name)


def _at_hand(url: str) -> Path:
    path = local_path(url)
    if path is not None:
        return path
    import fsspec

    # One copy a machine, kept while the process lives: stills are read one by one.
    return Path(fsspec.open_local(f"simplecache::{url}"))
