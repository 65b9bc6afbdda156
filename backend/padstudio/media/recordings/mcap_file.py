"""MCAP files, by their index, or piece by piece where that is missing.

References
----------
https://mcap.dev/spec
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Collection, Iterator
from io import BytesIO
from pathlib import Path
from typing import IO, TYPE_CHECKING

from padstudio.media.recordings.storage import (
    MAX_CHUNK_BYTES,
    Channel,
    Message,
    Piece,
    RecordingError,
    Tell,
    check_chunk,
    check_message,
    in_order,
)
from padstudio.media.recordings.unpacking import UnpackError, unpack

if TYPE_CHECKING:
    from mcap import records

MAGIC = b"\x89MCAP0\r\n"
# A record's opcode and length; of a chunk what stands before its compression, of a message what
# stands before its data.
_RECORD, _CHUNK, _MESSAGE = struct.Struct("<BQ"), struct.Struct("<QQQI"), struct.Struct("<HIQQ")
_SCHEMA_OP, _CHANNEL_OP, _MESSAGE_OP, _CHUNK_OP, _DATA_END_OP = 3, 4, 5, 6, 15
# What else could be a record's length: an index of a day's recording is not as long.
_MOST_BYTES = MAX_CHUNK_BYTES + 1_000_000


class McapFile:
    """An MCAP file; as of `padstudio.media.recordings.storage.Storage`.

    Raises
    ------
    RecordingError
        If there is nothing in it that can be read.
    """

    container = "mcap"

    def __init__(self, path: Path) -> None:
        self._path = path
        self._damage: list[str] = []
        self._schemas: dict[int, records.Schema] = {}
        self._channels: dict[int, records.Channel] = {}
        self._counts: dict[int, int] | None = None
        self._pieces: list[Piece] = []
        with path.open("rb") as file:
            if not self._read_index(file):
                self._scan(file)
        if not self._channels:
            raise RecordingError(
                "the MCAP file holds no topic: the recording was cut short before the first one"
            )

    @property
    def channels(self) -> tuple[Channel, ...]:
        """All topics."""
        return tuple(self._described(channel) for channel in self._channels.values())

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
        with self._path.open("rb") as file:
            yield from in_order(
                self._pieces,
                channels,
                start_ns,
                end_ns,
                lambda piece: self._read_piece(file, piece, tell),
            )

    def _described(self, channel: records.Channel) -> Channel:
        schema = self._schemas.get(channel.schema_id)
        count = None if self._counts is None else self._counts.get(channel.id, 0)
        return Channel(
            channel.id,
            channel.topic,
            schema.name if schema else "",
            channel.message_encoding,
            schema.data if schema else b"",
            count,
        )

    def _read_index(self, file: IO[bytes]) -> bool:
        """Take the summary at the file's end; False where it does not tell all."""
        from mcap.exceptions import McapError
        from mcap.reader import SeekingReader

        try:
            summary = SeekingReader(file, record_size_limit=_MOST_BYTES).get_summary()
        except (McapError, OSError, ValueError, struct.error, StopIteration, MemoryError):
            return False
        if summary is None or not summary.channels or not summary.chunk_indexes:
            return False
        size = file.seek(0, 2)
        if any(chunk.chunk_start_offset >= size for chunk in summary.chunk_indexes):
            return False
        self._schemas, self._channels = summary.schemas, summary.channels
        if summary.statistics is not None:
            self._counts = dict(summary.statistics.channel_message_counts)
        for chunk in summary.chunk_indexes:
            # Writers may leave out which channels a chunk has.
            inside = frozenset(chunk.message_index_offsets) or frozenset(summary.channels)
            self._pieces.append(
                Piece(
                    chunk.message_start_time,
                    chunk.message_end_time,
                    chunk.chunk_start_offset,
                    inside,
                )
            )
        return True

    def _scan(self, file: IO[bytes]) -> None:
        """Go through the file from its start, up to where it breaks off."""
        size = file.seek(0, 2)
        place = len(MAGIC)
        while place < size:
            file.seek(place)
            head = file.read(_RECORD.size)
            if len(head) < _RECORD.size:
                break
            op, length = _RECORD.unpack(head)
            if op == _DATA_END_OP:
                return
            if not 0 < op < 0x80 or place + _RECORD.size + length > size:
                break
            try:
                self._note(file, op, place, length)
            except (ValueError, struct.error, EOFError) as error:
                self._damage.append(f"a part at byte {place} cannot be read ({error})")
            place += _RECORD.size + length
        self._damage.append(
            f"the file breaks off at byte {place}: the recording or the copy was cut short"
        )

    def _note(self, file: IO[bytes], op: int, place: int, length: int) -> None:
        """Keep what a record says of where messages are."""
        if op in (_SCHEMA_OP, _CHANNEL_OP):
            check_message(length)
            self._learn(op, file.read(length))
        elif op == _MESSAGE_OP:
            channel, _, log_ns, _ = _MESSAGE.unpack(file.read(_MESSAGE.size))
            self._pieces.append(Piece(log_ns, log_ns, place, frozenset({channel})))
        elif op == _CHUNK_OP:
            found = list(self._messages_in(_unpacked(file.read(_checked(length)))))
            if found:
                times = [message.log_ns for message in found]
                inside = frozenset(message.channel for message in found)
                self._pieces.append(Piece(min(times), max(times), place, inside))

    def _learn(self, op: int, content: bytes) -> None:
        """Keep a schema or a channel; raises `ValueError` where it is damaged."""
        from mcap.data_stream import ReadDataStream
        from mcap.exceptions import McapError
        from mcap.records import Channel as ChannelRecord
        from mcap.records import Schema

        stream = ReadDataStream(BytesIO(content))
        try:
            if op == _SCHEMA_OP:
                schema = Schema.read(stream)
                self._schemas.setdefault(schema.id, schema)
            else:
                channel = ChannelRecord.read(stream)
                self._channels.setdefault(channel.id, channel)
        except McapError as error:
            raise ValueError("a schema or channel is damaged") from error

    def _read_piece(self, file: IO[bytes], piece: Piece, tell: Tell) -> list[Message]:
        file.seek(piece.offset)
        head = file.read(_RECORD.size)
        op, length = _RECORD.unpack(head) if len(head) == _RECORD.size else (0, 0)
        try:
            if op == _MESSAGE_OP:
                check_message(length)
                return [_message(file.read(length))]
            if op == _CHUNK_OP:
                return list(self._messages_in(_unpacked(file.read(_checked(length)))))
        except (ValueError, struct.error, EOFError) as error:
            tell(f"a part at byte {piece.offset} cannot be read ({error})")
            return []
        tell(f"the part at byte {piece.offset} is not there")
        return []

    def _messages_in(self, chunk: bytes) -> Iterator[Message]:
        """Messages of an unpacked chunk; its schemas and channels are learnt on the way."""
        place = 0
        while place < len(chunk):
            op, length = _RECORD.unpack_from(chunk, place)
            start, place = place + _RECORD.size, place + _RECORD.size + length
            if place > len(chunk):
                raise EOFError("it ends within a record")
            if op == _MESSAGE_OP:
                check_message(length)
                yield _message(chunk[start:place])
            elif op in (_SCHEMA_OP, _CHANNEL_OP):
                self._learn(op, chunk[start:place])


def _checked(length: int) -> int:
    check_chunk(length)
    return length


def _message(content: bytes) -> Message:
    channel, _, log_ns, _ = _MESSAGE.unpack_from(content)
    return Message(log_ns, channel, content[_MESSAGE.size :])


def _unpacked(content: bytes) -> bytes:
    """A chunk's records.

    Raises
    ------
    UnpackError
        If they are damaged.
    """
    _, _, size, crc = _CHUNK.unpack_from(content)
    check_chunk(size)
    start = _CHUNK.size + 4
    name_end = start + int.from_bytes(content[_CHUNK.size : start], "little")
    packed = int.from_bytes(content[name_end : name_end + 8], "little")
    data = content[name_end + 8 : name_end + 8 + packed]
    out = unpack(data, content[start:name_end].decode("ascii", "replace"), size)
    if len(out) != size or (crc and zlib.crc32(out) != crc):
        raise UnpackError("its bytes are not those that were written")
    return out
