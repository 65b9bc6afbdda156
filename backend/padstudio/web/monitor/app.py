"""The addresses of a live session: events, figures, frames."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator, Callable
from typing import Annotated, Any

from fastapi import APIRouter, FastAPI
from fastapi import Path as PathParameter
from starlette.responses import FileResponse, Response

from padstudio.live.outputs.watch import Watch
from padstudio.web.http import errors
from padstudio.web.http.event_stream import EventStream, event
from padstudio.web.http.security import Guard
from padstudio.web.monitor.frames import LastFrames
from padstudio.web.server.places import Places
from padstudio.web.server.settings import Settings

# Figures are told so often; and something is said so often that who listens knows of the end.
_STATS_EVERY_S = 1.0

Number = Annotated[int, PathParameter(ge=0, le=2**53)]
PictureName = Annotated[str, PathParameter(pattern=r"^[a-z_-]{1,60}\.png$")]


class Bell:
    """Wakes all watchers; rung from any thread, heard in the server's."""

    def __init__(self) -> None:
        self._loop: asyncio.AbstractEventLoop | None = None
        self._rung = asyncio.Event()
        self._is_ringing = False

    def ring(self) -> None:
        """Wake who waits; the second call before they woke costs nothing."""
        loop = self._loop
        if loop is None or self._is_ringing or loop.is_closed():
            return
        self._is_ringing = True
        loop.call_soon_threadsafe(self._wake)

    async def wait(self, timeout_s: float) -> None:
        """Wait until it rings, or so long."""
        self._loop = asyncio.get_running_loop()
        rung = self._rung
        try:
            await asyncio.wait_for(rung.wait(), timeout_s)
        except TimeoutError:
            return

    def _wake(self) -> None:
        self._is_ringing = False
        rung, self._rung = self._rung, asyncio.Event()
        rung.set()


def create_app(
    settings: Settings,
    watch: Watch,
    frames: LastFrames,
    stats: Callable[[], dict[str, Any]],
) -> FastAPI:
    """The application; the guard of the studio's own server stands before it.

    Parameters
    ----------
    settings : Settings
        Host, token and allowed hosts are used.
    watch : Watch
    frames : LastFrames
    stats : callable
        The session's figures as of now.
    """
    app = FastAPI(title="Pad Studio, live", docs_url=None, redoc_url=None, openapi_url=None)
    errors.install(app)
    app.include_router(_routes(watch, frames, stats, Places(settings.max_streams)))
    app.add_middleware(Guard, settings=settings)
    return app


def _routes(
    watch: Watch, frames: LastFrames, stats: Callable[[], dict[str, Any]], places: Places
) -> APIRouter:
    router = APIRouter()
    bell = Bell()
    watch.on_change(bell.ring)

    @router.get("/events")
    async def events() -> Response:
        return EventStream(_events(watch, bell, stats), places)

    @router.get("/stats")
    async def figures() -> dict[str, Any]:
        return stats()

    @router.get("/frames")
    async def known() -> list[dict[str, Any]]:
        return [
            {
                "number": report.frame.number,
                "status": "ok" if report.detection.ok else "failed",
                "reason": None
                if report.detection.failure is None
                else str(report.detection.failure.reason),
            }
            for report in watch.reports()
        ]

    @router.get("/frames/{number}/picture")
    async def picture(number: Number) -> Response:
        return Response(await frames.picture(number), media_type="image/jpeg")

    @router.get("/frames/{number}/trace")
    async def trace(number: Number) -> dict[str, Any]:
        return await frames.trace(number)

    @router.get("/frames/{number}/trace/{name}")
    async def trace_picture(number: Number, name: PictureName) -> FileResponse:
        return FileResponse(frames.trace_picture(number, name), media_type="image/png")

    return router


async def _events(
    watch: Watch, bell: Bell, stats: Callable[[], dict[str, Any]]
) -> AsyncIterator[bytes]:
    """What is new, as Server-Sent Events; who is too slow misses some, and their ids tell."""
    loop = asyncio.get_running_loop()
    number, told_s = watch.newest(), -_STATS_EVERY_S
    while True:
        is_over = watch.is_over
        for entry in watch.after(number):
            number = entry.number
            yield f"id: {number}\n".encode() + event(entry.kind, entry.text)
        if is_over or loop.time() - told_s >= _STATS_EVERY_S:
            told_s = loop.time()
            yield event("stats", json.dumps(stats()))
        if is_over:
            return
        await bell.wait(_STATS_EVERY_S)
