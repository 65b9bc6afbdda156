"""Bytes to and from an autopilot, never waiting but in `connect`."""

from __future__ import annotations

import contextlib
import os
import socket
from abc import ABC, abstractmethod
from typing import Any, Protocol

from padstudio.errors import StudioError
from padstudio.live.outputs.mavlink.address import Address
from padstudio.live.outputs.mavlink.serial_port import open_serial, queued_bytes

_READ_BYTES = 4096
# What a serial port has still to send, and what a connection's other end has not answered; more
# would only go out when it is old.
_MOST_QUEUED_S, _LEAST_QUEUED_BYTES, _MOST_UNANSWERED_BYTES = 0.05, 256, 2048
_CONNECT_S, _SILENT_MS = 2.0, 3000


class LinkError(StudioError):
    """The autopilot's address cannot be opened."""

    code = "mavlink_link_failed"
    status = 502


class Transport(Protocol):
    """An open end; every method but `close` raises OSError where it has been lost."""

    #: Pieces are whole packets.
    is_packets: bool

    def fileno(self) -> int:
        """To wait for."""

    @property
    def is_waiting(self) -> bool:
        """Bytes wait until the other end takes them; `flush` tries again."""

    def receive(self) -> tuple[bytes, Any] | None:
        """What has come, and from where; None where there is nothing more for now."""

    def send(self, packet: bytes) -> bool:
        """Send a packet whole; False where it cannot go now, and nothing of it is sent."""

    def flush(self) -> None:
        """Send what waits."""

    def answer_to(self, source: Any) -> None:
        """The autopilot is where that came from."""

    def close(self) -> None:
        """Let go of it."""


def connect(address: Address) -> Transport:
    """Open an address; waits for at most some seconds.

    Raises
    ------
    StudioError
        Saying what is wrong.
    """
    try:
        if address.kind == "serial":
            return _Serial(address)
        if address.kind == "tcp":
            return _Tcp(address)
        return _Udp(address)
    except OSError as error:
        raise LinkError(f"{address}: {error.strerror or error}; trying again") from error


class _Udp:
    """Packets; as a server to whom the autopilot's came from."""

    is_packets = True
    is_waiting = False

    def __init__(self, address: Address) -> None:
        self._is_server = address.kind == "udpin"
        family, kind, protocol, _, place = socket.getaddrinfo(
            address.place, address.number, type=socket.SOCK_DGRAM
        )[0]
        self._socket = socket.socket(family, kind, protocol)
        self._socket.setblocking(False)
        self._peer = None if self._is_server else place
        try:
            if self._is_server:
                self._socket.bind(place)
        except OSError:
            self._socket.close()
            raise

    def fileno(self) -> int:
        return self._socket.fileno()

    def receive(self) -> tuple[bytes, Any] | None:
        # A port that nobody listens at yet is no reason to give up.
        with contextlib.suppress(BlockingIOError, ConnectionRefusedError):
            data, source = self._socket.recvfrom(65536)
            if self._peer is None:
                self._peer = source
            return data, source
        return None

    def answer_to(self, source: Any) -> None:
        if self._is_server:
            self._peer = source

    def send(self, packet: bytes) -> bool:
        if self._peer is None:
            return False
        with contextlib.suppress(BlockingIOError, ConnectionRefusedError):
            self._socket.sendto(packet, self._peer)
            return True
        return False

    def flush(self) -> None:
        pass

    def close(self) -> None:
        self._socket.close()


class _Stream(ABC):
    """What takes and gives bytes one after the other."""

    is_packets = False

    def __init__(self, most_queued_bytes: int) -> None:
        self._most_queued_bytes = most_queued_bytes
        self._waiting = b""

    @property
    def is_waiting(self) -> bool:
        return bool(self._waiting)

    def receive(self) -> tuple[bytes, Any] | None:
        with contextlib.suppress(BlockingIOError):
            data = self._read()
            return (data, None) if data else None
        return None

    def answer_to(self, source: Any) -> None:
        # There is but one other end.
        del source

    def send(self, packet: bytes) -> bool:
        self.flush()
        # What waits here or in the system would go out when it is old.
        if self._waiting or queued_bytes(self.fileno()) > self._most_queued_bytes:
            return False
        self._waiting = packet
        self.flush()
        return True

    def flush(self) -> None:
        while self._waiting:
            try:
                sent = self._write(self._waiting)
            except BlockingIOError:
                return
            self._waiting = self._waiting[sent:]

    @abstractmethod
    def fileno(self) -> int: ...

    @abstractmethod
    def close(self) -> None: ...

    @abstractmethod
    def _read(self) -> bytes: ...

    @abstractmethod
    def _write(self, data: bytes) -> int: ...


class _Serial(_Stream):
    """A serial port."""

    def __init__(self, address: Address) -> None:
        super().__init__(max(_LEAST_QUEUED_BYTES, round(address.number / 10 * _MOST_QUEUED_S)))
        self._descriptor = open_serial(address.place, address.number)

    def fileno(self) -> int:
        return self._descriptor

    def close(self) -> None:
        os.close(self._descriptor)

    def _read(self) -> bytes:
        return os.read(self._descriptor, _READ_BYTES)

    def _write(self, data: bytes) -> int:
        return os.write(self._descriptor, data)


class _Tcp(_Stream):
    """A connection to a server."""

    def __init__(self, address: Address) -> None:
        super().__init__(_MOST_UNANSWERED_BYTES)
        self._socket = socket.create_connection((address.place, address.number), _CONNECT_S)
        self._socket.setblocking(False)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        # A server that does not answer any more is found out, where the system can do so.
        with contextlib.suppress(AttributeError, OSError):
            self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, _SILENT_MS)

    def fileno(self) -> int:
        return self._socket.fileno()

    def close(self) -> None:
        self._socket.close()

    def _read(self) -> bytes:
        data = self._socket.recv(_READ_BYTES)
        if not data:
            raise ConnectionResetError("the other end has closed the connection")
        return data

    def _write(self, data: bytes) -> int:
        return self._socket.send(data)
