"""Uploads: what is announced, how far it has come, what it turned out to be.

The database knows which uploads there are; how many bytes of one are there is the size of its
file, so that nothing is lost or counted twice wherever the server is killed.
"""

from __future__ import annotations

import shutil
import threading
from collections.abc import Sequence
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import IO

from sqlalchemy.orm import Session, sessionmaker

from padstudio.errors import ConflictError, StudioError
from padstudio.media import content
from padstudio.store.database.data_folder import new_id
from padstudio.store.uploads import limits as upload_limits
from padstudio.store.uploads.files import Append, Checksum, UploadFiles
from padstudio.store.uploads.limits import UploadLimits
from padstudio.store.uploads.rows import Upload, UploadRows, missing

# Read at a time of a file that is copied in.
_BLOCK_BYTES = 1 << 20


class Uploads:
    """All uploads of a server.

    One caller at a time may append to, finish or delete one upload; different ones at once.

    Parameters
    ----------
    folder : Path
    session : sessionmaker
    limits : UploadLimits or None
    """

    def __init__(
        self, folder: Path, session: sessionmaker[Session], limits: UploadLimits | None = None
    ) -> None:
        self.limits = limits or UploadLimits()
        self._folder, self._files = folder, UploadFiles(folder)
        self._rows = UploadRows(session, self._files.offset)
        self._lock = threading.Lock()
        self._appending: set[str] = set()
        self._recover()

    def create(self, name: str, size_bytes: int, *, metadata: str = "") -> Upload:
        """Announce an upload.

        Parameters
        ----------
        name : str
            Shown to people, at most 200 characters; an empty one is made up of the content, when
            that is there.
        size_bytes : int
            Of the whole file.
        metadata : str
            Kept as it is.

        Raises
        ------
        ContentError, LimitError, StorageError, BusyError
            If it is empty, beyond a limit or the room on disk, or too many are unfinished.
        """
        self.expire()
        upload_limits.check_size(size_bytes, self.limits)
        now = datetime.now(UTC)
        upload = Upload(new_id(), now, name, size_bytes, 0, self._expiry(now), metadata)
        with self._lock:
            # One that is sealed but not yet moved counts among the kept.
            unfinished = [other for other in self._rows.unfinished() if other.sha256 is None]
            kept_bytes = sum(self._rows.kept().values())
            free_bytes = shutil.disk_usage(self._folder).free
            upload_limits.check_room(size_bytes, unfinished, kept_bytes, free_bytes, self.limits)
            self._rows.add(upload)
        return upload

    def get(self, upload_id: str) -> Upload:
        """One upload.

        Raises
        ------
        NotFoundError
            If there is none of that id, or it expired.
        """
        upload = self._rows.get(upload_id)
        if self._is_over(upload):
            raise missing()
        return upload

    def list(
        self, limit: int, offset: int = 0, sha256: str | None = None
    ) -> tuple[list[Upload], int]:
        """A page of them, newest first, and how many there are.

        With a hash, only complete uploads of that content.
        """
        self.expire()
        return self._rows.page(limit, offset, sha256)

    def unfinished(self) -> Sequence[Upload]:
        """Those that are not complete, and whose time is not over."""
        self.expire()
        return self._rows.unfinished()

    def path(self, upload_id: str) -> Path:
        """Where a complete upload's file lies; it never changes.

        Raises
        ------
        NotFoundError
            If there is none of that id.
        ConflictError
            If it is not complete.
        """
        upload = self.get(upload_id)
        if not upload.complete or upload.sha256 is None:
            raise ConflictError(
                f"{upload.name or 'the upload'} is not complete: {upload.offset} of "
                f"{upload.size_bytes} bytes are there; send the rest",
                code="upload_incomplete",
            )
        return self._files.whole(upload.sha256)

    def append(self, upload_id: str, offset: int, checksum: Checksum | None = None) -> Append:
        """Begin to add bytes at an offset; raises as `get`.

        Raises
        ------
        ConflictError
            If the offset is not the upload's.
        """
        upload = self.get(upload_id)
        if offset != upload.offset:
            raise ConflictError(
                f"this upload is at byte {upload.offset}, not {offset}; ask for its offset and go "
                "on from there",
                code="offset_mismatch",
                detail={"offset": upload.offset},
            )
        if upload.complete:
            raise ConflictError("this upload is complete", code="upload_complete")
        self._appending.add(upload_id)

        def closed() -> None:
            self._appending.discard(upload_id)
            self._touch(upload_id, unverified_from=None)

        try:
            self._touch(upload_id, unverified_from=offset if checksum else None)
            return Append(self._files, upload_id, upload.size_bytes, checksum, closed)
        except BaseException:
            self._appending.discard(upload_id)
            raise

    def finish(self, upload_id: str) -> Upload:
        """Examine an upload whose bytes are all there, and make it complete.

        One that is complete already, or not all there, is given back as it is.

        Raises
        ------
        ContentError, ImageError, LimitError
            If its content is of no use; the upload is gone then.
        """
        upload = self.get(upload_id)
        if upload.complete or upload.offset < upload.size_bytes:
            return upload
        if upload.sha256 is None:
            try:
                found = upload_limits.examine(self._files.partial(upload_id), self.limits)
            except StudioError:
                self.delete(upload_id)
                raise
            # The hash stands in the database before the file moves: what a cut between the two
            # leaves is finished when somebody asks for the upload again.
            sha256 = self._files.sha256(upload_id)
            named = {"name": upload.name or content.name_of(found, sha256)}
            told = {"kind": found.kind, "media_type": found.media_type}
            self._rows.set(upload_id, sha256=sha256, **named, **told)
        with self._lock:
            self._files.finish(upload_id, self._rows.get(upload_id).sha256 or "")
            self._rows.set(upload_id, expires_at=None)
        return self.get(upload_id)

    def delete(self, upload_id: str) -> None:
        """Remove an upload; its file too, unless another upload has the same content.

        Raises
        ------
        NotFoundError
            If there is none of that id.
        ConflictError
            If a flight needs it.
        """
        with self._lock:
            unused = self._rows.remove(upload_id)
            self._files.drop(upload_id)
            if unused is not None:
                self._files.whole(unused).unlink(missing_ok=True)

    def expire(self) -> int:
        """Remove unfinished uploads whose time is over; how many there were."""
        over = [upload.id for upload in self._rows.unfinished() if self._is_over(upload)]
        for upload_id in over:
            self.delete(upload_id)
        return len(over)

    def _recover(self) -> None:
        """Bring folder and database together after whatever ended the last server."""
        ids = frozenset(upload.id for upload in self._rows.unfinished())
        self._files.keep_only(ids, frozenset(self._rows.kept()))
        for upload_id, offset in self._rows.unverified():
            self._files.truncate(upload_id, offset)
            self._rows.set(upload_id, unverified_from=None)
        self.expire()

    def _touch(self, upload_id: str, unverified_from: int | None) -> None:
        """Put the end of an upload's time off."""
        expiry = self._expiry(datetime.now(UTC))
        self._rows.set(upload_id, expires_at=expiry, unverified_from=unverified_from)

    def _expiry(self, now: datetime) -> datetime:
        return now + timedelta(seconds=self.limits.expires_s)

    def _is_over(self, upload: Upload) -> bool:
        over = upload.expires_at is not None and upload.expires_at <= datetime.now(UTC)
        return over and upload.id not in self._appending


def upload_file(uploads: Uploads, path: Path, name: str) -> Upload:
    """Copy a file into the uploads, as if it had been sent; a failed one leaves nothing.

    Parameters
    ----------
    uploads : Uploads
    path : Path
    name : str
        Shown to people.

    Raises
    ------
    ContentError, LimitError, StorageError, BusyError
        As `Uploads.create` and `Uploads.finish`.
    """
    with path.open("rb") as file:
        return upload_stream(uploads, file, path.stat().st_size, name)


def upload_stream(uploads: Uploads, file: IO[bytes], size_bytes: int, name: str) -> Upload:
    """As `upload_file`, of the first bytes of an open file.

    Raises
    ------
    ContentError
        Also if it is shorter.
    """
    upload = uploads.create(name, size_bytes)
    try:
        append = uploads.append(upload.id, 0)
        left = size_bytes
        try:
            while left and (block := file.read(min(left, _BLOCK_BYTES))):
                append.write(block)
                left -= len(block)
            append.commit()
        finally:
            append.close()
        if left:
            raise content.ContentError(f"{name} breaks off; send it again", code="damaged_zip")
    except BaseException:
        uploads.delete(upload.id)
        raise
    return uploads.finish(upload.id)
