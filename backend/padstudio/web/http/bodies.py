"""How much of a request's body is read, and what becomes of the rest."""

from __future__ import annotations

import asyncio
import contextlib
import re

from fastapi import Request
from starlette.types import Message, Receive, Send

from padstudio.web.http import errors, tus
from padstudio.web.server.settings import Settings

_BUNDLE_PATH = "/api/v1/bundles/open"
# A refused body is read and thrown away for so long at the most, and while bytes come, s: many
# clients read no answer before they have sent all, and a connection that is closed on bytes
# under way is reset, which takes the answer with it.
LINGER_S, SILENCE_S = 30.0, 5.0


class Body:
    """A request's body, counted as it arrives: a declared length need not be there or true.

    Parameters
    ----------
    request : Request
    receive : callable
        Where it comes from.
    settings : Settings
    """

    def __init__(self, request: Request, receive: Receive, settings: Settings) -> None:
        self._receive = receive
        self._stated, self._limit = _limits(request, settings)
        # A client that asks before it sends is told at once, and sends nothing then.
        self._asks = request.headers.get("expect", "").lower() == "100-continue"
        declared = request.headers.get("content-length", "")
        # Longer numbers are no lengths, and the framework refuses them.
        is_number = bool(re.fullmatch(r"[0-9]{1,20}", declared))
        self._is_beyond = is_number and int(declared) > self._limit
        self._read = 0
        self._was_refused = self._has_ended = False

    async def receive(self) -> Message:
        """The next part.

        Raises
        ------
        BodyTooLargeError
            If it is, or is declared to be, larger than its limit.
        """
        if not self._is_beyond:
            message = await self._next()
            self._read += len(message.get("body", b""))
            self._is_beyond = self._read > self._limit
        if self._is_beyond:
            self._was_refused = True
            raise errors.BodyTooLargeError(self._stated)
        return message

    def lingering(self, send: Send) -> Send:
        """Where the answer goes: of a body that was refused, the rest is read before its end."""

        async def send_lingering(message: Message) -> None:
            is_last = message["type"] == "http.response.body" and not message.get("more_body")
            if is_last and self._was_refused and not self._asks:
                await send({**message, "more_body": True})
                await self._discard()
                message = {"type": "http.response.body", "body": b""}
            await send(message)

        return send_lingering

    async def _next(self) -> Message:
        message = await self._receive()
        self._has_ended = not message.get("more_body", False)
        return message

    async def _discard(self) -> None:
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(LINGER_S):
                while not self._has_ended:
                    async with asyncio.timeout(SILENCE_S):
                        await self._next()


def _limits(request: Request, settings: Settings) -> tuple[int, int]:
    """Bytes of the limit as it is told, and of the body that is taken."""
    is_upload = request.headers.get("content-type", "").startswith("multipart/form-data")
    stated = settings.max_upload_bytes if is_upload else settings.max_request_bytes
    if is_upload and request.url.path == _BUNDLE_PATH:
        stated = settings.max_bundle_bytes
    if tus.carries_bytes(request.headers) and request.url.path.startswith(tus.PATH):
        stated = settings.max_flight_bytes
    # The parts' headers and the form's other fields come on top of the file.
    return stated, stated + (settings.max_request_bytes if is_upload else 0)
