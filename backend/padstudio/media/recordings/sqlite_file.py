"""The SQLite databases (``.db3``) of ROS 2 bags, whole or cut short."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import closing
from functools import lru_cache
from pathlib import Path
from typing import Any

import apsw

from padstudio.media.recordings.storage import (
    MAX_MESSAGE_BYTES,
    Channel,
    Message,
    RecordingError,
    Tell,
    check_message,
)
from padstudio.media.recordings.unpacking import ZSTD_MAGIC, unpack

MAGIC = b"SQLite format 3\0"
# Bytes of one value: a message's, and room for what SQLite puts beside it.
_MOST_VALUE_BYTES = MAX_MESSAGE_BYTES + 1_000_000
# Damaged pages give errors, or values of another type than they should.
_FAULTS = (apsw.Error, TypeError, ValueError)
# Time, topic, bytes and number of a message.
Row = tuple[int, int, int, int]


class SqliteFile:
    """A ROS 2 bag's database; as of `padstudio.media.recordings.storage.Storage`.

    Raises
    ------
    RecordingError
        If it is no such database, or so damaged that its topics are lost.
    """

    container = "rosbag2"

    def __init__(self, path: Path) -> None:
        self._path = path
        self._damage: list[str] = []
        self._is_short = _is_short(path)
        try:
            with closing(self._open()) as database:
                self.channels = tuple(self._topics(database))
                self._is_whole = not self._is_short and _is_sound_database(database)
        except _FAULTS as error:
            raise RecordingError(
                f"the database holds no topics of a ROS 2 bag ({error}); upload the recording's "
                "own .db3 file"
            ) from error
        if not self._is_whole:
            self._damage.append("the database is damaged, or was cut short")
        journal = path.with_name(f"{path.name}-wal")
        if journal.exists() and journal.stat().st_size:
            self._damage.append(
                f"{journal.name} holds messages that the recorder had not yet put into the "
                "database, and they are not read: run ros2 bag reindex"
            )

    @property
    def damage(self) -> tuple[str, ...]:
        """A sentence for each loss that showed when it was opened."""
        return tuple(self._damage)

    def messages(
        self,
        channels: Collection[int],
        start_ns: int | None = None,
        end_ns: int | None = None,
        tell: Tell = lambda _: None,
    ) -> Iterator[Message]:
        """As of `Storage.messages`."""
        places = ",".join("?" * len(channels))
        where = f"topic_id IN ({places}) AND timestamp BETWEEN ? AND ?"
        bounds = (
            *channels,
            -(2**63) if start_ns is None else start_ns,
            2**63 - 1 if end_ns is None else end_ns,
        )
        with closing(self._open()) as database:
            rows = self._rows(database, where, bounds, tell)
            if rows is None:
                rows = sorted(
                    row
                    for row in filter(_is_sound, _readable(database, tell))
                    if row[1] in channels and bounds[-2] <= row[0] <= bounds[-1]
                )
            for log_ns, channel, size, row in filter(_is_sound, rows):
                data = self._data(database, row, size, tell)
                if data is not None:
                    yield Message(log_ns, channel, data)

    def _rows(
        self, database: apsw.Connection, where: str, bounds: tuple[int, ...], tell: Tell
    ) -> list[Row] | None:
        """Rows by the index of times; None where the database is damaged."""
        if not self._is_whole:
            return None
        try:
            found: list[Any] = database.execute(
                f"SELECT timestamp, topic_id, length(data), id FROM messages WHERE {where} "
                "ORDER BY timestamp, id",
                bounds,
            ).fetchall()
        except _FAULTS as error:
            tell(f"the database is damaged ({error})")
            return None
        return found

    def _open(self) -> apsw.Connection:
        # Read as it lies: no journal is looked for or made beside it.
        address = f"{self._path.resolve().as_uri()}?immutable=1"
        flags = apsw.SQLITE_OPEN_READONLY | apsw.SQLITE_OPEN_URI
        vfs = _strict_vfs().vfs_name if self._is_short else None
        database = apsw.Connection(address, flags=flags, vfs=vfs)
        database.limit(apsw.SQLITE_LIMIT_LENGTH, _MOST_VALUE_BYTES)
        # SQLite would not open a file that is shorter than it should be.
        database.execute("PRAGMA writable_schema = ON")
        return database

    @staticmethod
    def _topics(database: apsw.Connection) -> Iterator[Channel]:
        found = database.execute("SELECT id, name, type, serialization_format FROM topics")
        for number, name, kind, encoding in found:
            yield Channel(int(number), str(name), str(kind), str(encoding))

    @staticmethod
    def _data(database: apsw.Connection, row: int, size: int, tell: Tell) -> bytes | None:
        check_message(size)
        try:
            found: Any = database.execute(
                "SELECT data FROM messages WHERE id = ?", (row,)
            ).fetchone()
            data = bytes(found[0])
            if data[:4] == ZSTD_MAGIC:
                return unpack(data, "zstd", MAX_MESSAGE_BYTES)
            return data
        except _FAULTS as error:
            tell(f"message {row} cannot be read ({error})")
            return None


def _is_short(path: Path) -> bool:
    """True of a file with fewer pages than its header says (SQLite file format, 1.3)."""
    with path.open("rb") as file:
        head = file.read(100)
    page = int.from_bytes(head[16:18], "big")
    size = (65536 if page == 1 else page) * int.from_bytes(head[28:32], "big")
    return path.stat().st_size < size


def _is_sound_database(database: apsw.Connection) -> bool:
    try:
        database.execute("SELECT count(*) FROM messages").fetchone()
        database.execute("SELECT max(timestamp) FROM messages").fetchone()
    except _FAULTS:
        return False
    return True


class _StrictFile(apsw.VFSFile):
    """Raises where bytes are not there, which SQLite takes for zeros."""

    def xRead(self, amount: int, offset: int) -> bytes:
        data = super().xRead(amount, offset)
        if len(data) < amount:
            raise apsw.IOError("the file ends before")
        return data


class _StrictVfs(apsw.VFS):
    vfs_name = "padstudio-strict"

    def __init__(self) -> None:
        super().__init__(self.vfs_name, "")

    def xOpen(self, name: Any, flags: list[int]) -> _StrictFile:
        return _StrictFile("", name, flags)


@lru_cache(maxsize=1)
def _strict_vfs() -> _StrictVfs:
    """Known to SQLite while the process lives."""
    return _StrictVfs()


def _is_sound(row: Row) -> bool:
    """False where a value is of another type, which SQLite would give as it is."""
    return all(isinstance(value, int) for value in row)


def _readable(database: apsw.Connection, tell: Tell) -> set[Row]:
    """Rows of a damaged table, from its start and from its end, each up to where it is broken."""
    found: set[Row] = set()
    for compare, order, place in ((">", "ASC", -(2**63)), ("<", "DESC", 2**63 - 1)):
        # One by one: what stands behind a row must not be looked at before it is taken.
        query = (
            f"SELECT timestamp, topic_id, length(data), id FROM messages NOT INDEXED "
            f"WHERE id {compare} ? ORDER BY id {order} LIMIT 1"
        )
        try:
            while (row := database.execute(query, (place,)).fetchone()) is not None:
                if row in found:
                    break
                found.add(row)
                place = row[3]
        except _FAULTS as error:
            tell(f"rows of the database cannot be read ({error})")
    return found
