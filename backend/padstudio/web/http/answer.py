"""What every answer has: its headers, and where it is an error the one shape."""

from __future__ import annotations

from fastapi import Request
from starlette.datastructures import MutableHeaders
from starlette.types import Message, Send

from padstudio.web.http import errors, tus
from padstudio.web.pages.headers import SECURITY_HEADERS

# Of errors that the framework words itself, what the client needs to know of its file.
_KEPT = ("content-range",)


class Answer:
    """An answer on its way.

    Parameters
    ----------
    request : Request
    send : callable
        Where it goes.
    """

    def __init__(self, request: Request, send: Send) -> None:
        self._request, self._send = request, send
        self._is_replaced = False
        self.has_begun = False

    async def send(self, message: Message) -> None:
        """Pass a part of it on."""
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            path = self._request.url.path
            self._is_replaced = (
                message["status"] >= 400
                and path.startswith(errors.API_PREFIX)
                and not headers.get("content-type", "").startswith("application/json")
            )
            if self._is_replaced:
                await self._replace(message["status"], headers)
                return
            for name, value in SECURITY_HEADERS.items():
                headers.setdefault(name, value)
            if path.startswith(tus.PATH):
                headers.update(tus.EVERYWHERE)
        if not self._is_replaced:
            self.has_begun = True
            await self._send(message)

    async def _replace(self, status: int, headers: MutableHeaders) -> None:
        kept = {name: headers[name] for name in _KEPT if name in headers}
        answer = Answer(self._request, self._send)
        response = errors.respond_http(self._request, status, kept)
        self.has_begun = True
        await response(self._request.scope, self._request.receive, answer.send)
