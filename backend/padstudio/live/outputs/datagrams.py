"""One UDP datagram a report or event, sent at once; nothing waits, nothing is sent again."""

from __future__ import annotations

import socket
import time
from typing import Any

from padstudio.errors import StudioError
from padstudio.live.outputs.records import Records, datagram_of, event_record, sight_record
from padstudio.live.reports.event import EventKind
from padstudio.live.reports.report import LiveReport, Sight


class Datagrams:
    """An output, and one of events.

    Parameters
    ----------
    host : str
        Name, IPv4 or IPv6 address; a broadcast address, too.
    port : int
    records : Records
    max_age_s : float or None
        A pose whose frame was taken longer ago is not sent.

    Attributes
    ----------
    sent, failed, too_old : int
        Datagrams that the system took, and that it did not; poses that were too old.

    Raises
    ------
    StudioError
        If the host is not known.
    """

    def __init__(
        self, host: str, port: int, records: Records, max_age_s: float | None = None
    ) -> None:
        self._records, self._max_age_s = records, max_age_s
        try:
            found = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)
        except OSError as error:
            raise StudioError(
                f"the host {host} of --udp is not known: {error.strerror or error}",
                code="unknown_host",
            ) from error
        family, _, _, _, address = found[0]
        self._address: tuple[Any, ...] = address
        self._socket = socket.socket(family, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        if family == socket.AF_INET:
            self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
        self.sent = self.failed = self.too_old = 0

    def take(self, report: LiveReport) -> None:
        """Send a report, unless its pose is too old."""
        age_s = time.monotonic() - report.frame.taken_s
        if self._max_age_s is not None and report.detection.ok and age_s > self._max_age_s:
            self.too_old += 1
            return
        self._send(self._records.of(report))

    def sight_changed(self, sight: Sight, detail: str) -> None:
        """Send what changed."""
        self._send(sight_record(sight, detail))

    def stream_changed(self, kind: EventKind, detail: str, code: str) -> None:
        """Send what changed."""
        self._send(event_record(kind, detail, code))

    def close(self) -> None:
        """Let go of the socket."""
        self._socket.close()

    def _send(self, record: dict[str, Any]) -> None:
        try:
            self._socket.sendto(datagram_of(record), self._address)
        except OSError:
            # Nobody listens (ECONNREFUSED), the network is away, or its buffer is full.
            self.failed += 1
        else:
            self.sent += 1
