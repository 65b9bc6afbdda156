"""Kept experiments: one folder each, with a record and the report's files.

A folder comes to its place whole, record and all, by one rename; nothing else says what is kept.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

from padstudio.errors import NotFoundError
from padstudio.store.database.data_folder import remove

_RECORD, _FILES, _RESULT = "record.json", "files", "result.json"


@dataclass(frozen=True)
class KeptExperiment:
    """One experiment that is done.

    Attributes
    ----------
    id, kind, name : str
    created_at : datetime
        UTC.
    order : mapping
        JSON-serialisable.
    steps : int
        That it took.
    """

    id: str
    kind: str
    name: str
    created_at: datetime
    order: Mapping[str, Any]
    steps: int


class Experiments:
    """The newest experiments.

    Parameters
    ----------
    folder : Path
        Holds one folder an experiment; what has no record is removed at once.
    keep : int
        The oldest go where there are more.
    """

    def __init__(self, folder: Path, *, keep: int) -> None:
        self._folder, self._keep = folder, keep
        for entry in folder.iterdir():
            if not (entry / _RECORD).is_file():
                remove(entry)

    def add(self, experiment: KeptExperiment, made: Path) -> None:
        """Keep an experiment, and drop the oldest beyond what is kept.

        Parameters
        ----------
        experiment : KeptExperiment
        made : Path
            A folder on the same file system with ``files`` and ``result.json``; it is moved.
        """
        record = asdict(experiment) | {"created_at": experiment.created_at.isoformat()}
        (made / _RECORD).write_text(json.dumps(record), encoding="utf-8")
        made.replace(self._folder / experiment.id)
        for old in self.newest()[self._keep :]:
            self.delete(old.id)

    def get(self, experiment_id: str) -> KeptExperiment:
        """One of them; raises `NotFoundError`."""
        return _read(self._place(experiment_id) / _RECORD)

    def result(self, experiment_id: str) -> Any:
        """What came of one; raises as `get`."""
        return json.loads((self._place(experiment_id) / _RESULT).read_text(encoding="utf-8"))

    def files(self, experiment_id: str) -> list[Path]:
        """Its files, by name; raises as `get`."""
        return sorted((self._place(experiment_id) / _FILES).iterdir())

    def file(self, experiment_id: str, name: str) -> Path:
        """One of its files; raises `NotFoundError`."""
        # Compared with what is there rather than joined: the name is a user's.
        for path in self.files(experiment_id):
            if path.name == name:
                return path
        raise NotFoundError("this experiment has no such file; its `files` list them")

    def delete(self, experiment_id: str) -> None:
        """Remove one; raises as `get`."""
        place = self._place(experiment_id)
        # First of all: without it the rest is nothing that is kept.
        (place / _RECORD).unlink(missing_ok=True)
        remove(place)

    def newest(self) -> list[KeptExperiment]:
        """All of them, newest first."""
        kept = [_read(path) for path in self._folder.glob(f"*/{_RECORD}")]
        return sorted(kept, key=lambda each: (each.created_at, each.id), reverse=True)

    def _place(self, experiment_id: str) -> Path:
        for path in self._folders():
            if path.name == experiment_id:
                return path
        raise NotFoundError("there is no experiment of that id; the list has them all")

    def _folders(self) -> Iterator[Path]:
        return (path.parent for path in self._folder.glob(f"*/{_RECORD}"))


def _read(path: Path) -> KeptExperiment:
    record = json.loads(path.read_text(encoding="utf-8"))
    record["created_at"] = datetime.fromisoformat(record["created_at"])
    return KeptExperiment(**record)
