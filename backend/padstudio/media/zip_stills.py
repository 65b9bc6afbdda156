"""Zips of stills: what may be in one, and its pictures by name.

Nothing is ever unpacked to disk, so names in a zip cannot lead anywhere.
"""

from __future__ import annotations

import lzma
import stat
import zipfile
import zlib
from dataclasses import dataclass
from pathlib import Path

from padstudio.errors import ImageError, LimitError
from padstudio.media.content import ContentError
from padstudio.media.remote import at_hand
from padstudio.media.sources import SUFFIXES, by_number

_UNREADABLE = (
    zipfile.BadZipFile,
    zlib.error,
    lzma.LZMAError,
    OSError,
    EOFError,
    KeyError,
    ValueError,
    NotImplementedError,
)
#: Generous for a directory's entry: 46 bytes, its name and its extra fields.
ENTRY_BYTES = 1000
#: The two records at a zip's end with the longest comment: 22 + 56 + 20 + 65 535.
TAIL_BYTES = 66_000


@dataclass(frozen=True)
class ZipLimits:
    """How much a zip may hold.

    Attributes
    ----------
    files : int
        Entries of any kind.
    unpacked_bytes : int
        All of them together.
    ratio : float
        Unpacked over packed size, of any entry and of the whole.
    still_bytes : int
        One still, unpacked.
    """

    files: int = 20_000
    unpacked_bytes: int = 64_000_000_000
    ratio: float = 200.0
    still_bytes: int = 256_000_000


def list_stills(path: Path, limits: ZipLimits | None = None) -> list[str]:
    """Names of the pictures in a zip, sorted with numbers by value.

    What else is in it, such as notes or a system's own files, is passed over.

    Parameters
    ----------
    path : Path
    limits : ZipLimits or None

    Raises
    ------
    ContentError
        If it is no zip, damaged, encrypted, or holds no picture.
    LimitError
        If it is beyond a limit; nothing has been unpacked then.
    """
    limits = limits or ZipLimits()
    stills = [entry for entry in entries_of(path, limits) if _is_still(entry)]
    if not stills:
        raise ContentError("the zip holds no picture; put stills into it", code="empty_zip")
    for entry in stills:
        check_entry(entry, limits, limits.still_bytes)
    names = {entry.filename for entry in stills}
    if len(names) < len(stills):
        raise ContentError("two pictures in the zip have one name; rename one", code="damaged_zip")
    return sorted(names, key=by_number)


def read_still(path: Path, name: str, limits: ZipLimits | None = None) -> bytes:
    """The file of one picture in a zip.

    Raises
    ------
    ImageError
        If it is damaged or not there.
    LimitError
        If it is beyond a limit.
    """
    limits = limits or ZipLimits()
    try:
        with zipfile.ZipFile(path) as archive:
            entry = archive.getinfo(name)
            check_entry(entry, limits, limits.still_bytes)
            # Reads no more than the size that was checked, whatever the stream holds.
            return archive.read(entry)
    except _UNREADABLE as error:
        raise ImageError(
            f"{name} cannot be read from the zip ({error}); pack it again", code="damaged_zip"
        ) from error


def entries_of(path: Path, limits: ZipLimits) -> list[zipfile.ZipInfo]:
    """All that is in a zip, which is within the limits as a whole; raises as `list_stills`."""
    _check_directory(path, limits)
    try:
        with zipfile.ZipFile(path) as archive:
            entries = archive.infolist()
    except (zipfile.BadZipFile, OSError, ValueError, NotImplementedError) as error:
        raise ContentError(
            f"the zip is damaged ({error}); pack it again", code="damaged_zip"
        ) from error
    _check_size(entries, path.stat().st_size, limits)
    return entries


def _check_directory(path: Path, limits: ZipLimits) -> None:
    """Refuse a directory too long to be read into memory (APPNOTE 6.3.10, 4.3.14 and 4.3.16)."""
    with path.open("rb") as file:
        file.seek(max(0, path.stat().st_size - TAIL_BYTES))
        most = directory_bytes(file.read())
    if most > limits.files * ENTRY_BYTES:
        raise LimitError(
            f"the zip holds more than {limits.files} files, the limit: split it",
            code="zip_too_many_files",
        )


def directory_bytes(tail: bytes) -> int:
    """The length of a zip's directory; of several that its end may name, the longest.

    Which of them a reader takes for the zip's own, a file's maker may have a say in.

    Parameters
    ----------
    tail : bytes
        The last `TAIL_BYTES` of the zip, or all of it.
    """
    longest = 0
    for signature, at, length in ((b"PK\x05\x06", 12, 4), (b"PK\x06\x06", 40, 8)):
        place = tail.find(signature)
        while place >= 0:
            size = int.from_bytes(tail[place + at : place + at + length], "little")
            # All ones: the longer record has it.
            if size < 2 ** (8 * length) - 1:
                longest = max(longest, size)
            place = tail.find(signature, place + 1)
    return longest


def _check_size(entries: list[zipfile.ZipInfo], packed_bytes: int, limits: ZipLimits) -> None:
    if len(entries) > limits.files:
        raise LimitError(
            f"the zip holds {len(entries)} files; the limit is {limits.files}: split it",
            code="zip_too_many_files",
        )
    unpacked = sum(entry.file_size for entry in entries)
    if unpacked > limits.unpacked_bytes:
        raise LimitError(
            f"the zip unpacks to {unpacked / 1e9:.1f} GB; the limit is "
            f"{limits.unpacked_bytes / 1e9:g} GB: split it",
            code="zip_too_large",
        )
    # Entries may share their data, so that each alone looks harmless.
    if unpacked > limits.ratio * packed_bytes:
        raise _bomb(unpacked / packed_bytes, limits)


def check_entry(entry: zipfile.ZipInfo, limits: ZipLimits, most_bytes: int) -> None:
    """Refuse an entry that is encrypted, too large or a bomb; raises as `list_stills`."""
    if entry.flag_bits & 1:
        raise ContentError("the zip is encrypted; pack it without a password", code="encrypted_zip")
    if entry.file_size > most_bytes:
        raise LimitError(
            f"{entry.filename} unpacks to {entry.file_size / 1e6:.0f} MB; the limit for one file "
            f"of its kind is {most_bytes / 1e6:g} MB",
            code="zip_too_large",
        )
    if entry.file_size > limits.ratio * max(entry.compress_size, 1):
        raise _bomb(entry.file_size / max(entry.compress_size, 1), limits)


def _bomb(ratio: float, limits: ZipLimits) -> LimitError:
    return LimitError(
        f"the zip unpacks to {ratio:.0f} times its size, which pictures do not; the limit is "
        f"{limits.ratio:g}",
        code="zip_bomb",
    )


def _is_still(entry: zipfile.ZipInfo) -> bool:
    return Path(entry.filename).suffix.lower() in SUFFIXES and not is_hidden(entry)


def is_hidden(entry: zipfile.ZipInfo) -> bool:
    """True of what people do not see as a file: folders, links, a system's own files."""
    path = Path(entry.filename)
    hidden = path.name.startswith(".") or "__MACOSX" in path.parts
    return entry.is_dir() or hidden or stat.S_ISLNK(entry.external_attr >> 16)


def list_members(url: str) -> list[str]:
    """As `list_stills`, of a zip that lies wherever fsspec reaches."""
    return list_stills(at_hand(url))


def read_member(url: str, name: str) -> bytes:
    """As `read_still`, of a zip that lies wherever fsspec reaches."""
    return read_still(at_hand(url), name)
