"""What an uploaded file is, by its first bytes; its name does not count."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal

from padstudio.errors import StudioError

Kind = Literal["video", "recording", "still", "stills", "telemetry", "live"]

#: Bytes that `identify` wants to see; a shorter file is enough as it is.
HEAD_BYTES = 4096

READABLE = (
    "send a video (MP4, MOV, MKV, AVI, WebM, MPEG-TS, M2TS), a recording (ROS bag, MCAP), a still "
    "(JPEG, PNG, WebP, TIFF, BMP), a zip of stills or of a ROS 2 bag, telemetry (an SRT file, a "
    "ULog, DataFlash or MAVLink log, a CSV of the vehicle's poses), or what was recorded live"
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
    kind : {"video", "recording", "still", "stills", "telemetry", "live"}
        ``recording`` is of a robot, ``stills`` is a zip, ``live`` what lies beside the videos of a
        live session, or a zip of all of it.
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
M2TS = Content("video", "video/mp2t", ".m2ts")
JPEG = Content("still", "image/jpeg", ".jpg")
PNG = Content("still", "image/png", ".png")
WEBP = Content("still", "image/webp", ".webp")
TIFF = Content("still", "image/tiff", ".tif")
BMP = Content("still", "image/bmp", ".bmp")
ZIP = Content("stills", "application/zip", ".zip")
SRT = Content("telemetry", "application/x-subrip", ".srt")
MCAP = Content("recording", "application/x-mcap", ".mcap")
BAG = Content("recording", "application/x-rosbag", ".bag")
DB3 = Content("recording", "application/vnd.sqlite3", ".db3")
ZSTD = Content("recording", "application/zstd", ".zstd")
#: A zip of a ROS 2 bag's folder, or of another recording; `identify` takes all zips for stills.
BAG_ZIP = Content("recording", "application/zip", ".zip")
ULOG = Content("telemetry", "application/x-ulog", ".ulg")
DATAFLASH = Content("telemetry", "application/x-dataflash", ".bin")
TLOG = Content("telemetry", "application/x-mavlink-tlog", ".tlog")
VEHICLE_CSV = Content("telemetry", "text/csv", ".csv")
LIVE_SESSION = Content("live", "application/json", ".json")
LIVE_POSES = Content("live", "application/jsonl", ".jsonl")
#: A zip of the folder of a live session's recording; `identify` takes all zips for stills.
LIVE_ZIP = Content("live", "application/zip", ".zip")

_STARTS = {
    b"\xff\xd8\xff": JPEG,
    b"\x89PNG\r\n\x1a\n": PNG,
    b"II*\0": TIFF,
    b"MM\0*": TIFF,
    b"PK\x03\x04": ZIP,
    b"\x89MCAP0\r\n": MCAP,
    b"#ROSBAG V2.0\n": BAG,
    b"SQLite format 3\0": DB3,
    b"\x28\xb5\x2f\xfd": ZSTD,
    b"ULog\x01\x12\x35": ULOG,
    # The log's first message describes messages that describe messages, of 89 bytes each.
    b"\xa3\x95\x80\x80\x59": DATAFLASH,
}
_RIFF = {b"AVI ": AVI, b"WEBP": WEBP}
# ISO/IEC 14496-12 boxes that QuickTime files older than the file type box begin with.
_OLD_MOV = (b"moov", b"mdat", b"wide", b"free", b"skip", b"pnot")
_PICTURE_BRANDS = {
    **dict.fromkeys(
        (b"heic", b"heix", b"heim", b"heis", b"hevc", b"hevx", b"mif1", b"msf1"), "HEIC"
    ),
    **dict.fromkeys((b"avif", b"avis"), "AVIF"),
    b"crx ": "CR3",
}
# Tags of TIFF 6.0 and of DNG 1.7, and the bit of the first that marks a preview.
_NEW_SUBFILE_TYPE, _DNG_VERSION, _IS_PREVIEW = 0x00FE, 0xC612, 1
# Sizes of the headers that follow a BMP's file header.
_BMP_HEADERS = (12, 40, 52, 56, 64, 108, 124)
_SRT = re.compile(
    r"\s*(?:WEBVTT[^\r\n]*\s+)?(?:\d+\s*[\r\n]\s*)?"
    r"\d{1,2}:\d\d:\d\d[,.]\d{1,3}\s*-->\s*\d{1,2}:\d\d:\d\d[,.]\d{1,3}"
)
# What writers of such files begin them with.
_LIVE = (
    (re.compile(r'\s*\{\s*"format"\s*:\s*"padstudio\.live"'), LIVE_SESSION),
    (re.compile(r'\{"source"\s*:\s*"[^"\\]*",\s*"frame"\s*:\s*\d'), LIVE_POSES),
)
# Bytes about the payload of a packet of MAVLink 1 and 2, each after a time of 8 bytes.
_MAVLINK, _TIME_BYTES = {0xFE: 8, 0xFD: 12}, 8
# Some columns of a vehicle's track, which no other table has together.
_TRACK = {"time_s", "down_m", "qw"}


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
    if content is None:
        content = TLOG if _is_tlog(head) else _by_text(head)
    if content is None:
        raise ContentError(f"the file's content is of no kind that can be read; {READABLE}")
    return content


def is_log(head: bytes) -> bool:
    """Whether a file is a vehicle's log: ULog, DataFlash or MAVLink."""
    try:
        return identify(head) in (ULOG, DATAFLASH, TLOG)
    except ContentError:
        return False


def name_of(content: Content, sha256: str) -> str:
    """A name for a file that was sent without one: the same for the same bytes.

    Parameters
    ----------
    content : Content
    sha256 : str
        Hexadecimal, of the whole file.
    """
    return f"{content.kind}-{sha256[:8]}{content.suffix}"


def _by_signature(head: bytes) -> Content | None:
    for start, content in _STARTS.items():
        if head.startswith(start):
            refuse_raw(head)
            return content
    if head[:4] == b"RIFF":
        return _RIFF.get(head[8:12])
    if head[:4] == b"\x1a\x45\xdf\xa3":
        return _matroska(head)
    if head[:2] == b"BM" and int.from_bytes(head[14:18], "little") in _BMP_HEADERS:
        return BMP
    # Packets of 188 bytes, each begun by one byte (ISO/IEC 13818-1); on discs and in camcorders
    # four bytes of time stand before each.
    for first, step, content in ((0, 188, MPEGTS), (4, 192, M2TS)):
        starts = head[first : first + 4 * step + 1 : step]
        if len(starts) >= 3 and set(starts) == {0x47}:
            return content
    if head.startswith(b"#ROSBAG V1"):
        raise ContentError("a bag of version 1 cannot be read; bring it up to date with rosbag fix")
    if head[:4] == b"PK\x05\x06":
        raise ContentError("the zip is empty; put the stills into it", code="empty_zip")
    return None


def _matroska(head: bytes) -> Content | None:
    """By the EBML header's DocType (RFC 8794, element 0x4282)."""
    found = re.search(rb"\x42\x82[\x80-\xff]([a-z]+)", head)
    return {b"matroska": MKV, b"webm": WEBM}.get(found[1]) if found else None


def _is_tlog(head: bytes) -> bool:
    """Two packets, or one that is the whole file, each after its time."""
    if len(head) < _TIME_BYTES + 12 or head[_TIME_BYTES] not in _MAVLINK:
        return False
    signature = 13 if head[_TIME_BYTES] == 0xFD and head[_TIME_BYTES + 2] & 1 else 0
    size = _MAVLINK[head[_TIME_BYTES]] + head[_TIME_BYTES + 1] + signature
    second = 2 * _TIME_BYTES + size
    return second - _TIME_BYTES == len(head) or (second < len(head) and head[second] in _MAVLINK)


def _by_text(head: bytes) -> Content | None:
    is_wide = head[:2] in (b"\xff\xfe", b"\xfe\xff")
    text = head.decode("utf-16" if is_wide else "utf-8-sig", "replace")
    if _SRT.match(text):
        return SRT
    for begin, found in _LIVE:
        if begin.match(text):
            return found
    first = next((line for line in text.splitlines() if not line.startswith("#")), "")
    return VEHICLE_CSV if {name.strip() for name in first.split(",")} >= _TRACK else None


def _by_boxes(head: bytes) -> Content | None:
    kind, brand = head[4:8], head[8:12]
    if kind == b"ftyp" and brand in _PICTURE_BRANDS:
        raise ContentError(
            f"a {_PICTURE_BRANDS[brand]} picture cannot be read; convert it to JPEG or PNG"
        )
    if kind == b"ftyp":
        return MOV if brand == b"qt  " else MP4
    return MOV if kind in _OLD_MOV else None


def refuse_raw(head: bytes) -> None:
    """Refuse a camera's raw file, which is a TIFF whose first picture is a mere preview.

    Parameters
    ----------
    head : bytes
        Of any file, as far as it is at hand.

    Raises
    ------
    ContentError
    """
    name = _raw_name(head)
    if name is not None:
        raise ContentError(
            f"{name} cannot be read, and the preview in it is not the picture; develop it without "
            "lens correction, and save it as 16-bit TIFF, PNG or JPEG"
        )


def _raw_name(head: bytes) -> str | None:
    order: Literal["little", "big"] = "little" if head[:2] == b"II" else "big"
    if head[:4] not in (b"II*\0", b"MM\0*"):
        return None
    if head[8:10] == b"CR":
        return "a CR2 file"

    def number(at: int, size: int) -> int:
        return int.from_bytes(head[at : at + size], order)

    directory = number(4, 4)
    entries = range(directory + 2, directory + 2 + 12 * number(directory, 2), 12)
    values = {number(at, 2): number(at + 8, 4) for at in entries if at + 12 <= len(head)}
    if _DNG_VERSION in values:
        return "a DNG file"
    is_preview = values.get(_NEW_SUBFILE_TYPE, 0) & _IS_PREVIEW
    return "a camera's raw file" if is_preview else None
