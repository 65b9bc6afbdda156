"""Relays that lose and exchange a seeded share of UDP packets, alone or within RTSP."""

from __future__ import annotations

import contextlib
import random
import re
import select
import socket
import threading

_HOST = "127.0.0.1"
_MOST = 65536


class UdpRelay:
    """Hands packets on from a port of its own to another.

    Parameters
    ----------
    target : int
        Port of 127.0.0.1.
    drop, reorder : float
        Shares of packets that are lost, and that come after the one behind them.
    seed : int
        The same seed has the same packets lost, counted from the first.
    port : int
        To listen at; 0: any.
    """

    def __init__(
        self, target: int, drop: float = 0.0, reorder: float = 0.0, seed: int = 1, port: int = 0
    ) -> None:
        self.target, self.drop, self.reorder = target, drop, reorder
        self.passed = self.lost = 0
        self._random = random.Random(seed)
        self._kept: bytes | None = None
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)
        self._socket.bind((_HOST, port))
        self.port: int = self._socket.getsockname()[1]
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Stop handing on."""
        # Who waits for a packet is woken by one.
        with contextlib.suppress(OSError), socket.socket(type=socket.SOCK_DGRAM) as waker:
            self._is_closed = True
            waker.sendto(b"", (_HOST, self.port))
        self._thread.join()
        self._socket.close()

    _is_closed = False

    def _run(self) -> None:
        while True:
            data = self._socket.recv(_MOST)
            if self._is_closed:
                return
            if self._random.random() < self.drop:
                self.lost += 1
            elif self._kept is None and self._random.random() < self.reorder:
                self._kept = data
            else:
                self._send(data)
                if self._kept is not None:
                    kept, self._kept = self._kept, None
                    self._send(kept)

    def _send(self, data: bytes) -> None:
        self.passed += 1
        # A client that has gone answers by an error.
        with contextlib.suppress(OSError):
            self._socket.sendto(data, (_HOST, self.target))


class RtspRelay:
    """Stands between RTSP clients and a server, whose RTP over UDP it loses a share of.

    Parameters
    ----------
    server : int
        The server's port on 127.0.0.1.
    drop, reorder, seed
        As of `UdpRelay`; reports of RTCP are handed on whole.
    """

    def __init__(self, server: int, drop: float = 0.0, reorder: float = 0.0, seed: int = 1) -> None:
        self.server, self.drop, self.reorder, self.seed = server, drop, reorder, seed
        self.relays: list[UdpRelay] = []
        self._sockets: list[socket.socket] = []
        self._listener = socket.create_server((_HOST, 0))
        self.port: int = self._listener.getsockname()[1]
        self.url = f"rtsp://{_HOST}:{self.port}/camera"
        threading.Thread(target=self._accept, daemon=True).start()

    @property
    def lost(self) -> int:
        """Packets lost on purpose."""
        return sum(relay.lost for relay in self.relays)

    def close(self) -> None:
        """End all connections."""
        for each in (self._listener, *self._sockets):
            with contextlib.suppress(OSError):
                each.shutdown(socket.SHUT_RDWR)
            each.close()
        for relay in self.relays:
            relay.close()

    def _accept(self) -> None:
        with contextlib.suppress(OSError):
            while True:
                client, _ = self._listener.accept()
                server = socket.create_connection((_HOST, self.server))
                self._sockets += [client, server]
                threading.Thread(target=self._talk, args=(client, server), daemon=True).start()

    def _talk(self, client: socket.socket, server: socket.socket) -> None:
        ports: list[int] = []
        with contextlib.suppress(OSError, ValueError):
            while True:
                ready, _, _ = select.select([client, server], [], [])
                for each in ready:
                    data = each.recv(_MOST)
                    if not data:
                        client.shutdown(socket.SHUT_RDWR)
                        server.shutdown(socket.SHUT_RDWR)
                        return
                    if each is client:
                        server.sendall(self._request(data, ports))
                    else:
                        client.sendall(self._reply(data, ports))

    def _request(self, data: bytes, ports: list[int]) -> bytes:
        """A request, with the relay's ports for the client's and the server's address."""
        found = re.search(rb"client_port=(\d+)-(\d+)", data)
        if found:
            ports[:] = [int(found[1]), int(found[2])]
            first = UdpRelay(ports[0], self.drop, self.reorder, self.seed)
            second = UdpRelay(ports[1])
            self.relays += [first, second]
            data = data.replace(found[0], b"client_port=%d-%d" % (first.port, second.port))
        return data.replace(b":%d/" % self.port, b":%d/" % self.server)

    def _reply(self, data: bytes, ports: list[int]) -> bytes:
        """A reply, with the client's own ports again."""
        if ports and b"client_port=" in data:
            data = re.sub(rb"client_port=\d+-\d+", b"client_port=%d-%d" % tuple(ports), data)
        return data.replace(b":%d/" % self.server, b":%d/" % self.port)
