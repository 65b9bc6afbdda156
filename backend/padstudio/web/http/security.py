"""Who may ask, and how much: token, host, origin, body size; and the headers of every answer."""

from __future__ import annotations

import hashlib
import hmac
import html
from collections.abc import Iterable
from http.cookies import CookieError, SimpleCookie
from urllib.parse import parse_qsl, urlencode, urlsplit

from fastapi import Request
from starlette.datastructures import MutableHeaders
from starlette.responses import HTMLResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from padstudio.errors import AccessError
from padstudio.web.http import errors, tus
from padstudio.web.pages.headers import SECURITY_HEADERS
from padstudio.web.server.settings import Settings, is_loopback

_SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})
# Enough to tell a health check that the server is up; it says nothing else.
_OPEN_PATHS = frozenset({"/api/v1/health"})
_TUS_PATH = "/api/v1/uploads"
_BUNDLE_PATH = "/api/v1/bundles/open"


class TokenError(AccessError):
    """The token is missing or wrong."""

    code = "token_required"
    status = 401


class Guard:
    """ASGI middleware that stands before everything else.

    Parameters
    ----------
    app : ASGI application
    settings : Settings
    """

    def __init__(self, app: ASGIApp, settings: Settings) -> None:
        self.app, self.settings = app, settings

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        request = Request(scope)

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                _add_headers(MutableHeaders(scope=message), request.url.path)
            await send(message)

        app: ASGIApp = self.app
        try:
            entry = self._check(request)
        except AccessError as error:
            app = errors.respond_error(request, error)
        else:
            if entry is not None:
                app = entry
        await app(scope, _limited(request, receive, self.settings), send_with_headers)

    def _check(self, request: Request) -> Response | None:
        """Raise `AccessError` where a request may not pass; a response where a token lets in."""
        self._check_origin(request)
        token = self.settings.token
        if token is None:
            _check_host(request, self.settings.allowed_hosts)
            return None
        if request.url.path in _OPEN_PATHS:
            return None
        given = request.query_params.get("token")
        if given is not None and _same(given, token):
            is_page = not request.url.path.startswith((errors.API_PREFIX, "/static/"))
            return _enter(request, token) if is_page and request.method == "GET" else None
        if not (_bearer(request, token) or _cookie(request, token)):
            raise TokenError(
                "this server asks for a token: open the address with ?token=... that it printed "
                "when it started, or send the header Authorization: Bearer <token>"
            )
        return None

    def _check_origin(self, request: Request) -> None:
        """Refuse changes that another site's page asks the browser for."""
        if request.method in _SAFE_METHODS:
            return
        origin = request.headers.get("origin")
        foreign = origin is not None and urlsplit(origin).netloc != request.headers.get("host")
        # Browsers say more in this header, and pages cannot forge it; programs send neither.
        if foreign or request.headers.get("sec-fetch-site", "none") not in ("none", "same-origin"):
            raise AccessError(
                "changes are taken from this server's own pages and from programs, not from "
                "another site",
                code="foreign_origin",
            )


def _check_host(request: Request, allowed: Iterable[str]) -> None:
    """Refuse names that an attacker's DNS may have bound to this machine."""
    try:
        name = urlsplit("//" + request.headers.get("host", "")).hostname or ""
    except ValueError:
        name = ""
    if not (is_loopback(name) or name in allowed):
        raise AccessError(
            "without a token this server answers to localhost and 127.0.0.1 alone; use one of "
            "these in the address, or set PADSTUDIO_ALLOWED_HOSTS",
            code="foreign_host",
        )


def _same(given: str, expected: str) -> bool:
    return hmac.compare_digest(given.encode(), expected.encode())


def _bearer(request: Request, token: str) -> bool:
    scheme, _, given = request.headers.get("authorization", "").partition(" ")
    return scheme.lower() == "bearer" and _same(given.strip(), token)


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


def _add_headers(headers: MutableHeaders, path: str) -> None:
    for name, value in SECURITY_HEADERS.items():
        headers.setdefault(name, value)
    if path.startswith(_TUS_PATH):
        headers.update(tus.EVERYWHERE)


def _limited(request: Request, receive: Receive, settings: Settings) -> Receive:
    """The request's body, counted as it arrives: a declared length need not be there or true."""
    is_upload = request.headers.get("content-type", "").startswith("multipart/form-data")
    stated = settings.max_upload_bytes if is_upload else settings.max_request_bytes
    if is_upload and request.url.path == _BUNDLE_PATH:
        stated = settings.max_bundle_bytes
    if tus.carries_bytes(request.headers) and request.url.path.startswith(_TUS_PATH):
        stated = settings.max_flight_bytes
    # The parts' headers and the form's other fields come on top of the file.
    limit = stated + (settings.max_request_bytes if is_upload else 0)
    # A client that asks before it sends can be told at once.
    asks = request.headers.get("expect", "").lower() == "100-continue"
    declared = request.headers.get("content-length", "")
    refused = asks and declared.isdecimal() and int(declared) > limit
    read = 0

    async def receive_limited() -> Message:
        nonlocal read
        if refused:
            raise errors.BodyTooLargeError(stated)
        message = await receive()
        read += len(message.get("body", b""))
        if read > limit:
            await _discard(message, receive, 4 * limit)
            raise errors.BodyTooLargeError(stated)
        return message

    return receive_limited


async def _discard(message: Message, receive: Receive, at_most: int) -> None:
    """Read on and throw away: a browser shows no answer that comes before it has sent all."""
    discarded = 0
    while message.get("more_body") and discarded < at_most:
        message = await receive()
        discarded += len(message.get("body", b""))
