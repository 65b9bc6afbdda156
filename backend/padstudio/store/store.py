"""Stored pads, cameras and traces: everything that survives a restart.

Pads and cameras are whole in the database, so that one commit keeps or drops them; a trace's
pictures lie in the data folder.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Generic, TypeVar

from sqlalchemy import delete, func, select
from sqlalchemy.orm import Session, sessionmaker, undefer

from padstudio.errors import ConflictError, NotFoundError, shown
from padstudio.store.database.data_folder import DataFolder
from padstudio.store.database.data_folder import new_id as new_id
from padstudio.store.database.engine import Sessions, open_database, sqlite_url
from padstudio.store.database.presets import Presets
from padstudio.store.database.tables import CameraRow, PadRow
from padstudio.store.database.traces import Traces
from padstudio.store.experiments import Experiments
from padstudio.store.uploads.limits import UploadLimits
from padstudio.store.uploads.uploads import Uploads

RowT = TypeVar("RowT", PadRow, CameraRow)


@dataclass(frozen=True)
class Stored:
    """One stored pad or camera.

    Attributes
    ----------
    id : str
    created_at : datetime
        UTC.
    summary : mapping
        What lists show of it, JSON-serialisable.
    content : str or None
        The pad file or camera file; None in lists.
    was_known : bool
        It was there already when it was to be added.
    """

    id: str
    created_at: datetime
    summary: Mapping[str, Any]
    content: str | None = None
    was_known: bool = False


class Shelf(Generic[RowT]):
    """Files of one kind, newest first."""

    def __init__(self, session: sessionmaker[Session], table: type[RowT], word: str) -> None:
        self._session = session
        self._table: type[RowT] = table
        self._word = word

    def add(self, content: str, summary: Mapping[str, Any]) -> Stored:
        """Store a file under a new id; the same file again is the one that is there."""
        table = self._table
        stored = Stored(new_id(), datetime.now(UTC), summary, content)
        same = select(table).where(table.content == content).order_by(table.created_at)
        with self._session.begin() as session:
            known = session.scalars(same.limit(1)).first()
            if known is not None:
                return Stored(known.id, known.created_at, known.summary, content, was_known=True)
            session.add(
                table(
                    id=stored.id,
                    created_at=stored.created_at,
                    summary=dict(summary),
                    content=content,
                )
            )
        return stored

    def list(self, limit: int, offset: int) -> tuple[list[Stored], int]:
        """A page of them, and how many there are."""
        table = self._table
        newest = select(table).order_by(table.created_at.desc(), table.id)
        with self._session() as session:
            total = session.scalar(select(func.count()).select_from(table)) or 0
            rows = session.scalars(newest.limit(limit).offset(offset)).all()
        return [Stored(row.id, row.created_at, row.summary) for row in rows], total

    def get(self, item_id: str) -> Stored:
        """One of them, with its content.

        Parameters
        ----------
        item_id : str
            Its id, or a name that no other has.

        Raises
        ------
        NotFoundError
            If there is none.
        ConflictError
            If several have that name.
        """
        table, whole = self._table, [undefer(self._table.content)]
        with self._session() as session:
            row = session.get(table, item_id, options=whole)
            if row is None:
                named = select(table).where(table.summary["name"].as_string() == item_id)
                rows = session.scalars(named.options(*whole).limit(2)).all()
                if len(rows) > 1:
                    raise self._ambiguous(item_id)
                row = rows[0] if rows else None
        if row is None:
            raise self._missing()
        return Stored(row.id, row.created_at, row.summary, row.content)

    def replace(self, item_id: str, content: str, summary: Mapping[str, Any]) -> Stored:
        """Put another file in the place of one; raises as `get`."""
        with self._session.begin() as session:
            row = session.get(self._table, item_id)
            if row is None:
                raise self._missing()
            row.content, row.summary = content, dict(summary)
            created_at = row.created_at
        return Stored(item_id, created_at, summary, content)

    def delete(self, item_id: str) -> None:
        """Remove one of them; raises as `get`."""
        table = self._table
        with self._session.begin() as session:
            found = session.scalar(delete(table).where(table.id == item_id).returning(table.id))
        if found is None:
            raise self._missing()

    def _missing(self) -> NotFoundError:
        return NotFoundError(
            f"there is no {self._word} of that id or name; the list of {self._word}s has them all"
        )

    def _ambiguous(self, name: str) -> ConflictError:
        return ConflictError(
            f"several {self._word}s are called {shown(name)}; name one by its id, as the list of "
            f"{self._word}s has it, or rename them",
            code="ambiguous_name",
        )


class Store:
    """The data folder and the database.

    Parameters
    ----------
    root : Path
        The data folder.
    database_url : str or None
        None is SQLite in the data folder.
    keep_traces, keep_trace_bytes : int
        The oldest traces go where there are more, or where they take more.
    keep_experiments : int
        The oldest experiments go where there are more.
    upload_limits : UploadLimits or None

    Attributes
    ----------
    folder : DataFolder
    pads, cameras : Shelf
    traces : Traces
    presets : Presets
    uploads : Uploads
    experiments : Experiments
    session : sessionmaker
        Of the database, for the flights in it.

    Raises
    ------
    StorageError, ConflictError
        If the folder or the database cannot be used, or another process uses the folder.
    """

    def __init__(
        self,
        root: Path,
        database_url: str | None = None,
        *,
        keep_traces: int = 200,
        keep_trace_bytes: int = 4_000_000_000,
        keep_experiments: int = 50,
        upload_limits: UploadLimits | None = None,
    ) -> None:
        self.folder = DataFolder(root)
        try:
            self._engine = open_database(database_url or sqlite_url(root / "padstudio.db"))
        except BaseException:
            self.folder.close()
            raise
        session = self.session = Sessions(self._engine)
        self.pads = Shelf(session, PadRow, "pad")
        self.cameras = Shelf(session, CameraRow, "camera")
        self.traces = Traces(
            self.folder.traces, session, keep=keep_traces, keep_bytes=keep_trace_bytes
        )
        self.presets = Presets(session)
        self.uploads = Uploads(self.folder.uploads, session, upload_limits)
        self.experiments = Experiments(self.folder.experiments, keep=keep_experiments)

    def close(self) -> None:
        """Close the database and release the folder."""
        self._engine.dispose()
        self.folder.close()
