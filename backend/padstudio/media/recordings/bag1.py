"""ROS 1 bags, whole or cut short.

Pieces are found from records' headers without unpacking them, which takes no longer than to read
the index at the file's end, and serves a bag that has none.

References
----------
http://wiki.ros.org/Bags/Format/2.0
"""

from __future__ import annotations

import struct
from collections.abc import Collection, Iterator
from io import BytesIO
from pathlib import Path
from typing import IO

from padstudio.media.recordings.storage import (
    Channel,
    Message,
    Piece,
    RecordingError,
    Tell,
    check_chunk,
    check_message,
    in_order,
)
from padstudio.media.recordings.unpacking import unpack

MAGIC = b"#ROSBAG V2.0\n"
# Records' ops.
_MESSAGE, _HEADER, _INDEX, _CHUNK, _CONNECTION = 2, 3, 4, 5, 7
# One entry of an index record: seconds, nanoseconds, place in the chunk.
_ENTRY = struct.Struct("<III")
_LENGTH = struct.Struct("<I")
# A header holds names, and a connection's the callers'.
_MOST_HEADER_BYTES = 1_000_000
# What comes of headers and fields that are not what they should be.
_FAULTS = (ValueError, struct.error, KeyError, IndexError)


class CutShortError(ValueError):
    """A file ends within a record."""


class Bag1File:
    """A ROS 1 bag; as of `padstudio.media.recordings.storage.Storage`.

    Raises
    ------
    RecordingError
        If it is encrypted, or there is nothing in it that can be read.
    """

    container = "rosbag1"

    def __init__(self, path: Path) -> None:
        self._path = path
        self._damage: list[str] = []
        self._channels: dict[int, Channel] = {}
        self._pieces: list[Piece] = []
        with path.open("rb") as file:
            self._scan(file)
        if not self._channels:
            raise RecordingError(
                "the bag holds no topic: the recording was cut short before the first one"
            )

    @property
    def channels(self) -> tuple[Channel, ...]:
        """All topics."""
        return tuple(self._channels.values())

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

        def read(piece: Piece) -> list[Message]:
            try:
                return list(self._messages_in(_chunk_at(file, piece.offset)))
            except _FAULTS as error:
                tell(f"a part at byte {piece.offset} cannot be read ({error})")
                return []

        with self._path.open("rb") as file:
            yield from in_order(self._pieces, channels, start_ns, end_ns, read)

    def _scan(self, file: IO[bytes]) -> None:
        """Find the chunks, and which connections have messages in them at which times."""
        size = file.seek(0, 2)
        place = file.seek(len(MAGIC))
        open_chunk: int | None = None
        indexed: list[tuple[int, int, int]] = []
        has_connections = False
        while place < size:
            try:
                op, header, length = _record_at(file, place)
            except _FAULTS:
                break
            data_at = file.tell()
            if data_at + length > size:
                break
            try:
                if op == _HEADER:
                    _check_encryption(header)
                elif op == _CHUNK:
                    self._close(file, open_chunk, indexed)
                    open_chunk, indexed = place, []
                elif op == _INDEX:
                    indexed.append(_span(header, file.read(length)))
                elif op == _CONNECTION:
                    has_connections = True
                    self._learn(header, file.read(length))
            except _FAULTS as error:
                self._damage.append(f"a record at byte {place} cannot be read ({error!r})")
            place = data_at + length
        self._close(file, open_chunk, indexed)
        if place < size or not has_connections:
            self._damage.append(
                f"the bag breaks off at byte {place}: the recording or the copy was cut short"
            )
        if not has_connections:
            self._learn_from_chunks(file)

    def _close(
        self, file: IO[bytes], chunk: int | None, indexed: list[tuple[int, int, int]]
    ) -> None:
        """Keep a chunk, once what stands behind it is read."""
        if chunk is None:
            return
        if not indexed:
            try:
                found = list(self._messages_in(_chunk_at(file, chunk)))
            except _FAULTS as error:
                self._damage.append(f"a part at byte {chunk} cannot be read ({error})")
                return
            indexed = [(m.channel, m.log_ns, m.log_ns) for m in found]
        if indexed:
            inside = frozenset(channel for channel, _, _ in indexed)
            start_ns, end_ns = min(e[1] for e in indexed), max(e[2] for e in indexed)
            self._pieces.append(Piece(start_ns, end_ns, chunk, inside))

    def _learn_from_chunks(self, file: IO[bytes]) -> None:
        for piece in self._pieces:
            if piece.channels - self._channels.keys():
                # What cannot be unpacked is told when it is read.
                try:
                    list(self._messages_in(_chunk_at(file, piece.offset)))
                except _FAULTS:
                    continue

    def _learn(self, header: dict[str, bytes], data: bytes) -> None:
        from rosbags.typesys.msg import normalize_msgtype

        number = _uint32(header["conn"])
        fields = _fields(data)
        self._channels.setdefault(
            number,
            Channel(
                number,
                header["topic"].decode("utf-8", "replace"),
                normalize_msgtype(fields["type"].decode("utf-8", "replace")),
                "ros1",
                fields.get("message_definition", b""),
            ),
        )

    def _messages_in(self, chunk: bytes) -> Iterator[Message]:
        file, place = BytesIO(chunk), 0
        while place < len(chunk):
            op, header, length = _record_at(file, place)
            start = file.tell()
            place = start + length
            if place > len(chunk):
                raise CutShortError("it ends within a record")
            if op == _MESSAGE:
                check_message(length)
                log_ns = _time_ns(header["time"])
                yield Message(log_ns, _uint32(header["conn"]), chunk[start:place])
            elif op == _CONNECTION:
                self._learn(header, chunk[start:place])


def _record_at(file: IO[bytes], place: int) -> tuple[int, dict[str, bytes], int]:
    """Op, header fields and length of the data that follow where the file stands then."""
    file.seek(place)
    header = _fields(_exactly(file, _uint32(_exactly(file, 4)), _MOST_HEADER_BYTES))
    return header["op"][0], header, _uint32(_exactly(file, 4))


def _chunk_at(file: IO[bytes], place: int) -> bytes:
    """A chunk's records, unpacked."""
    _, header, length = _record_at(file, place)
    check_chunk(length)
    size = _uint32(header["size"])
    check_chunk(size)
    compression = header["compression"].decode("ascii", "replace")
    return unpack(_exactly(file, length, length), compression, size)


def _fields(data: bytes) -> dict[str, bytes]:
    """Fields ``name=value`` of a header, each after its length."""
    fields, place = {}, 0
    while place < len(data):
        (length,) = _LENGTH.unpack_from(data, place)
        name, _, value = data[place + 4 : place + 4 + length].partition(b"=")
        fields[name.decode("ascii", "replace")] = value
        place += 4 + length
    return fields


def _span(header: dict[str, bytes], entries: bytes) -> tuple[int, int, int]:
    """Connection, first and last time of an index record."""
    times = [s * 10**9 + ns for s, ns, _ in _ENTRY.iter_unpack(entries)]
    return _uint32(header["conn"]), min(times, default=0), max(times, default=0)


def _check_encryption(header: dict[str, bytes]) -> None:
    if header.get("encryptor"):
        raise RecordingError(
            "the bag is encrypted, which cannot be read; decrypt it with rosbag decrypt"
        )


def _exactly(file: IO[bytes], count: int, most: int = 4) -> bytes:
    if count > most:
        raise CutShortError("a header is longer than headers are")
    data = file.read(count)
    if len(data) < count:
        raise CutShortError("it ends within a record")
    return data


def _uint32(data: bytes) -> int:
    (number,) = _LENGTH.unpack(data)
    return int(number)


def _time_ns(data: bytes) -> int:
    seconds, nanoseconds = struct.unpack("<II", data)
    return int(seconds) * 10**9 + int(nanoseconds)
