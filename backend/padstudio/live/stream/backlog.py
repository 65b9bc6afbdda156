"""Packets between the thread that receives and the one that decodes, never late ones."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from padstudio.live.stream.connection import Connection

if TYPE_CHECKING:
    from av import Packet
    from av.video.stream import VideoStream

#: Of packets that wait, whatever a sender does.
MAX_BYTES = 64 << 20


@dataclass(frozen=True, eq=False)
class Arrival:
    """A packet, when it was there (s of `time.monotonic`), and the connection it is of."""

    packet: Packet[VideoStream]
    arrived_s: float
    connection: Connection
    number: int


class Backlog:
    """A queue whose latency is bounded.

    Decoding may be slower than what comes in. What has waited for too long is passed over up to the
    newest keyframe that is here. Where none is, decoding goes on, as it mostly makes up for a stop
    before the next keyframe comes; what is stale is passed over up to that one: frames in between
    could not be decoded rightly.

    Parameters
    ----------
    late_s : float
        The longest that a packet waits where a keyframe is behind it.
    stale_s : float
        The longest that any packet but a keyframe waits.
    clock : callable
        `time.monotonic`, or what tests put in its place.
    """

    def __init__(
        self, late_s: float, stale_s: float, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._late_s, self._stale_s, self._clock = late_s, stale_s, clock
        self._waiting: deque[Arrival] = deque()
        self._changed = threading.Condition()
        self._needs_keyframe = self._is_closed = self._is_finished = False
        self._connection = 0
        self._size = 0
        #: Packets that were passed over.
        self.skipped = 0

    def put(self, arrival: Arrival) -> None:
        """A packet has come."""
        with self._changed:
            self._waiting.append(arrival)
            self._size += arrival.packet.size
            if self._size > MAX_BYTES:
                self._drop(len(self._waiting))
                self._needs_keyframe = True
            self._changed.notify()

    def take(self) -> tuple[Arrival, bool] | None:
        """The next packet to be decoded, and whether some were passed over before it.

        Waits for one; None when closed, or when all were taken and no more will come.
        """
        has_gap = False
        with self._changed:
            while True:
                self._changed.wait_for(
                    lambda: self._waiting or self._is_closed or self._is_finished
                )
                if self._is_closed or not self._waiting:
                    return None
                has_gap |= self._pass_over()
                if self._waiting:
                    return self._remove(), has_gap

    def _pass_over(self) -> bool:
        """Drop what comes too late, and what rests on it; whether there was any."""
        head = self._waiting[0]
        if head.number != self._connection:
            self._connection, self._needs_keyframe = head.number, False
        waited_s = self._clock() - head.arrived_s
        self._needs_keyframe |= waited_s > self._stale_s
        if not self._needs_keyframe and waited_s <= self._late_s:
            return False
        starts = [
            place
            for place, arrival in enumerate(self._waiting)
            if arrival.packet.is_keyframe or arrival.number != head.number
        ]
        # The newest keyframe is decoded however late it is, or a slow machine would see nothing.
        if starts:
            count, self._needs_keyframe = starts[-1], False
        else:
            count = len(self._waiting) if self._needs_keyframe else 0
        self._drop(count)
        return count > 0

    def _drop(self, count: int) -> None:
        for _ in range(count):
            self._remove()
        self.skipped += count

    def _remove(self) -> Arrival:
        arrival = self._waiting.popleft()
        self._size -= arrival.packet.size
        return arrival

    def is_pressed(self) -> bool:
        """Whether packets have waited for a good part of what they may."""
        with self._changed:
            oldest = self._waiting[0].arrived_s if self._waiting else self._clock()
            return self._clock() - oldest > self._late_s / 3

    def finish(self) -> None:
        """No more packets will come."""
        with self._changed:
            self._is_finished = True
            self._changed.notify_all()

    def close(self) -> None:
        """Let go of all packets, and of who waits for them."""
        with self._changed:
            self._is_closed = True
            self._waiting.clear()
            self._changed.notify_all()
