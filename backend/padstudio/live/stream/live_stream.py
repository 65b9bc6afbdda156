"""A stream whose newest frame is there at any time, however slow its reader is.

Two threads: one receives packets and hands them to who records them, the other decodes. Received
packets are never held back by decoding, decoded frames never by their reader: there is one place
for the newest, and what it displaces is dropped and counted. Where decoding itself is too slow,
what waits for too long is passed over (`backlog.py`), so that latency stays bounded.
"""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from padstudio.errors import LimitError
from padstudio.live.reports.frame import LiveFrame
from padstudio.live.reports.source import PacketTap, Phase, StreamState
from padstudio.live.stream.addresses import StreamAddress
from padstudio.live.stream.backlog import Arrival, Backlog
from padstudio.live.stream.connection import Connection
from padstudio.live.stream.decoder import DecodedFrame, StreamDecoder
from padstudio.live.stream.errors import StreamError, explain
from padstudio.live.stream.mailbox import Mailbox
from padstudio.live.stream.options import StreamOptions

if TYPE_CHECKING:
    from av import Packet
    from av.video.stream import VideoStream

# A thread that waits within FFmpeg ends by its time limits; closing waits no longer for it.
_CLOSE_S = 0.8
# A source that hangs is told after so much more than its limit.
_GRACE_S = 0.5


class LiveStream:
    """A `padstudio.live.reports.source.FrameSource`: opened at once, opened again when lost.

    Parameters
    ----------
    address : StreamAddress
        Of `padstudio.live.stream.addresses.parse_address`; on a server, as
        `padstudio.live.stream.allowed.AllowedSources.check` gave it back.
    options : StreamOptions
    taps : sequence of PacketTap
        Take all packets, in the thread that receives them.
    """

    def __init__(
        self,
        address: StreamAddress,
        options: StreamOptions | None = None,
        taps: Sequence[PacketTap] = (),
    ) -> None:
        self._address, self._options = address, options or StreamOptions()
        self._taps = tuple(taps)
        self._lock = threading.Lock()
        # Taps are told by one thread at a time, and by none after they were closed.
        self._tapping = threading.Lock()
        self._is_tapped = False
        self._is_closing = threading.Event()
        self._is_changed = threading.Event()
        self._state = StreamState()
        self._heard_s = time.monotonic()
        late_s = self._options.late_s
        self._backlog = Backlog(late_s, max(late_s, self._options.stale_s))
        self._mailbox: Mailbox[DecodedFrame] = Mailbox()
        self._threads = [
            threading.Thread(target=self._receive, name="stream receiver", daemon=True),
            threading.Thread(target=self._decode, name="stream decoder", daemon=True),
        ]
        for thread in self._threads:
            thread.start()

    @property
    def state(self) -> StreamState:
        """As of now; from any thread. A source that hangs is lost, too."""
        with self._lock:
            state = replace(self._state, skipped=self._backlog.skipped)
            silent_s = time.monotonic() - self._heard_s
        options = self._options
        most = options.silent_s if state.phase == "open" else 2 * options.connect_s
        if state.phase not in ("open", "connecting") or silent_s <= most + _GRACE_S:
            return state
        detail = f"{self._address.shown}: nothing came for {silent_s:.0f} s"
        code = "silent" if state.phase == "open" else "no_answer"
        return replace(state, phase="lost", code=code, detail=detail)

    def newest(self, timeout_s: float) -> LiveFrame | None:
        """Take the newest frame, waiting for one that was not taken yet; None where none came."""
        frame = self._mailbox.take(timeout_s)
        return None if frame is None else frame.to_live(self._options.max_pixels)

    def begin(self) -> None:
        """Count frames anew, from the newest one on: those before came while nobody could read."""
        with self._lock:
            waiting = int(self._mailbox.is_full)
            self._state = replace(self._state, frames=waiting, dropped=0, damaged=0)

    def close(self) -> None:
        """Let go of the stream, within a second."""
        end = time.monotonic() + _CLOSE_S
        self._is_closing.set()
        self._backlog.close()
        self._mailbox.close()
        for thread in self._threads:
            if thread is not threading.current_thread():
                thread.join(max(0.0, end - time.monotonic()))
        self._tell_closed()

    def _receive(self) -> None:
        failures = 0
        while not self._is_closing.is_set():
            error, came = self._receive_once()
            failures = failures + 1 if error is not None and not came else 0
            if self._is_closing.is_set() or self._is_over(error, failures):
                return
            if error is not None and self._is_closing.wait(self._options.pause_s(failures)):
                return

    def _is_over(self, error: StreamError | None, failures: int) -> bool:
        """Note how a connection ended; whether that was the last one."""
        if error is None:
            is_over = self._address.kind == "file" and not self._options.loop
            if is_over:
                self._backlog.finish()
            return is_over
        attempts = self._options.attempts
        is_final = error.is_final or (attempts is not None and failures >= attempts)
        self._note("refused" if is_final else "lost", error.message, error.error_code)
        return is_final

    def _receive_once(self) -> tuple[StreamError | None, bool]:
        """Receive through one connection: why it was lost, if it was, and whether packets came."""
        came = False
        self._heard_s = time.monotonic()
        self._is_changed.clear()
        try:
            with contextlib.closing(Connection(self._address, self._options)) as connection:
                for packet in connection.packets(self._is_closing):
                    self._heard_s = time.monotonic()
                    if not came:
                        self._open(connection)
                        came = True
                    self._take(packet, connection)
                    if self._is_changed.is_set():
                        return None, came
        except StreamError as error:
            return error, came
        finally:
            self._tell_closed()
        if self._address.kind == "file" or self._is_closing.is_set():
            return None, came
        ended = f"{self._address.shown}: the sender ended the stream"
        return StreamError(ended, code="stream_ended"), came

    def _open(self, connection: Connection) -> None:
        context = connection.codec
        size = (context.width, context.height) if context.width else None
        number = self._state.connections + 1
        self._note("open", "", "", connections=number, size_px=size, codec=context.name)
        with self._tapping:
            self._is_tapped = not self._is_closing.is_set()
            for tap in self._taps if self._is_tapped else ():
                tap.opened(connection.stream, number)

    def _take(self, packet: Packet[VideoStream], connection: Connection) -> None:
        arrived_s = self._heard_s
        with self._tapping:
            for tap in self._taps if self._is_tapped and packet.size else ():
                tap.packet(packet, arrived_s)
        self._backlog.put(Arrival(packet, arrived_s, connection, self._state.connections))

    def _tell_closed(self) -> None:
        with self._tapping:
            is_tapped, self._is_tapped = self._is_tapped, False
            for tap in self._taps if is_tapped else ():
                tap.closed()

    def _decode(self) -> None:
        decoder = StreamDecoder(self._options.max_pixels)
        while (taken := self._backlog.take()) is not None:
            arrival, has_gap = taken
            is_pressed = self._backlog.is_pressed()
            try:
                frames = decoder.decode(arrival, has_gap=has_gap, is_pressed=is_pressed)
            except LimitError as error:
                told = explain(error, self._address)
                self._note("refused", told.message, told.error_code)
                self._is_closing.set()
                return
            for frame in frames:
                self._give(frame)
        # Only now has the last frame of a file been given.
        if not self._is_closing.is_set():
            self._note("ended", "", "")

    def _give(self, frame: DecodedFrame) -> None:
        is_taken = self._mailbox.put(frame)
        size = frame.frame.width, frame.frame.height
        with self._lock:
            state = self._state
            # What records the stream has to begin anew with another size.
            if frame.connection == state.connections and state.size_px not in (None, size):
                self._is_changed.set()
            self._state = replace(
                state,
                frames=state.frames + 1,
                dropped=state.dropped + (not is_taken),
                damaged=state.damaged + frame.is_damaged,
                size_px=size,
            )

    def _note(self, phase: Phase, detail: str, code: str, **more: Any) -> None:
        with self._lock:
            if self._state.phase not in ("ended", "refused"):
                self._state = replace(self._state, phase=phase, detail=detail, code=code, **more)
