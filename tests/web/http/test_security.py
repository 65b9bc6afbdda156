from __future__ import annotations

import re
import socket
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from web_server import SMALL_SPEC, running, settings_for

from padstudio.errors import StudioError
from padstudio.web.app import create_app
from padstudio.web.http.wrong_tokens import WrongTokens
from padstudio.web.server.settings import is_loopback

TOKEN = "a-token-of-some-length"
PADS = "/api/v1/pads"
Refused = Callable[..., dict[str, Any]]


@pytest.fixture(scope="module")
def guarded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    settings = settings_for(tmp_path_factory.mktemp("data"), token=TOKEN)
    with pytest.MonkeyPatch.context() as patch:
        # Wrong tokens would wait for real.
        patch.setattr("padstudio.web.http.wrong_tokens._STEP_S", 0.0)
        with running(settings) as client:
            yield client


@pytest.fixture(autouse=True)
def _no_cookies(guarded: httpx.Client) -> None:
    guarded.cookies.clear()


# Without a token


@pytest.mark.parametrize("host", ["localhost", "LOCALHOST:8000", "127.0.0.1:1", "[::1]:8000"])
def test_loopback_names_are_answered(studio: httpx.Client, host: str) -> None:
    assert studio.get(PADS, headers={"Host": host}).status_code == 200


@pytest.mark.parametrize(
    "host",
    [
        *("evil.example", "evil.example:8000", "127.0.0.1.evil.example", "10.0.0.1", "[", ""),
        *("me@localhost", "localhost/", "localhost:80:80", "localhost:99999", "[::1", "::1"),
    ],
)
def test_other_names_are_refused(studio: httpx.Client, refused: Refused, host: str) -> None:
    refused(studio.get(PADS, headers={"Host": host}), 403, "foreign_host")
    assert studio.get("/design", headers={"Host": host}).status_code == 403


def test_allowed_hosts_are_answered(tmp_path: Path, refused: Refused) -> None:
    with running(settings_for(tmp_path, allowed_hosts=("pads.example",))) as client:
        assert client.get(PADS, headers={"Host": "pads.example"}).status_code == 200
        refused(client.get(PADS, headers={"Host": "example"}), 403, "foreign_host")


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.168.1.5", "my-server"])
def test_the_network_is_served_with_a_token_only(tmp_path: Path, host: str) -> None:
    with pytest.raises(StudioError, match="PADSTUDIO_TOKEN"):
        create_app(settings_for(tmp_path, host=host))
    create_app(settings_for(tmp_path, host=host, token=TOKEN))


@pytest.mark.parametrize(
    ("host", "answer"),
    [
        ("localhost", True),
        ("127.0.0.2", True),
        ("::1", True),
        ("[::1]", True),
        ("0.0.0.0", False),
        ("localhost.example", False),
        ("", False),
    ],
)
def test_is_loopback(host: str, answer: bool) -> None:
    assert is_loopback(host) is answer


@pytest.mark.parametrize("host", ["a:b", "a:99999", "a b", "@", "[::1"])
def test_a_host_is_a_host_with_a_token_too(
    guarded: httpx.Client, refused: Refused, host: str
) -> None:
    headers = {"Host": host, "Authorization": f"Bearer {TOKEN}"}
    refused(guarded.get(PADS, headers=headers), 403, "foreign_host")


# Addresses are text


@pytest.mark.parametrize(
    "address", ["/api/v1/pads/%00", "/%1b", f"{PADS}?limit=1&x=%00", "/api/v1/advice?camera=%0a"]
)
def test_control_characters_in_addresses(
    studio: httpx.Client, refused: Refused, address: str
) -> None:
    refused(studio.get(address), 422, "invalid_text")


def test_a_name_is_found_however_it_was_typed(studio: httpx.Client) -> None:
    made = studio.post(PADS, json=SMALL_SPEC | {"name": "Cafe\u0301"}).json()
    assert made["name"] == "Caf\u00e9"
    query = {"camera": "preset-webcam-c270"}
    for name in ("Cafe\u0301", "Caf\u00e9"):
        body = {"pad": name, **query, "height_mm": 500}
        assert studio.post("/api/v1/simulate", json=body).status_code != 404


# Changes from other sites


@pytest.mark.parametrize(
    "headers",
    [
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Origin": "http://["},
        {"Origin": "http://127.0.0.1:1"},
        {"Sec-Fetch-Site": "cross-site"},
        {"Sec-Fetch-Site": "same-site"},
    ],
)
def test_changes_asked_for_by_other_sites_are_refused(
    studio: httpx.Client, pad_id: str, refused: Refused, headers: dict[str, str]
) -> None:
    refused(studio.post(PADS, json=SMALL_SPEC, headers=headers), 403, "foreign_origin")
    refused(studio.delete(f"{PADS}/{pad_id}", headers=headers), 403, "foreign_origin")
    assert studio.get(f"{PADS}/{pad_id}", headers=headers).status_code == 200


def test_changes_of_own_pages_and_of_programs_pass(studio: httpx.Client) -> None:
    own = f"http://{studio.base_url.host}:{studio.base_url.port}"
    for headers in ({"Origin": own, "Sec-Fetch-Site": "same-origin"}, {}):
        assert studio.post(PADS, json=SMALL_SPEC, headers=headers).status_code in (200, 201)


def test_no_other_site_may_read(studio: httpx.Client) -> None:
    for method in ("GET", "OPTIONS"):
        headers = {"Origin": "http://evil.example", "Access-Control-Request-Method": "POST"}
        answer = studio.request(method, PADS, headers=headers)
        assert not [name for name in answer.headers if name.startswith("access-control")]
        assert answer.headers["cross-origin-resource-policy"] == "same-origin"


# With a token


def test_nothing_but_health_without_the_token(guarded: httpx.Client, refused: Refused) -> None:
    for path in (PADS, "/static/x/icon.svg", "/design", "/api/v1/openapi.json", "/nothing"):
        refused(guarded.get(path), 401, "token_required")
    page = guarded.get("/design", headers={"Accept": "text/html"})
    assert page.status_code == 401
    assert "?token=" in page.text
    assert TOKEN not in page.text
    assert guarded.get("/api/v1/health").json()["status"] == "ok"


@pytest.mark.parametrize("given", ["x", TOKEN[:-1], TOKEN + "x", "ü"])
def test_wrong_tokens(guarded: httpx.Client, refused: Refused, given: str) -> None:
    refused(guarded.get(PADS, params={"token": given}), 401, "token_required")
    bearer = {"Authorization": f"Bearer {given}".encode()}
    refused(guarded.get(PADS, headers=bearer), 401, "token_required")
    name = f"padstudio-{guarded.base_url.port}"
    cookie = {"Cookie": f"{name}={given}".encode()}
    refused(guarded.get(PADS, headers=cookie), 401, "token_required")


def test_wrong_tokens_alone_are_slowed_down(
    guarded: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    slowed: list[bool] = []

    async def slow_down(_: WrongTokens) -> None:
        slowed.append(True)

    monkeypatch.setattr(WrongTokens, "slow_down", slow_down)
    name = f"padstudio-{guarded.base_url.port}"
    wrong: list[dict[str, Any]] = [
        {"params": {"token": "x" * 20}},
        {"headers": {"Authorization": "Bearer " + "x" * 20}},
        {"headers": {"Cookie": f"{name}=x"}},
    ]
    for options in wrong:
        assert guarded.get(PADS, **options).headers["www-authenticate"].startswith("Bearer")
    assert len(slowed) == len(wrong)
    right = {"Authorization": f"Bearer {TOKEN}", "Cookie": f"{name}=x"}
    assert guarded.get(PADS, headers=right).status_code == 200
    assert guarded.get(PADS).status_code == 401
    page = guarded.get("/design", headers={"Accept": "text/html"})
    assert page.headers["www-authenticate"].startswith("Bearer")
    assert len(slowed) == len(wrong)


def test_programs_send_the_token_along(guarded: httpx.Client) -> None:
    assert guarded.get(PADS, params={"token": TOKEN}).status_code == 200
    for scheme in ("Bearer", "bearer"):
        headers = {"Authorization": f"{scheme} {TOKEN}", "Host": "anything.example"}
        assert guarded.get(PADS, headers=headers).status_code == 200
    assert not guarded.cookies


def test_a_browser_gets_a_cookie_and_a_clean_address(guarded: httpx.Client) -> None:
    answer = guarded.get("/diagnose", params={"trace": "1&2", "token": TOKEN})
    assert answer.status_code == 200
    refresh = re.search(r'content="0;url=([^"]*)"', answer.text)
    assert refresh is not None
    assert refresh[1] == "/diagnose?trace=1%262"
    header = answer.headers["set-cookie"].lower()
    assert "httponly" in header
    assert "samesite=strict" in header
    assert TOKEN not in answer.headers["set-cookie"]
    assert guarded.get("/design").status_code == 200
    assert guarded.post(PADS, json=SMALL_SPEC).status_code == 201


@pytest.mark.parametrize("path", ["//evil.example/", "/%22%3E%3Cscript%3E", "/%5C%5Cevil.example"])
def test_the_way_on_stays_here(guarded: httpx.Client, path: str) -> None:
    request = f"GET {path}?token={TOKEN} HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n"
    answer = _raw(guarded, request.encode())
    refresh = re.search(r'content="0;url=([^"]*)"', answer)
    assert refresh is not None
    assert re.match(r"/[^/\\]", refresh[1])
    assert "<script>" not in answer


# Sizes


def _raw(client: httpx.Client, request: bytes) -> str:
    url = client.base_url
    with socket.create_connection((url.host, url.port or 80), timeout=20) as connection:
        connection.sendall(request)
        parts = []
        while part := connection.recv(65536):
            parts.append(part)
    return b"".join(parts).decode("utf-8", "replace")


def _chunks(total: int) -> Iterator[bytes]:
    head = b'--x\r\nContent-Disposition: form-data; name="image"; filename="a.png"\r\n\r\n'
    yield head
    for _ in range(total // 50_000):
        yield bytes(50_000)
    yield b"\r\n--x--\r\n"


def test_bodies_are_counted_as_they_come(studio: httpx.Client, refused: Refused) -> None:
    headers = {"Content-Type": "multipart/form-data; boundary=x"}
    answer = studio.post("/api/v1/detect", content=_chunks(3_000_000), headers=headers)
    assert "2 MB" in refused(answer, 413, "limit_exceeded")["message"]
    within = studio.post("/api/v1/detect", content=_chunks(1_000_000), headers=headers)
    refused(within, 422, "invalid_request")


def test_bodies_of_no_upload_may_be_small_only(studio: httpx.Client, refused: Refused) -> None:
    answer = studio.post(PADS, json=SMALL_SPEC | {"name": "x" * 20_000})
    assert "10 kB" in refused(answer, 413, "limit_exceeded")["message"]


def test_a_client_that_asks_first_is_told_at_once(studio: httpx.Client) -> None:
    request = (
        b"POST /api/v1/detect HTTP/1.1\r\nHost: localhost\r\nContent-Length: 900000000\r\n"
        b"Content-Type: multipart/form-data; boundary=x\r\nExpect: 100-continue\r\n\r\n"
    )
    assert _raw(studio, request).startswith("HTTP/1.1 413")
