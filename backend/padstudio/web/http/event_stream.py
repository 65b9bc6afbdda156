"""Server-Sent Events."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator

from starlette.responses import StreamingResponse
from starlette.types import Receive, Scope, Send

from padstudio.web.server.places import Places

#: Something is said so often, s, so that proxies keep the connection.
PING_S = 15.0
_PING = b": ping\r\n\r\n"


class EventStream(StreamingResponse):
    """An answer that tells events as they come, and takes a place meanwhile.

    Parameters
    ----------
    events : async iterator of bytes
        As `event` makes them.
    places : Places
    """

    media_type = "text/event-stream"

    def __init__(self, events: AsyncIterator[bytes], places: Places) -> None:
        headers = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}
        super().__init__(_with_pings(events, PING_S), headers=headers)
        self._places = places

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        with self._places.taken():
            await super().__call__(scope, receive, send)


def event(kind: str, data: str) -> bytes:
    """An event, whose data has no line breaks."""
    return f"event: {kind}\r\ndata: {data}\r\n\r\n".encode()


async def _with_pings(events: AsyncIterator[bytes], every_s: float) -> AsyncIterator[bytes]:
    """The events, and something after each silence."""
    following: asyncio.Future[bytes] | None = None
    try:
        while True:
            following = following or asyncio.ensure_future(anext(events))
            done, _ = await asyncio.wait({following}, timeout=every_s)
            if not done:
                yield _PING
                continue
            ended, following = following, None
            try:
                yield ended.result()
            except StopAsyncIteration:
                return
    finally:
        if following is not None:
            following.cancel()
