from __future__ import annotations

from html.parser import HTMLParser

import httpx
import pytest

from padstudio.web.pages import static

PAGES = (
    *("/design", "/plan", "/diagnose", "/live", "/experiments"),
    *("/flights", "/flights/0123456789abcdef"),
)


class _Audit(HTMLParser):
    """Collects what a strict policy forbids, and the files that a page asks for."""

    def __init__(self) -> None:
        super().__init__()
        self.forbidden: list[str] = []
        self.files: list[str] = []
        self._in_script = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = dict(attrs)
        self.forbidden += [name for name in values if name.startswith("on") or name == "style"]
        self._in_script = tag == "script"
        if tag == "style":
            self.forbidden.append(tag)
        address = values.get("src") or (values.get("href") if tag == "link" else None)
        if address:
            self.files.append(address)

    def handle_endtag(self, tag: str) -> None:
        self._in_script = False

    def handle_data(self, data: str) -> None:
        if self._in_script and data.strip():
            self.forbidden.append(data)


@pytest.mark.parametrize("path", PAGES)
def test_pages_keep_to_the_policy_and_their_files_are_there(
    studio: httpx.Client, path: str
) -> None:
    page = studio.get(path).raise_for_status()
    assert page.headers["content-type"].startswith("text/html")
    assert page.headers["cache-control"] == "no-cache"
    audit = _Audit()
    audit.feed(page.text)
    assert audit.forbidden == []
    assert audit.files
    for address in audit.files:
        assert address.startswith("/static/")
        studio.get(address).raise_for_status()


def test_the_policy_allows_no_inline_script_and_no_other_host(studio: httpx.Client) -> None:
    headers = studio.get("/design").headers
    policy = headers["content-security-policy"]
    assert "script-src 'self';" in policy
    for word in ("unsafe", "http", "*"):
        assert word not in policy
    for directive in ("default-src 'none'", "frame-ancestors 'none'", "base-uri 'none'"):
        assert directive in policy
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["referrer-policy"] == "same-origin"


def test_the_camera_is_for_the_live_page_alone(studio: httpx.Client) -> None:
    assert "camera=(self)" in studio.get("/live").headers["permissions-policy"]
    for path in ("/", "/diagnose", "/api/v1/pads"):
        policy = studio.get(path).headers["permissions-policy"]
        assert "camera=()" in policy
        assert "microphone=()" in policy


def test_the_root_is_home(studio: httpx.Client) -> None:
    answer = studio.get("/")
    assert answer.status_code == 200
    for kind in ("flights", "pads", "cameras"):
        assert f'id="{kind}"' in answer.text


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("design.js", "text/javascript"),
        ("flight.css", "text/css"),
        ("design.js.map", "application/json"),
        ("icon.svg", "image/svg+xml"),
        ("plotly.min.js", "text/javascript"),
    ],
)
def test_files_are_kept_for_good_under_the_address_of_their_content(
    studio: httpx.Client, name: str, kind: str
) -> None:
    answer = studio.get(static.address(name)).raise_for_status()
    assert answer.headers["content-type"].startswith(kind)
    assert answer.headers["cache-control"] == "public, max-age=31536000, immutable"
    assert answer.headers["content-encoding"] == "gzip"
    plain = studio.get(static.address(name), headers={"Accept-Encoding": "identity"})
    assert plain.content == answer.content
    # A page of before a change finds its file, but asks again.
    older = studio.get(f"/static/{'0' * 16}/{name}").raise_for_status()
    assert older.headers["cache-control"] == "no-cache"


@pytest.mark.parametrize("name", ["none.js", "error.js", "design", "design.html", "base.css", "."])
def test_no_other_files_are_served(studio: httpx.Client, name: str) -> None:
    assert studio.get(f"/static/{'0' * 16}/{name}").status_code == 404


def test_answers_of_the_interface_are_not_kept(studio: httpx.Client) -> None:
    assert studio.get("/api/v1/pads").headers["cache-control"] == "no-store"
