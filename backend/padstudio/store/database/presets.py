"""Named settings of the detector, shared by all who use a server."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import delete, func, select
from sqlalchemy.orm import Session, sessionmaker

from padstudio.errors import LimitError, NotFoundError
from padstudio.store.database.tables import PresetRow

#: So many are kept at the most; nobody finds one among more.
MAX_PRESETS = 200


@dataclass(frozen=True)
class Preset:
    """Settings under a name.

    Attributes
    ----------
    name : str
    method : {"dense", "paper"}
    params : mapping
        JSON-serialisable, by group and name.
    created_at : datetime
    """

    name: str
    method: str
    params: Mapping[str, Any]
    created_at: datetime


class Presets:
    """The presets of a database, by name."""

    def __init__(self, session: sessionmaker[Session]) -> None:
        self._session = session

    def list(self) -> list[Preset]:
        """All of them, in the order of their names."""
        with self._session() as session:
            rows = session.scalars(select(PresetRow).order_by(PresetRow.name)).all()
        return [Preset(row.name, row.method, row.params, row.created_at) for row in rows]

    def put(self, name: str, method: str, params: Mapping[str, Any]) -> Preset:
        """Keep settings under a name, in the place of others that have it.

        Raises
        ------
        LimitError
            If `MAX_PRESETS` other names are taken.
        """
        preset = Preset(name, method, dict(params), datetime.now(UTC))
        with self._session.begin() as session:
            row = session.get(PresetRow, name)
            if row is None:
                count = session.scalar(select(func.count()).select_from(PresetRow)) or 0
                if count >= MAX_PRESETS:
                    raise LimitError(
                        f"there are {MAX_PRESETS} presets, the limit; remove some first",
                        code="too_many_presets",
                    )
                row = PresetRow(name=name)
                session.add(row)
            row.method, row.params = method, dict(params)
            row.created_at = preset.created_at
        return preset

    def delete(self, name: str) -> None:
        """Remove one; raises `NotFoundError`."""
        chosen = delete(PresetRow).where(PresetRow.name == name).returning(PresetRow.name)
        with self._session.begin() as session:
            if session.scalar(chosen) is None:
                raise NotFoundError("there is no preset of that name; the list has them all")
