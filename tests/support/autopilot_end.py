"""An autopilot's end of a MAVLink link, by pymavlink, with a clock of its own."""

from __future__ import annotations

import os
import socket
import time
from collections.abc import Callable
from typing import Any

from pymavlink.dialects.v20 import common


class ManualClock:
    """Time that goes on when a test says so."""

    def __init__(self, start_s: float = 1000.0) -> None:
        self.now_s = start_s

    def __call__(self) -> float:
        return self.now_s

    def advance(self, by_s: float) -> None:
        self.now_s += by_s


class AutopilotClockTruth:
    """Shows hours more, and goes faster by a little."""

    def __init__(self, offset_s: float = 5 * 3600.0, drift: float = 1e-4) -> None:
        self.offset_s, self.drift = offset_s, drift

    def at(self, time_s: float) -> float:
        """What it shows at a time of ours, s."""
        return time_s * (1 + self.drift) + self.offset_s


class AutopilotEnd:
    """Sends and receives messages of one autopilot over something that carries bytes.

    Parameters
    ----------
    send : callable
        Takes bytes.
    receive : callable
        Gives the bytes that have come, or none.
    """

    def __init__(
        self,
        send: Callable[[bytes], object],
        receive: Callable[[], bytes],
        *,
        autopilot: int = common.MAV_AUTOPILOT_ARDUPILOTMEGA,
        system: int = 1,
        key: bytes | None = None,
    ) -> None:
        self.send_bytes, self._receive = send, receive
        self.autopilot = autopilot
        self.packer = common.MAVLink(None, system, common.MAV_COMP_ID_AUTOPILOT1)
        self.parser = common.MAVLink(None)
        self.parser.robust_parsing = True
        if key is not None:
            self.packer.signing.secret_key = self.parser.signing.secret_key = key
            self.packer.signing.sign_outgoing = True
            self.packer.signing.timestamp = int((time.time() - 1420070400) * 1e5)
        self.messages: list[Any] = []
        self.bad = 0

    def send(self, message: Any) -> None:
        packet = message.pack(self.packer)
        self.packer.seq = (self.packer.seq + 1) % 256
        self.send_bytes(packet)

    def heartbeat(self) -> None:
        self.send(
            common.MAVLink_heartbeat_message(
                common.MAV_TYPE_QUADROTOR, self.autopilot, 0, 0, common.MAV_STATE_ACTIVE, 3
            )
        )

    def read(self) -> list[Any]:
        """What has come since the last time; all is kept in ``messages``, too."""
        found = []
        while data := self._receive():
            for message in self.parser.parse_buffer(data) or []:
                if message.get_type() == "BAD_DATA":
                    self.bad += 1
                else:
                    found.append(message)
        self.messages += found
        return found

    def of(self, name: str) -> list[Any]:
        """All messages of a kind so far."""
        self.read()
        return [message for message in self.messages if message.get_type() == name]


def udp_end(**options: Any) -> tuple[AutopilotEnd, int, socket.socket]:
    """An autopilot that listens at a port of this machine, and answers who speaks to it."""
    place = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    place.bind(("127.0.0.1", 0))
    place.setblocking(False)
    peers: list[Any] = []

    def receive() -> bytes:
        try:
            data, peer = place.recvfrom(4096)
        except BlockingIOError:
            return b""
        peers[:] = [peer]
        return data

    def send(data: bytes) -> None:
        if peers:
            place.sendto(data, peers[0])

    return AutopilotEnd(send, receive, **options), place.getsockname()[1], place


def stream_end(descriptor: int, **options: Any) -> AutopilotEnd:
    """An autopilot at a file descriptor: a connection, or a terminal's other end."""
    os.set_blocking(descriptor, False)

    def receive() -> bytes:
        try:
            return os.read(descriptor, 4096)
        except (BlockingIOError, OSError):
            return b""

    return AutopilotEnd(lambda data: os.write(descriptor, data), receive, **options)


def until(condition: Callable[[], Any], step: Callable[[], object], most_s: float = 20.0) -> Any:
    """Step until a condition holds, and give what it gave."""
    end_s = time.monotonic() + most_s
    while not (found := condition()):
        assert time.monotonic() < end_s, "it never came"
        step()
    return found
