"""Packets to and from an autopilot: framing, signing, and opening again what was lost."""

from __future__ import annotations

import contextlib
import select
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from pymavlink.dialects.v20 import common

from padstudio.errors import StudioError
from padstudio.live.outputs.mavlink.address import Address
from padstudio.live.outputs.mavlink.transports import Transport, connect

# Signatures count tens of microseconds since the first second of 2015, Unix time.
_SIGNING_EPOCH_S, _SIGNING_TICKS = 1420070400, 100_000
# Until an address is tried again, s.
_FIRST_PAUSE_S, _MOST_PAUSE_S = 0.5, 4.0
_PIECES_A_STEP = 64


@dataclass(frozen=True)
class Arrived:
    """A message, when it came, of `time.monotonic`, and from where."""

    message: Any
    time_s: float
    source: Any


@dataclass
class LinkCounts:
    """What went over a link.

    Attributes
    ----------
    opened : int
        How often it was opened.
    received : int
        Messages.
    garbage : int
        Pieces that were no message: damaged, or with a wrong signature.
    sent : int
        Messages.
    dropped : int
        Messages that could not go, as the link was closed or its other end did not take them.
    """

    opened: int = 0
    received: int = 0
    garbage: int = 0
    sent: int = 0
    dropped: int = 0


class Link:
    """One link; `step` belongs to one thread, `send` to any.

    Parameters
    ----------
    address : Address
    component_id : int
        Of who sends.
    signing_key : bytes or None
        Thirty-two bytes; with it messages are signed, and others taken only with a right signature.
    now : callable
        Time of `time.monotonic`, s.
    """

    def __init__(
        self,
        address: Address,
        *,
        component_id: int,
        signing_key: bytes | None = None,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self.counts = LinkCounts()
        #: Why it is not open; empty while it is.
        self.detail = "not opened yet"
        self._address, self._now = address, now
        self._lock = threading.Lock()
        self._transport: Transport | None = None
        self._again_s, self._pause_s = now(), _FIRST_PAUSE_S
        self._packer = common.MAVLink(None, 1, component_id)
        if signing_key is not None:
            self._packer.signing.secret_key = signing_key
            self._packer.signing.sign_outgoing = True
        self._parser = self._new_parser()

    @property
    def is_open(self) -> bool:
        """Whether messages can go."""
        return self._transport is not None

    def speak_as(self, system_id: int) -> None:
        """Send under the id of a vehicle from now on."""
        self._packer.srcSystem = system_id

    def step(self, wait_s: float) -> list[Arrived]:
        """Messages that have come; waits for the first at most so long."""
        transport = self._transport or self._open()
        if transport is None:
            return []
        try:
            self._wait(transport, wait_s)
            return self._receive(transport)
        except OSError as error:
            self._lost(error)
            return []

    def send(self, message: Any) -> bool:
        """Send a message now, or not at all; never waits."""
        with self._lock:
            transport = self._transport
            is_sent = False
            if transport is not None:
                # The thread that receives finds out that it is lost.
                with contextlib.suppress(OSError):
                    is_sent = transport.send(self._pack(message))
            if is_sent:
                self.counts.sent += 1
            else:
                self.counts.dropped += 1
            return is_sent

    def answer_to(self, source: Any) -> None:
        """That came from the autopilot: speak to where it came from."""
        if self._transport is not None:
            self._transport.answer_to(source)

    def close(self) -> None:
        """Let go of it."""
        with self._lock:
            if self._transport is not None:
                self._transport.close()
            self._transport, self.detail = None, "closed"

    def _open(self) -> Transport | None:
        if self._now() < self._again_s:
            return None
        try:
            transport = connect(self._address)
        except StudioError as error:
            self._fail(error.message)
            return None
        self._parser = self._new_parser()
        with self._lock:
            self._transport, self.detail = transport, ""
        self.counts.opened += 1
        self._pause_s = _FIRST_PAUSE_S
        return transport

    def _lost(self, error: OSError) -> None:
        self.close()
        self._fail(f"{self._address}: {error.strerror or error}; trying again")

    def _fail(self, detail: str) -> None:
        self.detail = detail
        self._again_s = self._now() + self._pause_s
        self._pause_s = min(2 * self._pause_s, _MOST_PAUSE_S)

    def _wait(self, transport: Transport, wait_s: float) -> None:
        wanted = [transport] if transport.is_waiting else []
        _, can_send, _ = select.select([transport], wanted, [], wait_s)
        if can_send:
            with self._lock:
                transport.flush()

    def _receive(self, transport: Transport) -> list[Arrived]:
        found = []
        for _ in range(_PIECES_A_STEP):
            piece = transport.receive()
            if piece is None:
                break
            data, source = piece
            now_s = self._now()
            found += [Arrived(message, now_s, source) for message in self._messages(data)]
            if transport.is_packets and self._parser.buf_len():
                # What is left of a damaged packet is no part of the next one.
                self.counts.garbage += 1
                self._parser = self._new_parser()
        return found

    def _messages(self, data: bytes) -> list[Any]:
        try:
            parsed = self._parser.parse_buffer(data) or []
        except common.MAVError:
            self._parser = self._new_parser()
            self.counts.garbage += 1
            return []
        good = [message for message in parsed if message.get_type() != "BAD_DATA"]
        self.counts.garbage += len(parsed) - len(good)
        self.counts.received += len(good)
        return good

    def _new_parser(self) -> Any:
        parser = common.MAVLink(None)
        parser.robust_parsing = True
        # Keys, and the times of signatures that were seen, are one.
        parser.signing = self._packer.signing
        return parser

    def _pack(self, message: Any) -> bytes:
        packer = self._packer
        if packer.signing.sign_outgoing:
            ticks = int((time.time() - _SIGNING_EPOCH_S) * _SIGNING_TICKS)
            packer.signing.timestamp = max(packer.signing.timestamp, ticks)
        packet: bytes = message.pack(packer)
        packer.seq = (packer.seq + 1) % 256
        return packet
