"""Every operation of the OpenAPI document, with what no client should send.

Each field of each operation's address, query, headers and body takes each hostile value in turn,
while all others are valid. Answers come one after the other on one connection.
"""

from __future__ import annotations

import http.client
import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import fake_analysis
import httpx
import pytest
import served_things
from hostile import FIELD_TEXTS, FIELD_TOKENS
from openapi_requests import Operation, Request, operations
from places import FOOTAGE
from web_server import PAD_FILE, PRESET, running, settings_for

from padstudio.web.app import create_app
from padstudio.web.server.studio import Studio

#: Repeated at the most, of one input.
MOST = 200
MOST_TOLD = 1001
HEADERS: tuple[dict[str, bytes], ...] = (
    {"Origin": b"http://["},
    {"Host": b"["},
    {"Host": b"a:99999"},
    {"Content-Type": b"multipart/form-data"},
    {"Content-Type": b"multipart/form-data; boundary="},
    {"Content-Type": b"text/plain; charset=\xff"},
    {"Content-Encoding": b"gzip"},
    {"Accept": b"\xff" * 300},
    {"Range": b"bytes=" + b"9" * 401 + b"-"},
    {"If-None-Match": b'"' + b"x" * 3000},
    {"Cookie": b"a=\x80; =; ;" * 50},
    {"Tus-Resumable": b"1.0.0", "Upload-Length": b"9" * 401},
    {"Tus-Resumable": b"1.0.0", "Upload-Metadata": b"filename " + b"!" * 300},
    {"X-HTTP-Method-Override": b"TRACE"},
)
BODIES = (
    b"",
    b"\x00",
    b"[" * 3000,
    b"[" * 90_000,
    b'{"a":' * 1000,
    b'"\xff\xfe"',
    b"--x\r\nContent-Disposition: form-data; name=\r\n\r\n",
    b'--x\r\nContent-Disposition: form-data; name="file"; filename="\x00"\r\n\r\na: !!bool "x"\r\n',
)


class Resting(Studio):
    """A studio whose flights stay queued."""

    def start(self) -> None:
        """Nothing is worked."""


@dataclass(frozen=True)
class Server:
    """A server, what exists on it, and one connection to it."""

    client: httpx.Client
    operations: dict[str, Operation]
    connection: http.client.HTTPConnection

    def answer(self, request: Request) -> tuple[int, bytes]:
        """Status and body; the connection is the one of before, unless the answer ends it."""
        before = self.connection.sock
        self.connection.request(request.method, request.target, request.body, request.headers)
        answer = self.connection.getresponse()
        body = answer.read()
        if answer.getheader("Connection") != "close":
            assert self.connection.sock is not None
            assert before in (None, self.connection.sock)
        return answer.status, body


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    small: dict[str, Any] = {"max_cells": 40, "max_simulated_frames": 1, "max_live": 1}
    values = settings_for(
        tmp_path_factory.mktemp("data"), max_simulated_pixels=10_000, max_flights=100_000, **small
    )
    studio = Resting.open(values, fake_analysis.analyze)
    with running(values, studio=studio) as client:
        document = client.get("/api/v1/openapi.json").json()
        address = http.client.HTTPConnection(client.base_url.host, client.base_url.port or 80)
        yield Server(client, operations(document, _known(client)), address)
        address.close()


def _known(client: httpx.Client) -> dict[str, Any]:
    """What a server has, by the names of parameters and fields, and what else is valid there."""
    ids = served_things.keep(client)
    shape = {"layers": [{"channel": "red", "rows": 9, "cols": 9, "cell_mm": 10.0}]}
    return {
        **{name: found for name, found in ids.items() if name in ("pad", "trace", "flight")},
        **{f"{name}_id": found for name, found in ids.items()},
        "camera": PRESET,
        "camera_id": PRESET,
        "other_id": ids["flight"],
        "uploads": [ids["upload"]],
        "image": served_things.PICTURE,
        "vehicle": b"time_s,north_m\n0,0\n",
        "importCamera.file": (FOOTAGE / "camera_drone_half.yaml").read_bytes(),
        "importCamera.camera": "none",
        "importPad.file": PAD_FILE.encode(),
        "openBundle.file": b"PK",
        "Upload-Length": 9,
        "X-HTTP-Method-Override": "PATCH",
        "overrideUploadMethod.Upload-Offset": 0,
        "getPadFile.kind": "pdf",
        "createPad.rows": 12,
        "createPad.cols": 10,
        "createPad.ratio": 2,
        "createPad.window": 3,
        "planSheets.pad": shape,
        "planCoverage.pad": shape,
        "simulateFlight.flight": "landing",
        "startExperiment.flight": "descent",
    }


NAMES = [
    (operation.name, operation.method)
    for operation in operations(create_app(settings_for(Path("unused"))).openapi(), {}).values()
]
#: Their answers do not end.
STREAMS = ("watchFlight", "watchLive")


def _fine(status: int, body: bytes, given: str, method: str) -> None:
    assert status < 500, body
    if status >= 400 and method != "HEAD":
        error = json.loads(body)["error"]
        assert set(error) == {"code", "message", "detail"}
        assert 10 < len(error["message"]) <= MOST_TOLD
        assert len(given) <= MOST or given[: MOST + 1] not in body.decode()


@pytest.mark.parametrize(("name", "method"), NAMES)
def test_no_value_of_any_field_is_a_fault(server: Server, name: str, method: str) -> None:
    operation = server.operations[name]
    if method != "DELETE" and name not in STREAMS:
        _, body = server.answer(operation.request())
        assert b'"code":"invalid_request"' not in body, body
    for place in operation.places:
        for value in FIELD_TOKENS if place.kind == "json" else FIELD_TEXTS:
            if place.kind == "header" and not (value.isascii() and value.isprintable()):
                continue  # is no header at all
            status, answer = server.answer(operation.request(place, value))
            _fine(status, answer, value.strip('"[]'), method)


@pytest.mark.parametrize(("name", "method"), NAMES)
def test_no_headers_and_no_body_are_a_fault(server: Server, name: str, method: str) -> None:
    operation = server.operations[name]
    # What exists is not to be deleted, and streams do not end.
    paths = [place for place in operation.places if place.kind == "path"]
    target = operation.request(*((paths[0], "none") if paths else ())).target
    turn = NAMES.index((name, method))
    # Together the operations have all of them.
    for step in range(4):
        headers = HEADERS[(turn + step) % len(HEADERS)]
        content = BODIES[(turn + step) % len(BODIES)]
        answer = server.client.request(method, target, content=content, headers=headers)
        _fine(answer.status_code, answer.content, "", method)


def test_the_server_is_there_after_all_of_it(server: Server) -> None:
    assert server.client.get("/api/v1/health").json()["status"] == "ok"
