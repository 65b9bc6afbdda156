"""Requests whose head does not come."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Any, cast

import pytest
import uvicorn
from uvicorn.server import ServerState

from padstudio.web.http.connections import HEAD_S, Connection

HEAD = b"GET / HTTP/1.1\r\nHost: localhost\r\n"


class Timer:
    def __init__(self, due_s: float, call: Callable[[], None]) -> None:
        self.due_s, self.call, self.is_cancelled = due_s, call, False

    def cancel(self) -> None:
        self.is_cancelled = True


class Loop:
    """An event loop whose time goes by as it is told."""

    def __init__(self) -> None:
        self.now_s = 0.0
        self.timers: list[Timer] = []
        self.tasks: list[Any] = []

    def call_later(self, delay_s: float, call: Callable[[], None]) -> Timer:
        self.timers.append(Timer(self.now_s + delay_s, call))
        return self.timers[-1]

    def create_task(self, coroutine: Any, **_: Any) -> asyncio.Future[None]:
        self.tasks.append(coroutine)
        coroutine.close()
        return cast("asyncio.Future[None]", Task())

    def pass_time(self, seconds: float) -> None:
        self.now_s += seconds
        for timer in [t for t in self.timers if t.due_s <= self.now_s]:
            self.timers.remove(timer)
            if not timer.is_cancelled:
                timer.call()


class Task:
    def add_done_callback(self, _: Any) -> None:
        """The request goes on without end."""


class Transport(asyncio.Transport):
    def __init__(self) -> None:
        super().__init__()
        self.sent, self.is_closed = b"", False

    def get_extra_info(self, name: str, default: Any = None) -> Any:
        return default

    def write(self, data: Any) -> None:
        self.sent += data

    def close(self) -> None:
        self.is_closed = True

    def is_closing(self) -> bool:
        return self.is_closed

    def pause_reading(self) -> None:
        """Nothing is read by itself."""

    def resume_reading(self) -> None:
        """Nothing is read by itself."""


class Peer:
    """A connection, and who is at its other end."""

    def __init__(self) -> None:
        self.loop, self.transport = Loop(), Transport()
        config = uvicorn.Config(lambda: None, http=Connection, log_level="critical")  # type: ignore[arg-type]
        self.connection = Connection(config, ServerState(), {}, cast(Any, self.loop))
        self.connection.connection_made(self.transport)

    def send(self, data: bytes) -> None:
        self.connection.data_received(data)

    def answer(self) -> None:
        """The application has answered all of the request."""
        cycle = self.connection.cycle
        cycle.response_started = cycle.response_complete = True
        for event in (b"HTTP/1.1 204 No Content\r\n\r\n",):
            self.transport.write(event)
        self.connection.on_response_complete()


def test_who_says_nothing_is_let_go() -> None:
    peer = Peer()
    peer.loop.pass_time(HEAD_S)
    assert peer.transport.is_closed
    assert peer.transport.sent == b""


@pytest.mark.parametrize("every_s", [HEAD_S, 3.0, 0.5])
def test_half_a_head_is_closed_in_time_however_it_trickles(every_s: float) -> None:
    peer = Peer()
    peer.send(HEAD)
    while peer.loop.now_s < HEAD_S and not peer.transport.is_closed:
        peer.loop.pass_time(every_s)
        if not peer.transport.is_closed:
            peer.send(b"X-%d: 1\r\n" % len(peer.loop.timers))
    assert peer.transport.is_closed
    assert peer.transport.sent.startswith(b"HTTP/1.1 408 ")
    assert HEAD_S <= peer.loop.now_s <= HEAD_S + every_s


def test_a_request_that_is_worked_on_takes_its_time() -> None:
    peer = Peer()
    peer.send(HEAD + b"\r\n")
    peer.loop.pass_time(1000.0)
    assert len(peer.loop.tasks) == 1
    assert not peer.transport.is_closed


def test_the_next_request_on_a_connection_is_watched_too() -> None:
    peer = Peer()
    peer.send(HEAD + b"\r\n")
    peer.loop.pass_time(100.0)
    peer.answer()
    peer.loop.pass_time(1.0)
    peer.send(HEAD[:9])
    peer.loop.pass_time(HEAD_S - 0.1)
    assert not peer.transport.is_closed
    peer.loop.pass_time(0.2)
    assert peer.transport.is_closed


def test_what_nobody_reads_any_more_does_not_keep_a_connection() -> None:
    peer = Peer()
    peer.send(b"POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1000\r\n\r\nabc")
    peer.answer()
    for _ in range(30):
        if not peer.transport.is_closed:
            peer.send(b"x")
        peer.loop.pass_time(1.0)
    assert peer.transport.is_closed
