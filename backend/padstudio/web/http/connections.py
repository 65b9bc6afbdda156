"""Connections on which a request comes in time, or that are closed."""

from __future__ import annotations

import asyncio

from uvicorn.protocols.http.h11_impl import H11Protocol

#: A request's head has to come within so long from its first byte, or from the connection's start.
HEAD_S = 10.0
_TOO_LATE = b"HTTP/1.1 408 Request Timeout\r\nConnection: close\r\nContent-Length: 0\r\n\r\n"


class Connection(H11Protocol):
    """Uvicorn's, which by itself waits for the rest of a head without end.

    Who sends a little now and then gains no time. Bodies are `ClosingGuard`'s.
    """

    _due: asyncio.TimerHandle | None = None
    _has_come = False

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """As of `asyncio.Protocol`."""
        super().connection_made(transport)
        self._watch()

    def data_received(self, data: bytes) -> None:
        """As of `asyncio.Protocol`."""
        self._has_come = True
        super().data_received(data)
        self._watch()

    def connection_lost(self, exc: Exception | None) -> None:
        """As of `asyncio.Protocol`."""
        self._forget()
        super().connection_lost(exc)

    def on_response_complete(self) -> None:
        """What comes from now on is of the next request."""
        self._has_come = False
        super().on_response_complete()

    @property
    def _is_served(self) -> bool:
        return self.cycle is not None and not self.cycle.response_complete

    def _watch(self) -> None:
        if self._is_served or self.transport.is_closing():
            self._forget()
        elif self._due is None:
            self._due = self.loop.call_later(HEAD_S, self._close)

    def _forget(self) -> None:
        if self._due is not None:
            self._due.cancel()
            self._due = None

    def _close(self) -> None:
        self._due = None
        if self._is_served or self.transport.is_closing():
            return
        if self._has_come and self.cycle is None:
            self.transport.write(_TOO_LATE)
        self.transport.close()
