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
from web_server import settings_for

from padstudio.errors import BusyError, StudioError
from padstudio.web.app import create_app

Refused = Callable[..., dict[str, Any]]


def test_unknown_addresses(studio: httpx.Client, refused: Refused) -> None:
    for path in ("/api/v1/none", "/api/v2/pads", "/none", "/static/none.js", "/static/../x"):
        refused(studio.get(path), 404, "not_found")


def test_methods_that_are_not_taken(studio: httpx.Client, refused: Refused) -> None:
    answer = studio.put("/api/v1/pads", json={})
    refused(answer, 405, "method_not_allowed")
    assert answer.headers["allow"] in ("GET", "POST")
    refused(studio.post("/design"), 405, "method_not_allowed")


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
