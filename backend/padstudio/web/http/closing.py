"""What keeps a request from going on: the server's end, and bodies that stop coming.

At the server's end what is under way is answered, and nothing keeps it waiting: what was received
of a body is kept, event streams end at once, and who would have to wait any longer gets 503.
"""

from __future__ import annotations

import asyncio
import contextlib
from typing import Any

from starlette.datastructures import Headers
from starlette.requests import Request
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from padstudio.errors import BusyError, StudioError
from padstudio.web.http import errors
from padstudio.web.pages.headers import SECURITY_HEADERS

#: Requests under way get this long to finish, s; then the server lets go of them.
GRACE_S = 2.0
#: Of a body something has to come so often, s; how long all of it takes does not matter.
STALL_S = 10.0


class StalledError(StudioError):
    """The rest of a body does not come."""

    code = "request_timeout"
    status = 408


class Closing:
    """Whether the server ends; to be asked and told in its event loop."""

    def __init__(self) -> None:
        self._event = asyncio.Event()

    def begin(self) -> None:
        """From now on nothing new is taken."""
        self._event.set()

    @property
    def has_begun(self) -> bool:
        """True once the server ends."""
        return self._event.is_set()

    async def wait(self) -> None:
        """Until it ends."""
        await self._event.wait()


class ClosingGuard:
    """ASGI middleware that answers requests of a server that ends, and requests that stop.

    Parameters
    ----------
    app : ASGI application
    closing : Closing
    grace_s, stall_s : float
        `GRACE_S` and `STALL_S`, or other times.
    """

    def __init__(
        self,
        app: ASGIApp,
        closing: Closing,
        grace_s: float = GRACE_S,
        stall_s: float = STALL_S,
    ) -> None:
        self.app, self._closing = app, closing
        self._grace_s, self._stall_s = grace_s, stall_s

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        answer = _Answer(scope, receive, send, self._closing, self._stall_s)
        if self._closing.has_begun:
            await answer.refuse()
            return
        work = asyncio.ensure_future(self.app(scope, answer.receive, answer.send))
        ends = asyncio.ensure_future(self._closing.wait())
        try:
            await asyncio.wait({work, ends}, return_when=asyncio.FIRST_COMPLETED)
            if not work.done():
                answer.cut()
                await asyncio.wait({work}, timeout=0.0 if answer.is_events else self._grace_s)
            is_done = work.done()
            work.cancel()
            with contextlib.suppress(*(() if is_done else (asyncio.CancelledError,))):
                await work
            if self._closing.has_begun:
                await answer.finish()
        finally:
            ends.cancel()
            work.cancel()


class _Answer:
    """One request's way in and out."""

    def __init__(
        self, scope: Scope, receive: Receive, send: Send, closing: Closing, stall_s: float
    ) -> None:
        self._scope, self._receive, self._send = scope, receive, send
        self._closing, self._stall_s, self._has_stalled = closing, stall_s, False
        self._has_body = self._was_cut = self._has_begun = self._has_ended = False
        self._waiting: asyncio.Task[Any] | None = None
        self.is_events = False

    async def receive(self) -> Message:
        """The next part of the body; none comes any more once the server ends, or after a stall."""
        if self._has_body:
            return await self._receive()
        if self._closing.has_begun or self._has_stalled:
            self._was_cut = True
            return {"type": "http.disconnect"}
        task = self._waiting = asyncio.current_task()
        try:
            async with asyncio.timeout(self._stall_s):
                message = await self._receive()
        except TimeoutError:
            self._was_cut = self._has_stalled = True
            return {"type": "http.disconnect"}
        except asyncio.CancelledError:
            if not self._was_cut or task is None:
                raise
            task.uncancel()
            return {"type": "http.disconnect"}
        finally:
            self._waiting = None
        self._has_body = not message.get("more_body", False)
        return message

    def cut(self) -> None:
        """Wait for no more of the body."""
        if self._waiting is not None:
            self._was_cut = True
            self._waiting.cancel()

    async def send(self, message: Message) -> None:
        """What the application answers; where its body was cut off, why."""
        if self._was_cut and not self._has_begun:
            await self.refuse()
        if self._was_cut and self._has_ended:
            return
        if message["type"] == "http.response.start":
            self._has_begun = True
            kind = Headers(raw=message["headers"]).get("content-type", "")
            self.is_events = kind.startswith("text/event-stream")
        elif not message.get("more_body", False):
            self._has_ended = True
        await self._send(message)

    async def refuse(self) -> None:
        """Say that the server ends, or that the body does not."""
        request = Request(self._scope)
        error: StudioError = BusyError(
            "the server is shutting down; ask again when it is back", code="shutting_down"
        )
        if self._has_stalled:
            error = StalledError(
                f"nothing more of the request came for {self._stall_s:g} s; send it again, an "
                "upload from where it is"
            )
        response = errors.respond_error(request, error)
        response.headers.update({**SECURITY_HEADERS, "Connection": "close"})
        self._has_begun = self._has_ended = True
        await response(self._scope, self._receive, self._send)

    async def finish(self) -> None:
        """End an answer that is not ready: an event stream whole; a file's body stays cut off."""
        if not self._has_begun:
            await self.refuse()
        elif self.is_events and not self._has_ended:
            await self._send({"type": "http.response.body", "body": b"", "more_body": False})
