"""Flights as those see them who watch: one look for all who watch the same one."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import AsyncIterator, Awaitable, Callable

from fastapi.concurrency import run_in_threadpool

from padstudio.errors import NotFoundError

logger = logging.getLogger(__name__)

# Between two looks at a flight, s; and so many watchers are told a second, so that a crowd is told
# less often rather than at the cost of everything else.
_LOOK_EVERY_S = 0.5
_TOLD_A_SECOND = 250

Look = Callable[[str], tuple[str, bool]]


class FlightWatch:
    """Tells what becomes of flights; of one event loop.

    Parameters
    ----------
    sleep : callable
        As `asyncio.sleep`.
    """

    def __init__(self, sleep: Callable[[float], Awaitable[object]] = asyncio.sleep) -> None:
        self._sleep = sleep
        self._watched: dict[str, _Watched] = {}

    async def watch(self, flight_id: str, look: Look) -> AsyncIterator[str]:
        """What there is to tell of a flight now, and after every change, until it is over.

        Parameters
        ----------
        flight_id : str
        look : callable
            Gives what is to be told of a flight, and whether it is over; runs in a thread, the
            first watcher's for all. Raises `NotFoundError` where the flight is gone.
        """
        watched = self._watched.get(flight_id)
        if watched is None:
            watched = self._watched[flight_id] = _Watched()
            watched.follower = asyncio.create_task(self._follow(flight_id, look, watched))
        watched.watchers += 1
        told = ""
        try:
            while True:
                changed = watched.changed
                if watched.text != told:
                    told = watched.text
                    yield told
                elif watched.is_over:
                    return
                else:
                    await changed.wait()
        finally:
            watched.watchers -= 1
            if not watched.watchers:
                watched.follower.cancel()
                self._forget(flight_id, watched)

    async def _follow(self, flight_id: str, look: Look, watched: _Watched) -> None:
        while not watched.is_over:
            try:
                watched.tell(*await run_in_threadpool(look, flight_id))
            except NotFoundError:
                watched.tell(watched.text, True)
            except Exception:
                logger.exception("a flight that is watched cannot be looked at; trying again")
            if not watched.is_over:
                await self._sleep(max(_LOOK_EVERY_S, watched.watchers / _TOLD_A_SECOND))
        # It may go on: who comes later has another look.
        self._forget(flight_id, watched)

    def _forget(self, flight_id: str, watched: _Watched) -> None:
        if self._watched.get(flight_id) is watched:
            del self._watched[flight_id]


class _Watched:
    """What was last seen of a flight, and who wants to know."""

    follower: asyncio.Task[None]

    def __init__(self) -> None:
        self.text, self.is_over, self.watchers = "", False, 0
        self.changed = asyncio.Event()

    def tell(self, text: str, is_over: bool) -> None:
        if (text, is_over) != (self.text, self.is_over):
            self.text, self.is_over = text, is_over
            before, self.changed = self.changed, asyncio.Event()
            before.set()
