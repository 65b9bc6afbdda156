"""The members of a bundle's zip, bounded: nothing is unpacked to disk, and names lead nowhere."""

from __future__ import annotations

import io
import json
import lzma
import zipfile
import zlib
from collections.abc import Mapping
from typing import Any

from padstudio.errors import LimitError, StudioError
from padstudio.flights.bundles import contents
from padstudio.media.zip_stills import ENTRY_BYTES, TAIL_BYTES, directory_bytes

#: Bytes of a bundle's file, and of all of its members.
MAX_BYTES = 512_000_000
# Pad files are tens of kilobytes; a thousand rows and columns make some megabytes.
_TEXT_BYTES = 32_000_000
# A result is some kilobytes, and is kept with the frame where a bundle is opened.
_MANIFEST_BYTES = 1_000_000
_PICTURE_BYTES = 256_000_000
_TEXTS = {contents.MANIFEST, contents.PAD, contents.CAMERA, contents.TRACE, contents.AROUND} | {
    contents.other_pad(place) for place in range(contents.MOST_OTHERS)
}
_PICTURES = {
    contents.PIXELS,
    contents.ORIGINAL,
    *contents.PLANES,
    contents.neighbour_name(-1),
    contents.neighbour_name(1),
}
_RATIO = 500.0
# No result is nested half as deep; what writes JSON gives up far deeper.
_MOST_DEPTH = 20
_UNREADABLE = (
    *(zipfile.BadZipFile, zlib.error, lzma.LZMAError, OSError, EOFError, KeyError, ValueError),
    *(NotImplementedError, RuntimeError),
)


class BundleError(StudioError):
    """A file is no bundle, or a damaged one."""

    code = "invalid_bundle"
    status = 422


def members_of(data: bytes) -> dict[str, bytes]:
    """All members of a bundle's zip, by name.

    Raises
    ------
    BundleError
        If it is no zip, damaged, or holds what no bundle does.
    LimitError
        If it is beyond a limit; nothing has been unpacked then.
    """
    if len(data) > MAX_BYTES:
        raise LimitError(
            f"the bundle is larger than {MAX_BYTES // 1_000_000} MB, the limit; bundles of one "
            "frame are smaller",
            code="bundle_too_large",
        )
    # A long directory would be read whole before its entries could be counted.
    if directory_bytes(data[-TAIL_BYTES:]) > ENTRY_BYTES * len(_TEXTS | _PICTURES):
        raise _too_many()
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            entries = archive.infolist()
            _check(entries)
            # No more is read than the size that was checked, whatever the stream holds.
            return {entry.filename: archive.read(entry) for entry in entries}
    except _UNREADABLE as error:
        raise BundleError(
            f"the bundle is no zip, or damaged ({error}); copy it again, or make it again",
            code="damaged_bundle",
        ) from error


def _check(entries: list[zipfile.ZipInfo]) -> None:
    if len(entries) > len(_TEXTS | _PICTURES):
        raise _too_many()
    names = [entry.filename for entry in entries]
    if strange := sorted(set(names) - _TEXTS - _PICTURES):
        raise BundleError(
            f"the zip holds {strange[0][:80]!r}, which no bundle does; choose a bundle that the "
            "studio made, or read a zip of stills as a flight",
            code="unknown_member",
        )
    if len(set(names)) < len(names):
        raise BundleError("two members of the bundle have one name", code="damaged_bundle")
    for entry in entries:
        if entry.flag_bits & 1:
            raise BundleError("the bundle is encrypted; pack it without", code="damaged_bundle")
        if entry.file_size > _most(entry.filename) or entry.file_size > _RATIO * max(
            entry.compress_size, 1
        ):
            raise LimitError(
                f"{entry.filename} unpacks to {entry.file_size / 1e6:.1f} MB of "
                f"{entry.compress_size / 1e6:.3f}: beyond what bundles hold",
                code="bundle_too_large",
            )
    if sum(entry.file_size for entry in entries) > MAX_BYTES:
        raise LimitError("the bundle unpacks to more than the limit", code="bundle_too_large")


def _most(name: str) -> int:
    if name == contents.MANIFEST:
        return _MANIFEST_BYTES
    return _TEXT_BYTES if name in _TEXTS else _PICTURE_BYTES


def _too_many() -> LimitError:
    return LimitError(
        f"the zip holds more than {len(_TEXTS | _PICTURES)} files, as no bundle does; choose a "
        "bundle that the studio made",
        code="too_many_members",
    )


def json_object(members: Mapping[str, bytes], name: str) -> dict[str, Any]:
    """A member that is a JSON object, and can be written as one again.

    Raises
    ------
    BundleError
        If it is missing or another.
    """
    if name not in members:
        raise BundleError(f"the bundle lacks {name}; make it again", code="not_a_bundle")
    try:
        found = json.loads(members[name], parse_constant=_no_number)
        _check_depth(found)
        # No numbers beyond what a float holds, halves of characters, or nothing as a letter.
        written = json.dumps(found, ensure_ascii=False, allow_nan=False).encode()
        if b"\\u0000" in written:
            raise ValueError("a text holds a NUL")
    except (ValueError, RecursionError) as error:
        raise BundleError(f"the bundle's {name} is no JSON ({error}); make it again") from error
    if not isinstance(found, dict):
        raise BundleError(f"the bundle's {name} is no JSON object; make it again")
    return found


def _check_depth(value: Any) -> None:
    level = [value]
    for _ in range(_MOST_DEPTH):
        level = [
            inner
            for each in level
            if isinstance(each, dict | list)
            for inner in (each.values() if isinstance(each, dict) else each)
        ]
        if not level:
            return
    raise ValueError(f"nested more than {_MOST_DEPTH} deep")


def _no_number(name: str) -> float:
    raise ValueError(f"{name} is no number of JSON")
