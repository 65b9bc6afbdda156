"""The one shape of every error: ``{"error": {"code", "message", "detail"}}``; a page for people."""

from __future__ import annotations

import logging
import re
from collections.abc import Mapping
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from starlette.exceptions import HTTPException
from starlette.responses import Response

from padstudio.errors import MOST_REPEATED, StorageError, StudioError, full_disk, shown
from padstudio.store.database.engine import DatabaseFault, storage_error
from padstudio.web.pages import pages
from padstudio.web.pages.headers import SECURITY_HEADERS

API_PREFIX = "/api/"
logger = logging.getLogger(__name__)

# Longer runs without a blank are somebody's input; so is what is in longer texts.
_LONG_WORD = re.compile(r"(\S{120})\S+")
_MOST_TOLD = 1000
_MOST_FAULTS = 20
_DEEPEST = 6
_HEADERS = {401: {"WWW-Authenticate": "Bearer"}, 503: {"Retry-After": "5"}}
# Python's name differs by its version.
_CODES = {416: "range_not_satisfiable"}
HTTP_MESSAGES = {
    416: "the file has no such part; the header Content-Range says how large it is",
    404: "there is nothing at this address; /api/v1/openapi.json lists what there is",
    405: "this address does not take that method; the Allow header names those it takes",
    400: "the request's body cannot be read; send it as /api/v1/openapi.json describes",
}


class BodyTooLargeError(HTTPException):
    """A body beyond its limit.

    FastAPI lets nothing but its own exceptions through while it reads a body.
    """

    def __init__(self, limit_bytes: int) -> None:
        super().__init__(413)
        self.message = (
            f"the request is larger than {_size(limit_bytes)}, the limit here; send a smaller file"
        )


def install(app: FastAPI) -> None:
    """Give an app the handlers for every error."""
    app.add_exception_handler(StudioError, _studio_error)
    app.add_exception_handler(RequestValidationError, _validation_error)
    app.add_exception_handler(HTTPException, _http_error)
    app.add_exception_handler(OSError, _os_error)
    app.add_exception_handler(DatabaseFault, _database_error)
    app.add_exception_handler(Exception, defect)


def respond(
    request: Request,
    status: int,
    code: str,
    message: str,
    detail: Mapping[str, Any] | None = None,
    headers: Mapping[str, str] | None = None,
) -> Response:
    """An error as JSON; as a page where a browser asked for one."""
    wants_page = "text/html" in request.headers.get("accept", "")
    if wants_page and not request.url.path.startswith(API_PREFIX):
        response = pages.error_page(request, status, HTTPStatus(status).phrase, message)
        response.headers.update(headers or {})
        return response
    body = {"error": _told({"code": code, "message": message, "detail": dict(detail or {})})}
    return JSONResponse(body, status, headers=dict(headers or {}))


def _told(value: Any, depth: int = 0) -> Any:
    """What an answer tells, as UTF-8 can be made of it, and no more of an input than it needs."""
    if isinstance(value, str):
        text = _LONG_WORD.sub(r"\1…", value[: 4 * _MOST_TOLD])
        text = text.encode("utf-8", "replace").decode()
        return text if len(text) <= _MOST_TOLD else text[:_MOST_TOLD] + "…"
    if isinstance(value, Mapping) and depth < _DEEPEST:
        return {_told(str(key)): _told(item, depth + 1) for key, item in value.items()}
    if isinstance(value, list | tuple) and depth < _DEEPEST:
        return [_told(item, depth + 1) for item in value]
    return value if value is None or isinstance(value, bool | int | float) else _told(str(value))


def respond_error(request: Request, error: StudioError) -> Response:
    """A `StudioError` as a response."""
    headers = _HEADERS.get(error.status)
    return respond(request, error.status, error.error_code, error.message, error.detail, headers)


async def _studio_error(request: Request, error: Exception) -> Response:
    assert isinstance(error, StudioError)
    return respond_error(request, error)


async def _validation_error(request: Request, error: Exception) -> Response:
    assert isinstance(error, RequestValidationError)
    faults = [_fault(item) for item in error.errors()[:_MOST_FAULTS]]
    message = "; ".join(fault["message"] for fault in faults[:3])
    return respond(request, 422, "invalid_request", message, {"fields": faults})


async def _http_error(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    if isinstance(error, BodyTooLargeError):
        # The rest of the body is still under way; the connection cannot serve again.
        headers = {"Connection": "close"}
        return respond(request, 413, "limit_exceeded", error.message, headers=headers)
    return respond_http(request, error.status_code, error.headers, str(error.detail))


def respond_http(
    request: Request,
    status: int,
    headers: Mapping[str, str] | None = None,
    message: str = "the request cannot be answered",
) -> Response:
    """An error that HTTP has a status for, and the program no more to say of."""
    code = HTTPStatus(status).name.lower()
    message = HTTP_MESSAGES.get(status, message)
    return respond(request, status, _CODES.get(status, code), message, headers=headers)


async def _os_error(request: Request, error: Exception) -> Response:
    full = full_disk(error)
    return respond_error(request, full) if full else await defect(request, error)


async def _database_error(request: Request, error: Exception) -> Response:
    assert isinstance(error, DatabaseFault)
    logger.error("the database cannot be used", exc_info=error)
    fault = storage_error(error)
    if fault.error_code == StorageError.code:
        return await defect(request, error)
    return respond_error(request, fault)


async def defect(request: Request, error: Exception) -> Response:
    """The answer where the program itself is at fault; logs it."""
    logger.error("a fault of the program", exc_info=error)
    return respond(
        request,
        500,
        "internal_error",
        "the server met a fault of its own and logged it; nothing was stored",
        headers=SECURITY_HEADERS,
    )


# What pydantic's commonest faults mean, in our own words.
_SENTENCES = {
    "less_than_equal": "it must be at most {le}",
    "greater_than_equal": "it must be at least {ge}",
    "greater_than": "it must be above {gt}",
    "less_than": "it must be below {lt}",
    "literal_error": "it must be {expected}",
    "int_parsing": "it must be a whole number",
    "int_from_float": "it must be a whole number",
    "int_type": "it must be a whole number",
    "float_parsing": "it must be a number",
    "float_type": "it must be a number",
    "finite_number": "it must be a number",
    "bool_parsing": "it must be true or false",
    "bool_type": "it must be true or false",
    "string_type": "it must be a text",
    "string_too_long": "it must have at most {max_length} characters",
    "string_too_short": "it must have at least {min_length} characters",
    "string_pattern_mismatch": "it must match {pattern}",
    "model_attributes_type": "send a JSON object, with Content-Type: application/json",
    "dict_type": "it must be an object",
    "extra_forbidden": "there is no such field; check its spelling",
}
_WHOLE = "the request's body"


def _fault(item: Mapping[str, Any]) -> dict[str, str]:
    """A field's place, and a sentence with what was given and what is taken."""
    kind, value = str(item["type"]), item.get("input")
    place = ".".join(_short_place(part) for part in item["loc"][1:]) or _WHOLE
    if kind == "json_invalid":
        return {"place": _WHOLE, "message": f"{_WHOLE} is not JSON"}
    if kind == "missing":
        return {"place": place, "message": f"{place} is missing"}
    if "UploadFile" in str(item["msg"]):
        return {"place": place, "message": f"{place} must be a file"}
    sentence = str(item["msg"]).removeprefix("Value error, ")
    if kind in _SENTENCES:
        sentence = _SENTENCES[kind].format_map(dict(item.get("ctx") or {}))
    given = "cannot be read: "
    if isinstance(value, str | int | float) and place != _WHOLE:
        given = f"is {shown(value)}; "
    return {"place": place, "message": f"{place} {given}{sentence}"}


def _short_place(part: str | int) -> str:
    """A part of a place; a name may be anybody's."""
    name = str(part)
    return name if len(name) <= MOST_REPEATED else name[:MOST_REPEATED] + "…"


def _size(number: int) -> str:
    return f"{number / 1e6:g} MB" if number >= 1_000_000 else f"{number / 1e3:g} kB"
