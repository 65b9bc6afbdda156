"""The methods that an address takes, as Allow names them."""

from __future__ import annotations

from collections.abc import Iterable

from fastapi import Request
from fastapi.routing import APIRoute
from starlette.responses import Response
from starlette.routing import BaseRoute, compile_path
from starlette.types import ASGIApp, Receive, Scope, Send

from padstudio.web.http import errors


class Methods:
    """ASGI middleware that answers OPTIONS, and for methods that an address does not take.

    The framework's own router knows the first of an address's routes only, and takes one without
    parameters (``/pads/import``) for one with them (``/pads/{pad_id}``) where the method differs.

    Parameters
    ----------
    app : ASGI application
    routes : iterable of (prefix, route)
        In the order in which they are tried.
    """

    def __init__(self, app: ASGIApp, routes: Iterable[tuple[str, BaseRoute]]) -> None:
        self.app = app
        taken: dict[str, set[str]] = {}
        for prefix, route in routes:
            if isinstance(route, APIRoute):
                taken.setdefault(prefix + route.path, set()).update(route.methods or ())
        # A name of its own is no id, wherever its route stands.
        by_names = sorted(taken, key=lambda path: path.count("{"))
        self._taken = {compile_path(path)[0]: taken[path] for path in by_names}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        app = self.app
        if scope["type"] == "http":
            taken = self._methods(scope["path"])
            if taken and scope["method"] not in taken:
                app = _refusal(Request(scope), taken)
        await app(scope, receive, send)

    def _methods(self, path: str) -> set[str] | None:
        return next((each for at, each in self._taken.items() if at.match(path)), None)


def _refusal(request: Request, taken: set[str]) -> Response:
    headers = {"Allow": ", ".join(sorted(taken | {"OPTIONS"}))}
    if request.method == "OPTIONS":
        return Response(status_code=204, headers=headers)
    return errors.respond(
        request, 405, "method_not_allowed", errors.HTTP_MESSAGES[405], headers=headers
    )
