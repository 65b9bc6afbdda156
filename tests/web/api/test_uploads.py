"""Uploads over HTTP: the protocol's own words."""

from __future__ import annotations

import asyncio
import base64
import hashlib
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from email.utils import parsedate_to_datetime
from pathlib import Path
from typing import Any

import httpx
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tus_words import BYTES, MP4, TUS, announce, checksum, offset_of, send
from web_server import running, settings_for, wait_until

from padstudio.web.server.turns import Turns

MAX_BYTES = 3_000_000
Refused = Callable[..., dict[str, Any]]


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    values = settings_for(tmp_path_factory.mktemp("data"), max_flight_bytes=MAX_BYTES)
    with running(values) as client:
        yield client


def test_the_server_says_what_it_can(server: httpx.Client) -> None:
    answer = server.request("OPTIONS", "/api/v1/uploads")
    assert answer.status_code == 204
    assert answer.headers["tus-version"] == answer.headers["tus-resumable"] == "1.0.0"
    assert answer.headers["tus-max-size"] == str(MAX_BYTES)
    assert answer.headers["tus-checksum-algorithm"] == "sha1,sha256"
    said = set(answer.headers["tus-extension"].split(","))
    assert said >= {"creation", "creation-with-upload", "checksum", "expiration", "termination"}


def test_an_upload_in_parts(server: httpx.Client) -> None:
    name = base64.b64encode("Wälder/Flug 1.mp4".encode()).decode()
    metadata = f"filename {name},is_confidential"
    address = announce(server, len(MP4), **{"Upload-Metadata": metadata})
    first = send(server, address, 0, MP4[:1000])
    assert (first.status_code, first.headers["upload-offset"]) == (204, "1000")
    assert parsedate_to_datetime(first.headers["upload-expires"])
    assert offset_of(server, address) == 1000
    assert server.head(address, headers=TUS).headers["upload-metadata"] == metadata
    assert server.get(address).json()["complete"] is False
    last = send(server, address, 1000, MP4[1000:])
    assert (last.status_code, last.headers["upload-offset"]) == (204, str(len(MP4)))
    assert "upload-expires" not in last.headers
    upload = server.get(address).json()
    assert (upload["name"], upload["kind"], upload["complete"]) == ("Flug 1.mp4", "video", True)
    assert upload["sha256"] == hashlib.sha256(MP4).hexdigest()
    listed = server.get("/api/v1/uploads", params={"sha256": upload["sha256"]}).json()
    assert upload in listed["items"]
    assert server.delete(address).status_code == 204
    assert server.head(address, headers=TUS).status_code == 404


def test_an_upload_without_a_name_is_called_by_its_content(server: httpx.Client) -> None:
    digest = hashlib.sha256(MP4).hexdigest()
    nameless = {"Upload-Metadata": f"filename {base64.b64encode(b' /').decode()}"}
    for headers in ({}, nameless):
        address = announce(server, **headers)
        assert server.get(address).json()["name"] == ""
        send(server, address, 0, MP4)
        assert server.get(address).json()["name"] == f"video-{digest[:8]}.mp4"
        server.delete(address)


def test_an_unfinished_upload_is_found_by_the_hash_that_was_announced(
    server: httpx.Client,
) -> None:
    digest = hashlib.sha256(b"announced").hexdigest()
    metadata = f"sha256 {base64.b64encode(digest.encode()).decode()}"
    address, _ = announce(server, **{"Upload-Metadata": metadata}), announce(server)

    def found(sha256: str) -> list[str]:
        query = {"announced_sha256": sha256}
        items = server.get("/api/v1/uploads", params=query).json()["items"]
        return [item["id"] for item in items]

    assert found(digest) == [address.rpartition("/")[2]]
    assert found(hashlib.sha256(b"another").hexdigest()) == []
    server.delete(address)
    assert found(digest) == []


def test_the_first_bytes_may_come_along(server: httpx.Client) -> None:
    headers = BYTES | {
        "Upload-Length": str(len(MP4)),
        "Upload-Checksum": checksum(MP4),
    }
    answer = server.post("/api/v1/uploads", headers=headers, content=MP4)
    assert answer.headers["upload-offset"] == str(len(MP4))
    assert answer.json()["complete"] is True


def test_a_checksum_is_compared(server: httpx.Client, refused: Refused) -> None:
    address = announce(server)
    wrong = {"Upload-Checksum": checksum(MP4)}
    refused(
        send(server, address, 0, MP4[:-1] + b"!", **wrong),
        460,
        "checksum_mismatch",
    )
    assert offset_of(server, address) == 0
    right = {"Upload-Checksum": checksum(MP4, "sha256")}
    assert send(server, address, 0, MP4, **right).status_code == 204


def test_methods_in_disguise(server: httpx.Client, refused: Refused) -> None:
    address = announce(server)
    headers = BYTES | {"Upload-Offset": "0"}
    refused(server.post(address, headers=headers, content=MP4), 400, "invalid_tus_header")
    override = {"X-HTTP-Method-Override": "PATCH"}
    assert server.post(address, headers=headers | override, content=MP4).status_code == 204
    assert server.post(address, headers={"X-HTTP-Method-Override": "DELETE"}).status_code == 204
    refused(server.get(address), 404, "not_found")


@pytest.mark.parametrize(
    ("headers", "status", "code"),
    [
        ({"Upload-Length": str(MAX_BYTES + 1)}, 413, "limit_exceeded"),
        ({"Upload-Length": "0"}, 422, "empty_file"),
        ({"Upload-Length": "-1"}, 400, "invalid_tus_header"),
        ({"Upload-Length": "²"}, 400, "invalid_tus_header"),
        ({}, 400, "invalid_tus_header"),
        ({"Upload-Defer-Length": "1"}, 400, "invalid_tus_header"),
        ({"Upload-Length": "9", "Upload-Concat": "partial"}, 400, "invalid_tus_header"),
        ({"Upload-Length": "9", "Upload-Metadata": "a ö"}, 400, "invalid_tus_header"),
        ({"Upload-Length": "9", "Upload-Metadata": "a YQ==,a YQ=="}, 400, "invalid_tus_header"),
        ({"Upload-Length": "9", "Upload-Metadata": "a" * 5000}, 400, "invalid_tus_header"),
        ({"Upload-Length": "9", "Tus-Resumable": "0.2.2"}, 412, "tus_version"),
    ],
)
def test_wrong_announcements(
    server: httpx.Client, refused: Refused, headers: dict[str, str], status: int, code: str
) -> None:
    encoded = [(k.encode(), v.encode("latin-1")) for k, v in (TUS | headers).items()]
    refused(server.post("/api/v1/uploads", headers=encoded), status, code)


@pytest.mark.parametrize(
    ("headers", "status", "code"),
    [
        ({"Upload-Offset": "5"}, 409, "offset_mismatch"),
        ({"Upload-Offset": "x"}, 400, "invalid_tus_header"),
        ({"Content-Type": "text/plain"}, 415, "unsupported_media_type"),
        ({"Upload-Checksum": "crc32 AAAA"}, 400, "unknown_checksum"),
        ({"Upload-Checksum": "sha1 ?"}, 400, "invalid_tus_header"),
        ({"Tus-Resumable": ""}, 412, "tus_version"),
    ],
)
def test_wrong_requests(
    server: httpx.Client, refused: Refused, headers: dict[str, str], status: int, code: str
) -> None:
    address = announce(server)
    answer = server.patch(
        address,
        headers=BYTES | {"Upload-Offset": "0"} | headers,
        content=MP4[:100],
    )
    refused(answer, status, code)
    assert offset_of(server, address) == 0


def test_more_than_announced_is_refused(server: httpx.Client, refused: Refused) -> None:
    address = announce(server, 10)
    refused(send(server, address, 0, MP4), 409, "too_many_bytes")
    assert offset_of(server, address) == 0


@pytest.mark.parametrize("size", [500, 50_000])
def test_a_text_named_mp4_is_refused_and_gone(
    server: httpx.Client, refused: Refused, size: int
) -> None:
    name = base64.b64encode(b"flight.mp4").decode()
    address = announce(server, size, **{"Upload-Metadata": f"filename {name}"})
    error = refused(send(server, address, 0, b"x" * size), 422, "unknown_content")
    assert "MP4" in error["message"]
    refused(server.get(address), 404, "not_found")


def test_bytes_go_nowhere_else_in_such_an_amount(server: httpx.Client, refused: Refused) -> None:
    answer = server.post("/api/v1/pads", headers=BYTES, content=bytes(20_000))
    refused(answer, 413, "limit_exceeded")


@pytest.mark.parametrize("path", ["", "/none", "/none/deeper"])
def test_every_answer_names_the_version(server: httpx.Client, path: str) -> None:
    for method in ("GET", "HEAD", "POST", "PATCH", "DELETE", "OPTIONS"):
        answer = server.request(method, f"/api/v1/uploads{path}")
        assert answer.headers["tus-resumable"] == answer.headers["tus-version"] == "1.0.0"


@settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow], database=None
)
@given(
    headers=st.dictionaries(
        st.sampled_from(
            [
                "Upload-Length",
                "Upload-Offset",
                "Upload-Metadata",
                "Upload-Checksum",
                "X-HTTP-Method-Override",
                "Content-Type",
            ]
        ),
        st.one_of(
            st.integers(-5, 10**20).map(str),
            st.text(st.characters(codec="latin-1", categories=["L", "N", "P", "S"]), max_size=30),
            st.sampled_from(["sha1", "sha256 AAAA", "sha1 é", "filename ////", "PATCH"]),
        ),
        max_size=4,
    ),
    body=st.binary(max_size=40),
)
def test_odd_headers_get_an_answer(
    server: httpx.Client, headers: dict[str, str], body: bytes
) -> None:
    raw = [(k.encode(), v.encode("latin-1")) for k, v in (TUS | headers).items()]
    for method, path in (("POST", ""), ("POST", "/a"), ("PATCH", "/a")):
        answer = server.request(method, f"/api/v1/uploads{path}", headers=raw, content=body)
        assert answer.status_code < 500, answer.text
        if answer.status_code == 201:
            assert server.head(answer.headers["location"], headers=TUS).status_code == 200
            server.delete(answer.headers["location"])


def test_uploads_expire_by_themselves(tmp_path: Path) -> None:
    with running(settings_for(tmp_path, upload_expires_seconds=0.1)) as server:
        address = announce(server)
        send(server, address, 0, MP4[:100])
        partial = tmp_path / "uploads" / "partial" / address.rsplit("/", 1)[-1]
        wait_until(lambda: not partial.exists())
        assert server.get(address).status_code == 404


def test_other_sites_may_not_upload(server: httpx.Client, refused: Refused) -> None:
    headers = TUS | {"Upload-Length": "9", "Origin": "https://evil.example"}
    refused(server.post("/api/v1/uploads", headers=headers), 403, "foreign_origin")


def test_turns_are_taken_one_after_the_other() -> None:
    async def run() -> list[str]:
        turns, said = Turns(), []

        async def work(name: str) -> None:
            async with turns.take("a") as stop:
                said.append(f"{name} begins")
                await stop.wait()
                said.append(f"{name} ends")

        first = asyncio.create_task(work("first"))
        await asyncio.sleep(0)
        second = asyncio.create_task(work("second"))
        await first
        async with turns.take("b"), turns.take("a"):
            await second
        return said

    # In a thread of its own: a browser of other tests may have a loop in this one.
    with ThreadPoolExecutor(1) as thread:
        said = thread.submit(lambda: asyncio.run(run())).result()
    assert said == ["first begins", "first ends", "second begins", "second ends"]
