"""What all kinds of recordings have in common: channels, and messages in the order of time."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import dataclass
from typing import NamedTuple, Protocol

from padstudio.errors import LimitError, StudioError
from padstudio.media.images import MAX_BYTES

#: Bytes of one message; a raw picture of 80 megapixels fits.
MAX_MESSAGE_BYTES = MAX_BYTES
#: Bytes of one compressed part of a recording, unpacked; writers close theirs after some megabytes.
MAX_CHUNK_BYTES = 1_000_000_000

#: The last time there is, ns of Unix time: in the year 2262.
LAST_NS = 2**63 - 1

#: Takes a sentence on each loss.
Tell = Callable[[str], None]


class RecordingError(StudioError):
    """A file is no readable recording, or not one with pictures."""

    code = "invalid_recording"
    status = 422


@dataclass(frozen=True)
class Channel:
    """A topic of a recording.

    Attributes
    ----------
    id : int
        Within the recording.
    topic : str
    type : str
        Of its messages: ``sensor_msgs/msg/Image``, ``foxglove.CompressedVideo``.
    encoding : str
        ``cdr`` (ROS 2), ``ros1``, ``protobuf``, ``json``, or another, which is not read.
    schema : bytes
        The type's definition as recorded; of ``protobuf`` a FileDescriptorSet.
    count : int or None
        Messages that the recording says it holds; None where it does not say.
    """

    id: int
    topic: str
    type: str
    encoding: str
    schema: bytes = b""
    count: int | None = None


class Message(NamedTuple):
    """A message as recorded.

    Attributes
    ----------
    log_ns : int
        When the recorder took it, ns of Unix time.
    channel : int
    data : bytes
    """

    log_ns: int
    channel: int
    data: bytes


class Storage(Protocol):
    """A recording; holds no file open, so that any number of readers may share it."""

    @property
    def container(self) -> str:
        """``rosbag1``, ``rosbag2`` or ``mcap``."""

    @property
    def channels(self) -> tuple[Channel, ...]:
        """All topics."""

    @property
    def damage(self) -> tuple[str, ...]:
        """A sentence for each loss that showed when it was opened."""

    def messages(
        self,
        channels: Collection[int],
        start_ns: int | None = None,
        end_ns: int | None = None,
        tell: Tell = lambda _: None,
    ) -> Iterator[Message]:
        """Messages in the order of their recorder's times; of equal ones, as they lie.

        Parameters
        ----------
        channels : collection of int
        start_ns, end_ns : int or None
            Times of the first and of the last; None is no bound.
        tell : callable
            Told of what cannot be read, which is left out.

        Raises
        ------
        LimitError
            If a message or a compressed part is beyond its limit.
        StorageError
            If the file is gone.
        """


@dataclass(frozen=True)
class Piece:
    """A part of a file that is read in one go: a chunk, or a message of its own.

    Attributes
    ----------
    start_ns, end_ns : int
        Times of its first and last message.
    offset : int
        In the file.
    channels : frozenset of int
        With messages in it.
    """

    start_ns: int
    end_ns: int
    offset: int
    channels: frozenset[int]


def in_order(
    pieces: Iterable[Piece],
    channels: Collection[int],
    start_ns: int | None,
    end_ns: int | None,
    read: Callable[[Piece], Iterable[Message]],
) -> Iterator[Message]:
    """Messages of pieces that may overlap in time; as of `Storage.messages`."""
    wanted = frozenset(channels)
    first = -(2**63) if start_ns is None else start_ns
    # Times beyond are none: they come of damage.
    last = LAST_NS if end_ns is None else min(end_ns, LAST_NS)
    chosen = [p for p in pieces if p.end_ns >= first and p.start_ns <= last and p.channels & wanted]
    waiting: list[tuple[int, int, int, Message]] = []
    for piece in sorted(chosen, key=lambda p: (p.start_ns, p.offset)):
        while waiting and waiting[0][0] < piece.start_ns:
            yield heapq.heappop(waiting)[-1]
        for place, message in enumerate(read(piece)):
            if message.channel in wanted and first <= message.log_ns <= last:
                heapq.heappush(waiting, (message.log_ns, piece.offset, place, message))
    while waiting:
        yield heapq.heappop(waiting)[-1]


def check_message(size_bytes: int) -> None:
    """Raise `LimitError` where a message is too large."""
    if size_bytes > MAX_MESSAGE_BYTES:
        raise LimitError(
            f"the recording holds a message of {size_bytes / 1e6:.0f} MB; the limit is "
            f"{MAX_MESSAGE_BYTES / 1e6:g} MB",
            code="message_too_large",
        )


def check_chunk(size_bytes: int) -> None:
    """Raise `LimitError` where a compressed part is too large."""
    if size_bytes > MAX_CHUNK_BYTES:
        raise LimitError(
            f"a part of the recording unpacks to {size_bytes / 1e6:.0f} MB; the limit is "
            f"{MAX_CHUNK_BYTES / 1e6:g} MB",
            code="message_too_large",
        )
