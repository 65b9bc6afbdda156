"""The bytes of uploads on disk: growing files, whole files under their hash, safe at any cut."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from padstudio.errors import ConflictError, StudioError
from padstudio.media import content
from padstudio.store.database.data_folder import keep_only

if TYPE_CHECKING:
    from hashlib import _Hash as Hash

#: Algorithms that a request's bytes can be checked with, as tus and `hashlib` name them.
CHECKSUMS = ("sha1", "sha256")


class ChecksumError(StudioError):
    """Bytes arrived other than they were sent; 460 is the protocol's own status."""

    code = "checksum_mismatch"
    status = 460


@dataclass(frozen=True)
class Checksum:
    """What a request's bytes must hash to.

    Attributes
    ----------
    algorithm : str
        One of `CHECKSUMS`.
    digest : bytes
    """

    algorithm: str
    digest: bytes


class UploadFiles:
    """Two folders: ``partial/<id>`` grows, ``files/<sha256>`` never changes.

    Parameters
    ----------
    root : Path
        Made where it is missing.
    """

    def __init__(self, root: Path) -> None:
        self._partial, self._files = root / "partial", root / "files"
        self._partial.mkdir(parents=True, exist_ok=True)
        self._files.mkdir(exist_ok=True)
        # Hashed as bytes arrive, so that the last request of a large upload is no slower.
        self._hashes: dict[str, tuple[int, Hash]] = {}

    def partial(self, upload_id: str) -> Path:
        """Where an unfinished upload lies."""
        return self._partial / upload_id

    def whole(self, sha256: str) -> Path:
        """Where a finished file lies."""
        return self._files / sha256

    def keep_only(self, ids: frozenset[str], hashes: frozenset[str]) -> None:
        """Remove what the database does not know."""
        keep_only(self._partial, ids)
        keep_only(self._files, hashes)

    def offset(self, upload_id: str) -> int:
        """How many bytes of an unfinished upload are on disk."""
        try:
            return self.partial(upload_id).stat().st_size
        except FileNotFoundError:
            return 0

    def hash(self, upload_id: str, data: bytes, offset: int) -> None:
        """Take bytes that were written at an offset into the upload's SHA-256."""
        hashed, running = self._hashes.get(upload_id, (0, hashlib.sha256()))
        if hashed == offset:
            running.update(data)
            self._hashes[upload_id] = (hashed + len(data), running)

    def sha256(self, upload_id: str) -> str:
        """SHA-256 of an unfinished upload's bytes, hexadecimal."""
        hashed, running = self._hashes.get(upload_id, (-1, None))
        if running is not None and hashed == self.offset(upload_id):
            return running.hexdigest()
        # Begun before a restart, or taken back in part.
        with self.partial(upload_id).open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()

    def truncate(self, upload_id: str, size_bytes: int) -> None:
        """Take bytes back."""
        self._hashes.pop(upload_id, None)
        if self.offset(upload_id) > size_bytes:
            os.truncate(self.partial(upload_id), size_bytes)

    def finish(self, upload_id: str, sha256: str) -> None:
        """Move an upload to its hash; where that content is already, only one copy stays."""
        self._hashes.pop(upload_id, None)
        partial, whole = self.partial(upload_id), self.whole(sha256)
        if whole.exists():
            partial.unlink(missing_ok=True)
        else:
            partial.replace(whole)
        for folder in (self._partial, self._files):
            _sync_folder(folder)

    def drop(self, upload_id: str) -> None:
        """Remove an unfinished upload's bytes."""
        self._hashes.pop(upload_id, None)
        self.partial(upload_id).unlink(missing_ok=True)


class Append:
    """One request's bytes on their way to the end of an upload.

    `write` them, `commit`, and `close` in any case: what was not committed stays as far as it
    came, unless a checksum or a full disk says that it must not.

    Parameters
    ----------
    files : UploadFiles
    upload_id : str
    size_bytes : int
        Of the whole upload; more is refused.
    checksum : Checksum or None
    closed : callable
        Called once, last.
    """

    def __init__(
        self,
        files: UploadFiles,
        upload_id: str,
        size_bytes: int,
        checksum: Checksum | None,
        closed: Callable[[], None],
    ) -> None:
        self._files, self._id, self._size_bytes, self._closed = files, upload_id, size_bytes, closed
        self._checksum = checksum
        self._hash = hashlib.new(checksum.algorithm) if checksum else None
        self._file = files.partial(upload_id).open("ab", buffering=0)
        self._start = self.offset = self._file.tell()
        self._keep = checksum is None

    def write(self, data: bytes) -> None:
        """Add bytes.

        Raises
        ------
        ConflictError
            If they are more than the upload was announced to have.
        ContentError
            As soon as the first bytes show that the file is of no use.
        OSError
            If the disk does not take them; none of this request's stay then.
        """
        if self.offset + len(data) > self._size_bytes:
            raise ConflictError(
                f"more bytes than the {self._size_bytes} that this upload was announced to have",
                code="too_many_bytes",
            )
        rest = memoryview(data)
        try:
            while rest:
                rest = rest[self._file.write(rest) :]
        except OSError:
            self._keep = False
            raise
        self._files.hash(self._id, data, self.offset)
        if self._hash:
            self._hash.update(data)
        before, self.offset = self.offset, self.offset + len(data)
        if before < content.HEAD_BYTES <= self.offset:
            content.identify(read_head(self._files.partial(self._id)))

    def commit(self) -> None:
        """Take the bytes for good.

        Raises
        ------
        ChecksumError
            If they are not those that were sent; none of them stay.
        """
        if self._checksum and self._hash and self._hash.digest() != self._checksum.digest:
            raise ChecksumError(
                f"the bytes do not match their {self._checksum.algorithm}: they changed on the "
                "way; send them again from the offset that the upload has now"
            )
        self._keep = True

    def close(self) -> None:
        """Make sure that what stays is on disk, and take back what must not stay."""
        try:
            if not self._keep:
                self._files.truncate(self._id, self._start)
                self.offset = self._start
            os.fsync(self._file.fileno())
        finally:
            self._file.close()
            self._closed()


def read_head(path: Path) -> bytes:
    """The first bytes of a file, enough for `content.identify`."""
    with path.open("rb") as file:
        return file.read(content.HEAD_BYTES)


def _sync_folder(folder: Path) -> None:
    """Make a rename in a folder survive a power cut."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
