"""What an uploaded file is, by its first bytes; its name does not count."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal

from padstudio.errors import StudioError

Kind = Literal["video", "still", "stills", "telemetry"]

#: Bytes that `identify` wants to see; a shorter file is enough as it is.
HEAD_BYTES = 4096

READABLE = (
    "send a video (MP4, MOV, MKV, AVI, WebM, MPEG-TS), a still (JPEG, PNG, WebP, TIFF, BMP), a zip "
    "of stills or an SRT telemetry file"
)


class ContentError(StudioError):
    """A file is of no kind that can be used."""

    code = "unknown_content"
    status = 422


@dataclass(frozen=True)
class Content:
    """What a file is.

    Attributes
    ----------
    kind : {"video", "still", "stills", "telemetry"}
        ``stills`` is a zip.
    media_type : str
    suffix : str
        The usual ending of such files, with its dot.
    """

    kind: Kind
    media_type: str
    suffix: str


MP4 = Content("video", "video/mp4", ".mp4")
MOV = Content("video", "video/quicktime", ".mov")
MKV = Content("video", "video/matroska", ".mkv")
WEBM = Content("video", "video/webm", ".webm")
AVI = Content("video", "video/vnd.avi", ".avi")
MPEGTS = Content("video", "video/mp2t", ".ts")
JPEG = Content("still", "image/jpeg", ".jpg")
PNG = Content("still", "image/png", ".png")
WEBP = Content("still", "image/webp", ".webp")
TIFF = Content("still", "image/tiff", ".tif")
BMP = Content("still", "image/bmp", ".bmp")
ZIP = Content("stills", "application/zip", ".zip")
SRT = Content("telemetry", "application/x-subrip", ".srt")

_STARTS = {
    b"\xff\xd8\xff": JPEG,
    b"\x89PNG\r\n\x1a\n": PNG,
    b"II*\0": TIFF,
    b"MM\0*": TIFF,
    b"PK\x03\x04": ZIP,
}
_RIFF = {b"AVI ": AVI, b"WEBP": WEBP}
# ISO/IEC 14496-12 boxes that QuickTime files older than the file type box begin with.
_OLD_MOV = (b"moov", b"mdat", b"wide", b"free", b"skip", b"pnot")
_PICTURE_BRANDS = (b"heic", b"heix", b"hevc", b"mif1", b"msf1", b"avif", b"avis", b"crx ")
# Sizes of the headers that follow a BMP's file header.
_BMP_HEADERS = (12, 40, 52, 56, 64, 108, 124)
_SRT = re.compile(
    r"\s*\d+\s*\r?\n\s*\d{1,2}:\d\d:\d\d[,.]\d{1,3}\s*-->\s*\d{1,2}:\d\d:\d\d[,.]\d{1,3}"
)


def identify(head: bytes) -> Content:
    """Tell a file's kind.

    Parameters
    ----------
    head : bytes
        The first `HEAD_BYTES`, or the whole of a shorter file.

    Raises
    ------
    ContentError
        If it is none of the kinds that Pad Studio reads.
    """
    if not head:
        raise ContentError(f"the file is empty; {READABLE}", code="empty_file")
    content = _by_signature(head) or _by_boxes(head)
    if content is None and _SRT.match(head.decode("utf-8-sig", "replace")):
        content = SRT
    if content is None:
        raise ContentError(f"the file's content is of no kind that can be read; {READABLE}")
    return content


def _by_signature(head: bytes) -> Content | None:
    for start, content in _STARTS.items():
        if head.startswith(start):
            return content
    if head[:4] == b"RIFF":
        return _RIFF.get(head[8:12])
    if head[:4] == b"\x1a\x45\xdf\xa3":
        return _matroska(head)
    if head[:2] == b"BM" and int.from_bytes(head[14:18], "little") in _BMP_HEADERS:
        return BMP
    # Packets of 188 bytes, each begun by one byte (ISO/IEC 13818-1).
    starts = head[:753:188]
    if len(starts) >= 3 and set(starts) == {0x47}:
        return MPEGTS
    if head[:4] == b"PK\x05\x06":
        raise ContentError("the zip is empty; put the stills into it", code="empty_zip")
    return None


def _matroska(head: bytes) -> Content | None:
    """By the EBML header's DocType (RFC 8794, element 0x4282)."""
    found = re.search(rb"\x42\x82[\x80-\xff]([a-z]+)", head)
    return {b"matroska": MKV, b"webm": WEBM}.get(found[1]) if found else None


def _by_boxes(head: bytes) -> Content | None:
    kind, brand = head[4:8], head[8:12]
    if kind == b"ftyp" and brand in _PICTURE_BRANDS:
        raise ContentError(
            f"a {brand.decode().strip()} picture cannot be read; convert it to JPEG or PNG"
        )
    if kind == b"ftyp":
        return MOV if brand == b"qt  " else MP4
    return MOV if kind in _OLD_MOV else None
