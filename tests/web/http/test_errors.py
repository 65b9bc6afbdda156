from __future__ import annotations

import asyncio
import errno
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import httpx
import pytest
from sqlalchemy.exc import IntegrityError, OperationalError
from sqlalchemy.exc import TimeoutError as PoolTimeoutError
from web_server import running, settings_for

from padstudio.errors import BusyError, StudioError
from padstudio.web.app import create_app

Refused = Callable[..., dict[str, Any]]


def test_unknown_addresses(studio: httpx.Client, refused: Refused) -> None:
    for path in ("/api/v1/none", "/api/v2/pads", "/none", "/static/none.js", "/static/../x"):
        refused(studio.get(path), 404, "not_found")


@pytest.mark.parametrize(
    ("path", "method", "taken"),
    [
        ("/api/v1/pads", "PUT", "GET, OPTIONS, POST"),
        ("/api/v1/pads/none", "POST", "DELETE, GET, OPTIONS, PATCH"),
        # Not taken for a pad of that name.
        ("/api/v1/pads/import", "GET", "OPTIONS, POST"),
        ("/api/v1/uploads/none", "PUT", "DELETE, GET, HEAD, OPTIONS, PATCH, POST"),
        ("/design", "POST", "GET, OPTIONS"),
        ("/static/x/none.js", "POST", "GET, OPTIONS"),
    ],
)
def test_methods_that_are_not_taken(
    studio: httpx.Client, refused: Refused, path: str, method: str, taken: str
) -> None:
    answer = studio.request(method, path)
    refused(answer, 405, "method_not_allowed")
    assert answer.headers["allow"] == taken
    answer = studio.options(path)
    assert (answer.status_code, answer.headers["allow"]) == (204, taken)


@pytest.mark.parametrize(
    ("content", "kind", "says"),
    [
        (b"{", "application/json", "is not JSON"),
        (b"[1]", "application/json", "send a JSON object"),
        (b"{}", "text/plain", "send a JSON object"),
        (b"\xff", "application/json", "cannot be read"),
        (b"9" * 5000, "application/json", "cannot be read"),
    ],
)
def test_bodies_that_are_no_json(
    studio: httpx.Client, content: bytes, kind: str, says: str
) -> None:
    answer = studio.post("/api/v1/pads", content=content, headers={"Content-Type": kind})
    assert answer.status_code in (400, 422)
    assert says in answer.json()["error"]["message"]


def test_broken_forms(studio: httpx.Client, refused: Refused) -> None:
    headers = {"Content-Type": "multipart/form-data"}
    refused(studio.post("/api/v1/detect", content=b"x", headers=headers), 400, "bad_request")


def test_every_fault_is_named(studio: httpx.Client, refused: Refused) -> None:
    answer = studio.post("/api/v1/pads", json={"window": 99, "name": "x" * 300, "seed": "x"})
    fields = refused(answer, 422, "invalid_request")["detail"]["fields"]
    assert {field["place"] for field in fields} == {"window", "name", "seed"}
    assert all(len(field["message"]) < 200 for field in fields)


@pytest.mark.parametrize(
    ("address", "headers", "wanted"),
    [
        ("/api/v1/flights/a.b", {}, "^[A-Za-z0-9-]{1,64}$"),
        ("/api/v1/uploads?sha256=x", {}, "^[0-9a-f]{64}$"),
        ("/api/v1/flights", {"Idempotency-Key": "short"}, "^[A-Za-z0-9_-]{16,64}$"),
    ],
)
def test_what_a_text_must_be_like_is_told(
    studio: httpx.Client, refused: Refused, address: str, headers: dict[str, str], wanted: str
) -> None:
    method = "POST" if headers else "GET"
    error = refused(studio.request(method, address, headers=headers), 422, "invalid_request")
    assert f"it must match {wanted}" in error["message"]


def test_people_get_a_page(studio: httpx.Client) -> None:
    answer = studio.get("/<script>alert(1)</script>", headers={"Accept": "text/html"})
    assert answer.status_code == 404
    assert answer.headers["content-type"].startswith("text/html")
    assert "alert(1)" not in answer.text
    assert studio.get("/api/v1/x", headers={"Accept": "text/html"}).json()["error"]


def database_fault(says: str) -> OperationalError:
    fault = OperationalError("UPDATE", {}, Exception(says))
    fault.__cause__ = fault.orig
    return fault


@pytest.mark.parametrize(
    ("error", "status", "code"),
    [
        (OSError(errno.ENOSPC, "full"), 507, "disk_full"),
        (database_fault("database or disk is full"), 507, "disk_full"),
        (database_fault("database is locked"), 503, "database_busy"),
        (PoolTimeoutError("every connection is in use"), 503, "database_busy"),
        (IntegrityError("INSERT secret", {}, Exception("secret")), 500, "internal_error"),
        (OSError(errno.EIO, "broken"), 500, "internal_error"),
        (ValueError("a secret"), 500, "internal_error"),
        (BusyError("come back later, please"), 503, "busy"),
        (StudioError("something is wrong here", code="own"), 400, "own"),
    ],
)
def test_errors_of_the_program(
    tmp_path: Path, refused: Refused, error: Exception, status: int, code: str
) -> None:
    app = create_app(settings_for(tmp_path))

    @app.get("/api/v1/fails")
    async def fails() -> None:
        raise error

    async def ask() -> httpx.Response:
        transport = httpx.ASGITransport(app, raise_app_exceptions=False)
        async with httpx.AsyncClient(transport=transport, base_url="http://localhost") as client:
            return await client.get("/api/v1/fails")

    # Browser tests leave a running loop in this process's main thread.
    with ThreadPoolExecutor(1) as thread:
        answer = thread.submit(lambda: asyncio.run(ask())).result()
    refused(answer, status, code)
    assert "secret" not in answer.text
    assert answer.headers["x-content-type-options"] == "nosniff"


def test_a_connection_goes_on_after_a_fault(tmp_path: Path) -> None:
    app_fault = "/api/v1/fails"
    with running(settings_for(tmp_path), faults={app_fault: ValueError("a secret")}) as client:
        places = set()
        for path in (app_fault, "/api/v1/health", app_fault, "/api/v1/health"):
            with client.stream("GET", path) as answer:
                answer.read()
                places.add(answer.extensions["network_stream"].get_extra_info("client_addr"))
                assert answer.status_code == (500 if path == app_fault else 200)
        assert len(places) == 1


@pytest.mark.parametrize("given", ["bytes=999999999-", "bytes=9-1", "lines=1-2"])
def test_parts_of_files_that_are_not_there(studio: httpx.Client, given: str) -> None:
    answer = studio.get("/api/v1/samples/pad.json", headers={"Range": given})
    assert answer.status_code in (400, 416)
    assert set(answer.json()["error"]) == {"code", "message", "detail"}
    assert studio.get("/api/v1/samples/pad.json", headers={"Range": "bytes=0-0"}).text == "{"


def test_what_was_given_is_repeated_in_short(studio: httpx.Client) -> None:
    for given in ("x" * 5000, "x y " * 1200, ["x"] * 2000):
        for body in ({"name": given}, {"seed": given}, {str(given): 1}):
            said = studio.post("/api/v1/pads", json=body).text
            assert said.count("x") < 250, said
