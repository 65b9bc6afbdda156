"""Passes connections on to a server, and breaks or stops them after some bytes."""

from __future__ import annotations

import contextlib
import socket
import threading
from collections.abc import Iterator


class BreakingProxy:
    """A proxy on a free port of this machine.

    Attributes
    ----------
    port : int
    sent : int
        Bytes that clients have sent.
    break_after : int or None
        Break all connections once so many bytes were sent, once.
    stop_after : int or None
        Pass nothing more on after so many bytes, but keep connections open.
    """

    def __init__(self, target: int) -> None:
        self._target = target
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port = int(self._listener.getsockname()[1])
        self.sent = 0
        self.break_after: int | None = None
        self.stop_after: int | None = None
        self._open: list[socket.socket] = []
        threading.Thread(target=self._accept, daemon=True).start()

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    def close(self) -> None:
        self._listener.close()
        self._break()

    def _accept(self) -> None:
        with contextlib.suppress(OSError):
            while True:
                client, _ = self._listener.accept()
                server = socket.create_connection(("127.0.0.1", self._target))
                self._open += [client, server]
                for pump, ends in ((self._up, (client, server)), (_down, (server, client))):
                    threading.Thread(target=pump, args=ends, daemon=True).start()

    def _up(self, client: socket.socket, server: socket.socket) -> None:
        with contextlib.suppress(OSError):
            while data := client.recv(65536):
                self.sent += len(data)
                if self.break_after is not None and self.sent >= self.break_after:
                    self.break_after = None
                    self._break()
                    return
                if self.stop_after is None or self.sent < self.stop_after:
                    server.sendall(data)
        _end(server)

    def _break(self) -> None:
        for end in self._open:
            _end(end)
        self._open = []


@contextlib.contextmanager
def between(target: int) -> Iterator[BreakingProxy]:
    """A proxy before a server's port."""
    proxy = BreakingProxy(target)
    try:
        yield proxy
    finally:
        proxy.close()


def _down(server: socket.socket, client: socket.socket) -> None:
    with contextlib.suppress(OSError):
        while data := server.recv(65536):
            client.sendall(data)
    _end(client)


def _end(connection: socket.socket) -> None:
    with contextlib.suppress(OSError):
        connection.shutdown(socket.SHUT_RDWR)
    connection.close()
