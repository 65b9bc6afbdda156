"""The table of uploads."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from sqlalchemy import Select, delete, func, select, update
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session, sessionmaker

from padstudio.errors import ConflictError, NotFoundError
from padstudio.media import content
from padstudio.store.database.tables import UploadRow


@dataclass(frozen=True)
class Upload:
    """One upload.

    Attributes
    ----------
    id : str
    created_at : datetime
        UTC.
    name : str
        As the sender called it, else by its content, and empty until that is known; for people
        only.
    size_bytes : int
    offset : int
        Bytes that are there.
    expires_at : datetime or None
        UTC; None once it is complete.
    metadata : str
        The header that the sender announced it with, unread.
    sha256, kind, media_type : str or None
        Hexadecimal; `padstudio.media.content.Content`; None until it is complete.
    """

    id: str
    created_at: datetime
    name: str
    size_bytes: int
    offset: int
    expires_at: datetime | None = None
    metadata: str = ""
    sha256: str | None = None
    kind: content.Kind | None = None
    media_type: str | None = None

    @property
    def complete(self) -> bool:
        """True where all bytes are there and the content has been examined."""
        return self.expires_at is None


class UploadRows:
    """Reads and writes the table.

    Parameters
    ----------
    session : sessionmaker
    partial_bytes : callable
        How many bytes of an unfinished upload are on disk.
    """

    def __init__(self, session: sessionmaker[Session], partial_bytes: Callable[[str], int]) -> None:
        self._session, self._partial_bytes = session, partial_bytes

    def add(self, upload: Upload) -> None:
        """Add an upload of which nothing is there yet."""
        with self._session.begin() as session:
            session.add(
                UploadRow(
                    id=upload.id,
                    created_at=upload.created_at,
                    name=upload.name,
                    size_bytes=upload.size_bytes,
                    tus_metadata=upload.metadata,
                    expires_at=upload.expires_at,
                )
            )

    def get(self, upload_id: str) -> Upload:
        """One of them; raises `NotFoundError`."""
        with self._session() as session:
            row = session.get(UploadRow, upload_id)
        if row is None:
            raise missing()
        return self._upload(row)

    def set(self, upload_id: str, **values: object) -> None:
        """Change columns of one of them; nothing happens where it is gone."""
        with self._session.begin() as session:
            session.execute(update(UploadRow).where(UploadRow.id == upload_id).values(**values))

    def remove(self, upload_id: str) -> str | None:
        """Remove one; its hash, where nothing else has that content.

        Raises
        ------
        NotFoundError, ConflictError
            If there is none of that id, or a flight needs it.
        """
        gone = delete(UploadRow).where(UploadRow.id == upload_id).returning(UploadRow.sha256)
        try:
            with self._session.begin() as session:
                found = session.execute(gone).all()
                if not found:
                    raise missing()
                (sha256,) = found[0]
                same = select(UploadRow.id).where(UploadRow.sha256 == sha256).limit(1)
                return sha256 if sha256 and session.scalar(same) is None else None
        except IntegrityError as error:
            raise ConflictError(
                "a flight is made of this upload; remove the flight first", code="upload_in_use"
            ) from error

    def page(self, limit: int, offset: int, sha256: str | None) -> tuple[list[Upload], int]:
        """A page of them, newest first, and how many there are; of one content where asked."""
        found = select(UploadRow)
        if sha256 is not None:
            found = found.where(UploadRow.sha256 == sha256, UploadRow.expires_at.is_(None))
        newest = found.order_by(UploadRow.created_at.desc(), UploadRow.id)
        with self._session() as session:
            total = session.scalar(select(func.count()).select_from(found.subquery())) or 0
        return self._all(newest.limit(limit).offset(offset)), total

    def unfinished(self) -> list[Upload]:
        """Those that are not complete."""
        return self._all(select(UploadRow).where(UploadRow.expires_at.is_not(None)))

    def unverified(self) -> Sequence[tuple[str, int]]:
        """Ids of those with bytes that wait for their checksum, and where these begin."""
        found = select(UploadRow.id, UploadRow.unverified_from).where(
            UploadRow.unverified_from.is_not(None)
        )
        with self._session() as session:
            return [(row[0], row[1] or 0) for row in session.execute(found)]

    def kept(self) -> dict[str, int]:
        """Size of every content there is, by its hash."""
        found = select(UploadRow.sha256, UploadRow.size_bytes).where(UploadRow.sha256.is_not(None))
        with self._session() as session:
            return {row[0] or "": row[1] for row in session.execute(found)}

    def _all(self, found: Select[Any]) -> list[Upload]:
        with self._session() as session:
            return [self._upload(row) for row in session.scalars(found)]

    def _upload(self, row: UploadRow) -> Upload:
        offset = row.size_bytes
        if row.sha256 is None:
            on_disk = self._partial_bytes(row.id)
            offset = on_disk if row.unverified_from is None else min(on_disk, row.unverified_from)
        return Upload(
            row.id,
            row.created_at,
            row.name,
            row.size_bytes,
            offset,
            row.expires_at,
            row.tus_metadata,
            row.sha256,
            row.kind,  # type: ignore[arg-type]
            row.media_type,
        )


def missing() -> NotFoundError:
    """The error where there is no such upload."""
    return NotFoundError(
        "there is no upload of that id; it was removed, or its time was over before it was complete"
    )
