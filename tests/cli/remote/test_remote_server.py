"""Servers that are none, others, away or guarded, and tokens that nobody sees."""

from __future__ import annotations

import contextlib
import json
import ssl
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import cluster_processes
import pytest
from command_line import assert_one_line_error, run
from places import FOOTAGE, SAMPLES
from web_server import running, settings_for

from padstudio import __version__

TOKEN = "a-token-that-nobody-sees"
ASKED = ("--pad", SAMPLES / "pad.json", "--camera", SAMPLES / "camera.yaml")
STILL = SAMPLES / "height_450mm.jpg"


def remote(url: Any, *arguments: Any) -> Any:
    return run("remote", "--server", url, *ASKED, STILL, *arguments)


@contextlib.contextmanager
def answering(
    status: int, body: str, tls: ssl.SSLContext | None = None, **headers: str
) -> Iterator[tuple[str, list[dict[str, str]]]]:
    """A server that answers everything alike: its address, and the headers that it was sent."""
    asked: list[dict[str, str]] = []

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            asked.append(dict(self.headers.items()))
            self.send_response(status)
            for name, value in headers.items():
                self.send_header(name, value)
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body.encode())

        def log_message(self, *_: object) -> None:
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        if tls is not None:
            server.socket = tls.wrap_socket(server.socket, server_side=True)
        thread = threading.Thread(target=server.serve_forever, args=(0.01,))
        thread.start()
        scheme = "http" if tls is None else "https"
        try:
            yield f"{scheme}://127.0.0.1:{server.server_address[1]}", asked
        finally:
            server.shutdown()
            thread.join()


def test_a_server_that_is_away_is_one_line() -> None:
    result = remote("http://127.0.0.1:9")
    assert_one_line_error(result, "unreachable")
    assert "http://127.0.0.1:9 does not answer" in result.stderr


@pytest.mark.parametrize("body", ["<html>", "[]", '{"status": "ok"}', ""])
def test_something_else_that_answers_is_told(body: str) -> None:
    with answering(200, body) as (url, _):
        assert_one_line_error(remote(url), "no_studio")
    with answering(404, body) as (url, _):
        assert_one_line_error(remote(url), "no_studio")


@pytest.mark.parametrize(
    ("version", "word"), [("0.0.9", "older"), ("99.1.0", "newer"), ("x", "older")]
)
def test_a_server_of_another_release_is_told(version: str, word: str) -> None:
    with answering(200, json.dumps({"status": "ok", "version": version})) as (url, _):
        result = remote(url)
    assert_one_line_error(result, "version_differs")
    assert f"Pad Studio {version}, {word} than this program, {__version__}" in result.stderr


def test_a_token_goes_nowhere_else(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PADSTUDIO_TOKEN", TOKEN)
    with answering(200, "{}") as (other, elsewhere):
        with answering(307, "", Location=f"{other}/api/v1/health") as (url, asked):
            result = remote(url)
        assert asked[0]["Authorization"] == f"Bearer {TOKEN}"
        assert not elsewhere
    assert_one_line_error(result, "redirected")
    assert TOKEN not in result.stderr


def test_the_token_is_read_from_the_environment(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("PADSTUDIO_TOKEN", raising=False)
    monkeypatch.setenv("PADSTUDIO_DEBUG", "1")
    with running(settings_for(tmp_path / "data", token=TOKEN)) as client:
        refused = remote(client.base_url)
        assert_one_line_error(refused, "token_required")
        assert "set PADSTUDIO_TOKEN" in refused.stderr
        monkeypatch.setenv("PADSTUDIO_TOKEN", "wrong-" + TOKEN)
        assert_one_line_error(remote(client.base_url), "token_required")
        monkeypatch.setenv("PADSTUDIO_TOKEN", TOKEN)
        taken = remote(client.base_url)
        assert taken.exit_code == 0, taken.stderr
        assert TOKEN not in refused.stderr + taken.stderr + taken.stdout


@pytest.mark.parametrize(
    "address",
    [
        f"http://127.0.0.1:9/?token={TOKEN}",
        f"http://user:{TOKEN}@127.0.0.1:9",
        f"http://127.0.0.1:9#{TOKEN}",
        "127.0.0.1:9",
        "ftp://127.0.0.1",
        "http://",
        "",
    ],
)
def test_an_address_is_an_address_alone(address: str) -> None:
    result = remote(address)
    assert_one_line_error(result, "invalid_server")
    assert TOKEN not in result.stderr


def test_a_certificate_must_be_trusted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    files = cluster_processes.certificates(tmp_path)
    tls = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    tls.load_cert_chain(files["cert"], files["key"])
    with answering(200, json.dumps({"version": __version__}), tls) as (url, asked):
        result = remote(url)
        assert_one_line_error(result, "certificate")
        # An authority that is trusted makes no name right.
        monkeypatch.setenv("SSL_CERT_FILE", files["ca"])
        assert_one_line_error(remote(url), "certificate")
    assert not asked


def test_a_token_on_an_open_line_is_warned_of(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PADSTUDIO_TOKEN", TOKEN)
    result = remote("http://studio.invalid")
    assert "http://studio.invalid is not encrypted" in result.stderr
    assert "use https" in result.stderr
    assert result.stderr.endswith("(unreachable)\n")
    assert FOOTAGE.name not in result.stderr
