"""What may be uploaded: sizes, room, content."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from padstudio.errors import BusyError, LimitError, StorageError
from padstudio.media import content, images, zip_stills
from padstudio.media.content import Content
from padstudio.media.live_files import live_members
from padstudio.media.recordings.folders import members_of
from padstudio.media.zip_stills import ZipLimits
from padstudio.store.uploads.files import read_head
from padstudio.store.uploads.rows import Upload


@dataclass(frozen=True)
class UploadLimits:
    """How much may be uploaded.

    Attributes
    ----------
    file_bytes : int
        One upload.
    total_bytes : int
        All of them together; equal files count once.
    unfinished : int
        Uploads under way at a time.
    expires_s : float
        An unfinished upload that gets no bytes for so long is removed.
    telemetry_bytes : int
        Also of the texts of a live session's recording.
    still_pixels : int
    zip : ZipLimits
    """

    file_bytes: int = 32_000_000_000
    total_bytes: int = 200_000_000_000
    unfinished: int = 1000
    expires_s: float = 86_400.0
    telemetry_bytes: int = 64_000_000
    still_pixels: int = images.MAX_PIXELS
    zip: ZipLimits = field(default_factory=ZipLimits)


def examine(path: Path, limits: UploadLimits) -> Content:
    """What a whole file is.

    Raises
    ------
    ContentError, ImageError, LimitError
        If it is of no use, or beyond a limit. Videos and recordings are looked into where they are
        decoded.
    """
    found, size_bytes = content.identify(read_head(path)), path.stat().st_size
    most = {
        "still": images.MAX_BYTES,
        "telemetry": limits.telemetry_bytes,
        "live": limits.telemetry_bytes,
    }
    limit = most.get(found.kind, size_bytes)
    if size_bytes > limit:
        raise LimitError(
            f"the {found.kind} file has {size_bytes / 1e6:.0f} MB; the limit is {limit / 1e6:g} MB"
        )
    if found.kind == "still":
        images.read_header(path.read_bytes(), limits.still_pixels)
    elif found.kind == "stills":
        if live_members(path, limits.zip):
            found = content.LIVE_ZIP
        elif members_of(path, limits.zip):
            found = content.BAG_ZIP
        else:
            zip_stills.list_stills(path, limits.zip)
    return found


def check_size(size_bytes: int, limits: UploadLimits) -> None:
    """Raise `ContentError` or `LimitError` where a file is empty or too large."""
    if size_bytes < 1:
        content.identify(b"")
    if size_bytes > limits.file_bytes:
        raise LimitError(
            f"the file has {_size(size_bytes)}; the limit is {_size(limits.file_bytes)}: "
            "cut the video, or send it in parts",
            detail={"max_bytes": limits.file_bytes},
        )


def check_room(
    size_bytes: int,
    unfinished: Sequence[Upload],
    kept_bytes: int,
    free_bytes: int,
    limits: UploadLimits,
) -> None:
    """Refuse a file that there is no room for.

    Parameters
    ----------
    size_bytes : int
        Of the new file.
    unfinished : sequence of Upload
    kept_bytes : int
        What complete uploads take.
    free_bytes : int
        Room on the disk.
    limits : UploadLimits

    Raises
    ------
    BusyError, StorageError
    """
    if len(unfinished) >= limits.unfinished:
        raise BusyError(
            f"{len(unfinished)} uploads are unfinished, the limit; finish or remove some",
            code="too_many_uploads",
        )
    taken = kept_bytes + sum(upload.size_bytes for upload in unfinished)
    if taken + size_bytes > limits.total_bytes:
        raise StorageError(
            f"uploads take {_size(taken)} of the {_size(limits.total_bytes)} that they may, and "
            f"this one has {_size(size_bytes)}; remove some",
            code="quota_exceeded",
        )
    # What the others still have to send is as good as taken.
    coming = sum(upload.size_bytes - upload.offset for upload in unfinished)
    if size_bytes + coming > free_bytes:
        raise StorageError(
            f"the disk has {_size(max(0, free_bytes - coming))} of room, and this upload has "
            f"{_size(size_bytes)}; make room and try again",
            code="disk_full",
        )


def _size(count: int) -> str:
    """Bytes, as people read them."""
    return f"{count / 1e9:.4g} GB" if count >= 1e9 else f"{count / 1e6:.3g} MB"
