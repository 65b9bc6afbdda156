from __future__ import annotations

import base64
import hashlib
import re

import httpx


def _script_url(studio: httpx.Client) -> str:
    page = studio.get("/flights/0123456789abcdef").raise_for_status()
    found = re.search(r'data-script="([^"]+)"', page.text)
    assert found
    return found[1]


def test_plotly_is_served_by_us_and_kept_for_good(studio: httpx.Client) -> None:
    url = _script_url(studio)
    packed = studio.get(url)
    plain = studio.get(url, headers={"Accept-Encoding": "identity"})
    assert packed.headers["content-encoding"] == "gzip"
    assert "content-encoding" not in plain.headers
    assert packed.text == plain.text
    assert "plotly.js" in plain.text[:200]
    for answer in (packed, plain):
        assert "immutable" in answer.headers["cache-control"]
        assert answer.headers["content-type"].startswith("text/javascript")
        assert answer.headers["vary"] == "Accept-Encoding"


def test_only_the_page_with_charts_allows_their_style_sheets_and_none_allows_others(
    studio: httpx.Client,
) -> None:
    empty = base64.b64encode(hashlib.sha256(b"").digest()).decode()
    for path, allows in (("/flights", False), ("/flights/0123456789abcdef", True)):
        policy = studio.get(path).headers["content-security-policy"]
        assert (f"style-src 'self' 'sha256-{empty}'" in policy) == allows
        assert "script-src 'self';" in policy
        assert "unsafe" not in policy
