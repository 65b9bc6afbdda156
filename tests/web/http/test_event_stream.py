"""Streams of events: their form, their pings, and how many there may be."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator, Coroutine
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest
from fastapi import FastAPI
from starlette.types import Message

from padstudio.web.http import errors
from padstudio.web.http.event_stream import EventStream, event
from padstudio.web.server.places import Places


def _run(coroutine: Coroutine[Any, Any, Any]) -> Any:
    """Its result; in a thread, as a browser of other tests may have a loop in this one."""
    with ThreadPoolExecutor(1) as thread:
        return thread.submit(asyncio.run, coroutine).result()


class Watcher:
    """Somebody who asks an application for its events, and may go away."""

    def __init__(self, app: FastAPI) -> None:
        self._app = app
        self._messages: asyncio.Queue[Message] = asyncio.Queue()
        self._messages.put_nowait({"type": "http.request", "body": b"", "more_body": False})
        self.sent: list[Message] = []
        self.told = asyncio.Event()

    async def ask(self) -> None:
        scope: dict[str, Any] = {
            "type": "http",
            "asgi": {"version": "3.0", "spec_version": "2.3"},
            "method": "GET",
            "path": "/events",
            "query_string": b"",
            "headers": [],
        }

        async def send(message: Message) -> None:
            self.sent.append(message)
            if message.get("body"):
                self.told.set()

        await self._app(scope, self._messages.get, send)

    def leave(self) -> None:
        self._messages.put_nowait({"type": "http.disconnect"})

    @property
    def body(self) -> bytes:
        return b"".join(message.get("body", b"") for message in self.sent)


def _app(places: Places) -> FastAPI:
    app = FastAPI()
    errors.install(app)

    async def endless() -> AsyncIterator[bytes]:
        yield event("flight", "1")
        await asyncio.Event().wait()

    @app.get("/events", response_class=EventStream)
    async def events() -> EventStream:
        return EventStream(endless(), places)

    return app


def test_who_comes_when_all_places_are_taken_is_told_when_to_try_again() -> None:
    async def run() -> tuple[Watcher, Watcher, Watcher]:
        app = _app(Places(1))
        first, second, third = Watcher(app), Watcher(app), Watcher(app)
        watching = asyncio.ensure_future(first.ask())
        await first.told.wait()
        await second.ask()
        first.leave()
        await watching
        again = asyncio.ensure_future(third.ask())
        await third.told.wait()
        third.leave()
        await again
        return first, second, third

    first, second, third = _run(run())
    assert first.body == third.body == b"event: flight\r\ndata: 1\r\n\r\n"
    assert second.sent[0]["status"] == 503
    assert b"retry-after" in dict(second.sent[0]["headers"])
    assert json.loads(second.body)["error"]["code"] == "too_many_streams"


def test_silence_is_broken_by_pings(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("padstudio.web.http.event_stream.PING_S", 0.0)

    async def run() -> list[bytes]:
        goes_on = asyncio.Event()

        async def events() -> AsyncIterator[bytes]:
            await goes_on.wait()
            yield event("flight", "1")

        told = []
        async for part in EventStream(events(), Places(1)).body_iterator:
            told.append(bytes(part))
            if len(told) == 3:
                goes_on.set()
        return told

    told = _run(run())
    assert told[0] == told[2] == b": ping\r\n\r\n"
    assert told[-1] == event("flight", "1")
