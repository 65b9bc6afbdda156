"""What becomes of requests when the server ends."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Awaitable, Callable, Coroutine
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest
from starlette.requests import ClientDisconnect, Request
from starlette.responses import PlainTextResponse, Response, StreamingResponse
from starlette.types import Message, Receive, Scope, Send

from padstudio.web.http.closing import Closing, ClosingGuard

Endpoint = Callable[[Request], Awaitable[Response]]


class Exchange:
    """A request to one endpoint behind the guard."""

    def __init__(
        self, endpoint: Endpoint, *body: bytes, is_whole: bool = True, stall_s: float = 60.0
    ) -> None:
        self.closing = Closing()
        self.sent: list[Message] = []
        self._parts: asyncio.Queue[Message] = asyncio.Queue()
        for place, part in enumerate(body or (b"",)):
            more = not is_whole or place + 1 < len(body)
            self._parts.put_nowait({"type": "http.request", "body": part, "more_body": more})

        async def app(scope: Scope, receive: Receive, send: Send) -> None:
            response = await endpoint(Request(scope, receive))
            await response(scope, receive, send)

        self._guard = ClosingGuard(app, self.closing, grace_s=0.05, stall_s=stall_s)

    async def _send(self, message: Message) -> None:
        self.sent.append(message)

    async def run(self) -> None:
        scope: dict[str, Any] = {
            "type": "http",
            "asgi": {"version": "3.0", "spec_version": "2.4"},
            "method": "POST",
            "path": "/api/v1/things",
            "query_string": b"",
            "headers": [],
        }
        await asyncio.wait_for(self._guard(scope, self._parts.get, self._send), 30)

    @property
    def status(self) -> int:
        return int(self.sent[0]["status"])

    @property
    def body(self) -> bytes:
        return b"".join(m.get("body", b"") for m in self.sent[1:])

    def is_refused(self) -> bool:
        headers = dict(self.sent[0]["headers"])
        told = json.loads(self.body)["error"]["code"] if self.status == 503 else ""
        return (
            told == "shutting_down"
            and headers[b"connection"] == b"close"
            and b"retry-after" in headers
            and len(self.sent) == 2
        )


def _run(coroutine: Coroutine[Any, Any, Any]) -> Any:
    """Its result; in a thread, as a browser of other tests may have a loop in this one."""
    with ThreadPoolExecutor(1) as thread:
        return thread.submit(asyncio.run, coroutine).result()


async def _forever(_: Request) -> Response:
    await asyncio.Event().wait()
    raise AssertionError


def test_what_finishes_within_the_grace_is_answered() -> None:
    async def quick(_: Request) -> Response:
        exchange.closing.begin()
        await asyncio.sleep(0)
        return PlainTextResponse("done")

    exchange = Exchange(quick)
    _run(exchange.run())
    assert (exchange.status, exchange.body) == (200, b"done")


def test_what_would_take_longer_gets_503() -> None:
    async def run() -> Exchange:
        exchange = Exchange(_forever)
        asyncio.get_running_loop().call_soon(exchange.closing.begin)
        await exchange.run()
        return exchange

    assert _run(run()).is_refused()


def test_nothing_new_is_taken() -> None:
    exchange = Exchange(_forever)
    exchange.closing.begin()
    _run(exchange.run())
    assert exchange.is_refused()


@pytest.mark.parametrize("parts", [1, 3])
def test_what_came_of_a_body_is_seen_and_the_sender_gets_503(parts: int) -> None:
    kept: list[bytes] = []

    async def store(request: Request) -> Response:
        try:
            async for part in request.stream():
                kept.append(part)
                if len(kept) == parts:
                    exchange.closing.begin()
        except ClientDisconnect:
            return PlainTextResponse("the connection broke", 400)
        raise AssertionError

    exchange = Exchange(store, *[b"x" * 9] * parts, is_whole=False)
    _run(exchange.run())
    assert kept == [b"x" * 9] * parts
    assert exchange.is_refused()


def test_an_event_stream_ends_at_once_and_whole() -> None:
    async def events(_: Request) -> Response:
        async def lines() -> Any:
            yield b"data: 1\n\n"
            exchange.closing.begin()
            await asyncio.Event().wait()

        return StreamingResponse(lines(), media_type="text/event-stream")

    exchange = Exchange(events)
    _run(exchange.run())
    assert exchange.body == b"data: 1\n\n"
    assert exchange.sent[-1]["more_body"] is False


def test_a_file_that_goes_out_is_cut_and_never_ended_as_if_whole() -> None:
    async def download(_: Request) -> Response:
        async def blocks() -> Any:
            yield b"half"
            exchange.closing.begin()
            await asyncio.Event().wait()

        return StreamingResponse(blocks(), media_type="video/mp4")

    exchange = Exchange(download)
    _run(exchange.run())
    assert exchange.sent[-1].get("more_body")
    assert [m["type"] for m in exchange.sent].count("http.response.start") == 1


def test_errors_of_the_application_go_on() -> None:
    async def broken(_: Request) -> Response:
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        _run(Exchange(broken).run())


def test_a_body_that_stops_coming_is_kept_as_far_as_it_came_and_told() -> None:
    kept: list[bytes] = []

    async def store(request: Request) -> Response:
        try:
            async for part in request.stream():
                kept.append(part)
        except ClientDisconnect:
            return PlainTextResponse("the connection broke", 400)
        raise AssertionError

    exchange = Exchange(store, b"abc", b"def", is_whole=False, stall_s=0.0)
    _run(exchange.run())
    assert kept == [b"abc", b"def"]
    assert exchange.status == 408
    assert json.loads(exchange.body)["error"]["code"] == "request_timeout"
    assert dict(exchange.sent[0]["headers"])[b"connection"] == b"close"


def test_a_body_that_is_whole_is_not_waited_for() -> None:
    async def slow(request: Request) -> Response:
        data = await request.body()
        for _ in range(9):
            await asyncio.sleep(0)
        return PlainTextResponse(data)

    exchange = Exchange(slow, b"abc", stall_s=0.0)
    _run(exchange.run())
    assert (exchange.status, exchange.body) == (200, b"abc")
