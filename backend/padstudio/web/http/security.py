"""Who may ask: token, host, origin; with the size of bodies and the headers of every answer."""

from __future__ import annotations

import hashlib
import hmac
import html
import re
from collections.abc import Iterable
from http.cookies import CookieError, SimpleCookie
from typing import Any
from urllib.parse import parse_qsl, urlencode, urlsplit

from fastapi import Request
from starlette.responses import HTMLResponse, Response
from starlette.types import ASGIApp, Receive, Scope, Send

from padstudio import text
from padstudio.errors import AccessError, StudioError
from padstudio.web.http import errors
from padstudio.web.http.answer import Answer
from padstudio.web.http.bodies import Body
from padstudio.web.http.wrong_tokens import WrongTokens
from padstudio.web.server.settings import Settings, is_loopback

_SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})
# Enough to tell a health check that the server is up; it says nothing else.
_OPEN_PATHS = frozenset({"/api/v1/health"})
_HOST = re.compile(r"(?P<name>[A-Za-z0-9._-]{1,255}|\[[0-9A-Fa-f:.]{2,45}\])(:(?P<port>\d{1,5}))?")
_FOREIGN = "foreign_host"


class TokenError(AccessError):
    """The token is missing or wrong."""

    code = "token_required"
    status = 401


class WrongTokenError(TokenError):
    """A token was given, and is not ours."""


class Guard:
    """ASGI middleware that stands before everything else.

    Parameters
    ----------
    app : ASGI application
    settings : Settings
    """

    def __init__(self, app: ASGIApp, settings: Settings) -> None:
        self.app, self.settings = app, settings
        self._wrong_tokens = WrongTokens()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        scope = dict(scope)
        request = Request(scope)
        answer = Answer(request, send)
        body = Body(request, receive, self.settings)
        try:
            app = await self._app(scope, request)
            await app(scope, body.receive, body.lingering(answer.send))
        except Exception as error:
            # What is under way cannot be taken back: the server closes the connection.
            if answer.has_begun:
                raise
            app = await errors.defect(request, error)
            await app(scope, receive, answer.send)

    async def _app(self, scope: Scope, request: Request) -> ASGIApp:
        """Who answers: the application, or here."""
        try:
            try:
                entry = self._check(request)
            except WrongTokenError:
                await self._wrong_tokens.slow_down()
                raise
            scope.update(_plain_address(scope))
        except StudioError as error:
            return errors.respond_error(request, error)
        return self.app if entry is None else entry

    def _check(self, request: Request) -> Response | None:
        """Raise `AccessError` where a request may not pass; a response where a token lets in."""
        host = _host(request)
        self._check_origin(request)
        token = self.settings.token
        if token is None:
            _check_host(host, self.settings.allowed_hosts)
            return None
        if request.url.path in _OPEN_PATHS:
            return None
        given = request.query_params.get("token")
        if given is not None and _same(given, token):
            is_page = not request.url.path.startswith((errors.API_PREFIX, "/static/"))
            return _enter(request, token) if is_page and request.method == "GET" else None
        if not (_bearer(request, token) or _cookie(request, token)):
            raise (WrongTokenError if _gives_token(request) else TokenError)(
                "this server asks for a token: open the address with ?token=... that it printed "
                "when it started, or send the header Authorization: Bearer <token>"
            )
        return None

    def _check_origin(self, request: Request) -> None:
        """Refuse changes that another site's page asks the browser for."""
        if request.method in _SAFE_METHODS:
            return
        origin = request.headers.get("origin")
        foreign = origin is not None and _netloc(origin) != request.headers.get("host")
        # Browsers say more in this header, and pages cannot forge it; programs send neither.
        if foreign or request.headers.get("sec-fetch-site", "none") not in ("none", "same-origin"):
            raise AccessError(
                "changes are taken from this server's own pages and from programs, not from "
                "another site",
                code="foreign_origin",
            )


class AddressError(StudioError):
    """An address holds what is no text."""

    code = "invalid_text"
    status = 422


def _plain_address(scope: Scope) -> dict[str, Any]:
    """Path and query, composed (NFC), so that a name is found however its accents were typed.

    Raises
    ------
    AddressError
        If they hold control characters.
    """
    query = scope["query_string"].decode("latin-1")
    try:
        path = text.plain(scope["path"])
        if "%" in query or not query.isascii():
            pairs = parse_qsl(query, keep_blank_values=True)
            query = urlencode([(text.plain(name), text.plain(value)) for name, value in pairs])
    except ValueError as error:
        raise AddressError(f"the address: {error}") from error
    return {"path": path, "query_string": query.encode("latin-1")}


def _netloc(origin: str) -> str | None:
    try:
        return urlsplit(origin).netloc
    except ValueError:
        return None


def _host(request: Request) -> str:
    """The host that was asked for, without its port; empty where none was.

    Raises
    ------
    AccessError
        If it is no host: not a name or an address, with or without a port.
    """
    given = request.headers.get("host", "")
    parts = _HOST.fullmatch(given)
    if given and (parts is None or int(parts["port"] or 0) > 65535):
        raise AccessError("the header Host names no host; use host or host:port", code=_FOREIGN)
    return parts["name"] if parts else ""


def _check_host(name: str, allowed: Iterable[str]) -> None:
    """Refuse names that an attacker's DNS may have bound to this machine."""
    if not (is_loopback(name) or name in allowed):
        raise AccessError(
            "without a token this server answers to localhost and 127.0.0.1 alone; use one of "
            "these in the address, or set PADSTUDIO_ALLOWED_HOSTS",
            code=_FOREIGN,
        )


def _same(given: str, expected: str) -> bool:
    return hmac.compare_digest(given.encode(), expected.encode())


def _bearer(request: Request, token: str) -> bool:
    scheme, _, given = request.headers.get("authorization", "").partition(" ")
    return scheme.lower() == "bearer" and _same(given.strip(), token)


def _gives_token(request: Request) -> bool:
    named = _cookie_name(request) in request.headers.get("cookie", "")
    return named or "token" in request.query_params or "authorization" in request.headers


def _cookie_name(request: Request) -> str:
    # Cookies do not tell ports apart, and two studios may run on one machine.
    return f"padstudio-{request.url.port or request.url.scheme}"


def _cookie_value(token: str) -> str:
    # Other servers on this host see the cookie; the token itself stays between us.
    return hmac.new(token.encode(), b"padstudio cookie", hashlib.sha256).hexdigest()


def _cookie(request: Request, token: str) -> bool:
    try:
        cookie = SimpleCookie(request.headers.get("cookie", "")).get(_cookie_name(request))
    except CookieError:
        return False
    return cookie is not None and _same(cookie.value, _cookie_value(token))


def _enter(request: Request, token: str) -> Response:
    """Set the cookie and go on to the same page, without the token in the address.

    The browser does not send a strict cookie along a redirect that another site began; a page of
    ours that goes on by itself always works.
    """
    rest = [item for item in parse_qsl(request.url.query) if item[0] != "token"]
    # One slash, lest "//host/" take the browser elsewhere; percent signs and quotes are encoded.
    path = "/" + request.url.path.lstrip("/")
    target = request.url.replace(path=path, query=urlencode(rest), scheme="", netloc="")
    response = HTMLResponse(
        '<!doctype html><meta charset="utf-8"><title>Pad Studio</title>'
        f'<meta http-equiv="refresh" content="0;url={html.escape(str(target))}">',
        headers={"Cache-Control": "no-store"},
    )
    response.set_cookie(
        _cookie_name(request),
        _cookie_value(token),
        httponly=True,
        samesite="strict",
        secure=request.url.scheme == "https",
    )
    return response
