"""Kept traces: a row with the answer, a folder with the stage pictures."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from sqlalchemy import delete, select
from sqlalchemy.orm import Session, sessionmaker

from padstudio.errors import NotFoundError
from padstudio.store.database.data_folder import keep_only, remove
from padstudio.store.database.tables import TraceRow


class Traces:
    """The newest traces.

    Parameters
    ----------
    folder : Path
        Holds one folder a trace; what has no row is removed at once.
    session : sessionmaker
    keep : int
        The oldest go where there are more,
    keep_bytes : int
        or where their pictures take more together.
    """

    def __init__(
        self, folder: Path, session: sessionmaker[Session], *, keep: int, keep_bytes: int
    ) -> None:
        self._folder, self._session = folder, session
        self._keep, self._keep_bytes = keep, keep_bytes
        with session() as reader:
            keep_only(folder, frozenset(reader.scalars(select(TraceRow.id))))

    def add(self, trace_id: str, pictures: Path, body: Mapping[str, Any]) -> None:
        """Keep a trace, and drop the oldest beyond what is kept.

        Parameters
        ----------
        trace_id : str
            A new id.
        pictures : Path
            A folder on the same file system; it is moved.
        body : mapping
            JSON-serialisable.
        """
        row = TraceRow(
            id=trace_id,
            created_at=datetime.now(UTC),
            size_bytes=sum(entry.stat().st_size for entry in pictures.iterdir()),
            body=dict(body),
        )
        target = self._folder / trace_id
        pictures.replace(target)
        try:
            with self._session.begin() as session:
                session.add(row)
        except BaseException:
            remove(target)
            raise
        self._prune()

    def body(self, trace_id: str) -> Mapping[str, Any]:
        """The body that a trace was added with.

        Raises
        ------
        NotFoundError
            If there is none of that id, or it was dropped.
        """
        with self._session() as session:
            row = session.get(TraceRow, trace_id)
        if row is None:
            raise NotFoundError(
                "there is no such trace: only the newest are kept; send the picture again"
            )
        return row.body

    def picture(self, trace_id: str, name: str) -> Path:
        """Where a picture of a trace lies; raises as `body`."""
        self.body(trace_id)
        # Compared with what is there rather than joined: the name is a user's.
        for path in (self._folder / trace_id).iterdir():
            if path.name == name:
                return path
        raise NotFoundError("this trace has no such picture; its stages list them")

    def _prune(self) -> None:
        newest = select(TraceRow.id, TraceRow.size_bytes).order_by(
            TraceRow.created_at.desc(), TraceRow.id
        )
        dropped: list[str] = []
        with self._session.begin() as session:
            together = 0
            for place, (trace_id, size_bytes) in enumerate(session.execute(newest)):
                together += size_bytes
                # The newest stays, however large: somebody is about to look at it.
                if place and (place >= self._keep or together > self._keep_bytes):
                    dropped.append(trace_id)
            session.execute(delete(TraceRow).where(TraceRow.id.in_(dropped)))
        for trace_id in dropped:
            remove(self._folder / trace_id)
