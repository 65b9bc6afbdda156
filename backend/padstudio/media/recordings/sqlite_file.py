"""The SQLite databases (``.db3``) of ROS 2 bags, whole or cut short."""

from __future__ import annotations

import sqlite3
from collections.abc import Collection, Iterable, Iterator
from contextlib import closing
from pathlib import Path

from padstudio.media.recordings.storage import (
    MAX_MESSAGE_BYTES,
    Channel,
    Message,
    RecordingError,
    Tell,
    check_message,
)
from padstudio.media.recordings.unpacking import ZSTD_MAGIC, UnpackError, unpack

MAGIC = b"SQLite format 3\0"
# Bytes of one value: a message's, and room for what SQLite puts beside it.
_MOST_VALUE_BYTES = MAX_MESSAGE_BYTES + 1_000_000
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
        try:
            with closing(self._open()) as database:
                self.channels = tuple(self._topics(database))
                self._is_whole = _is_whole(database)
        except sqlite3.Error as error:
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
            rows: Iterable[Row]
            if self._is_whole:
                rows = database.execute(
                    f"SELECT timestamp, topic_id, length(data), id FROM messages WHERE {where} "
                    "ORDER BY timestamp, id",
                    bounds,
                )
            else:
                rows = sorted(
                    row
                    for row in _readable(database, tell)
                    if row[1] in channels and bounds[-2] <= row[0] <= bounds[-1]
                )
            for log_ns, channel, size, row in rows:
                data = self._data(database, row, size, tell)
                if data is not None:
                    yield Message(log_ns, channel, data)

    def _open(self) -> sqlite3.Connection:
        # Read as it lies: no journal is looked for or made beside it.
        address = f"{self._path.resolve().as_uri()}?immutable=1"
        database = sqlite3.connect(address, uri=True, check_same_thread=False)
        database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, _MOST_VALUE_BYTES)
        # SQLite would not open a file that is shorter than it should be.
        database.execute("PRAGMA writable_schema = ON")
        database.execute("PRAGMA query_only = ON")
        return database

    @staticmethod
    def _topics(database: sqlite3.Connection) -> Iterator[Channel]:
        found = database.execute("SELECT id, name, type, serialization_format FROM topics")
        for number, name, kind, encoding in found:
            yield Channel(int(number), str(name), str(kind), str(encoding))

    @staticmethod
    def _data(database: sqlite3.Connection, row: int, size: int, tell: Tell) -> bytes | None:
        check_message(size)
        try:
            (data,) = database.execute("SELECT data FROM messages WHERE id = ?", (row,)).fetchone()
            if data[:4] == ZSTD_MAGIC:
                return unpack(data, "zstd", MAX_MESSAGE_BYTES)
            return bytes(data)
        except (sqlite3.Error, TypeError, UnpackError) as error:
            tell(f"message {row} cannot be read ({error})")
            return None


def _is_whole(database: sqlite3.Connection) -> bool:
    """Compare the file's length with the one in its header, and look at every index page."""
    try:
        (pages,) = database.execute("PRAGMA page_count").fetchone()
        (size,) = database.execute("PRAGMA page_size").fetchone()
        (_, _, name) = next(iter(database.execute("PRAGMA database_list")))
        if Path(name).stat().st_size < pages * size:
            return False
        database.execute("SELECT count(*) FROM messages").fetchone()
        database.execute("SELECT max(timestamp) FROM messages").fetchone()
    except (sqlite3.Error, StopIteration):
        return False
    return True


def _readable(database: sqlite3.Connection, tell: Tell) -> set[Row]:
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
        except sqlite3.Error as error:
            tell(f"rows of the database cannot be read ({error})")
    return found
