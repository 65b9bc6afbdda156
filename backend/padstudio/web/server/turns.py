"""One request at a time on a thing, where the newest wins."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager


class Turns:
    """Turns at things, by name; for the tasks of one event loop.

    A sender whose connection broke comes back while the server still waits for bytes on the old
    one. Whoever asks for a turn therefore tells the holder to stop, and gets it when he has.
    """

    def __init__(self) -> None:
        self._holders: dict[str, tuple[asyncio.Event, asyncio.Event]] = {}

    @asynccontextmanager
    async def take(self, name: str) -> AsyncIterator[asyncio.Event]:
        """Hold the turn at a thing.

        Yields
        ------
        asyncio.Event
            Set when somebody else waits: stop as soon as what is done can stay.
        """
        while name in self._holders:
            stop, done = self._holders[name]
            stop.set()
            await done.wait()
        stop, done = asyncio.Event(), asyncio.Event()
        self._holders[name] = stop, done
        try:
            yield stop
        finally:
            del self._holders[name]
            done.set()
