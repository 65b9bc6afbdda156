from __future__ import annotations

import base64
import hashlib
import re

import httpx
import pytest

PAGES_WITH_CHARTS = ("/design", "/plan", "/flights/0123456789abcdef")


def _script_url(studio: httpx.Client, path: str) -> str:
    page = studio.get(path).raise_for_status()
    found = re.search(r'data-charts="([^"]+)"', page.text)
    assert found
    return found[1]


@pytest.mark.parametrize("path", PAGES_WITH_CHARTS)
def test_plotly_is_served_by_us_and_kept_for_good(studio: httpx.Client, path: str) -> None:
    url = _script_url(studio, path)
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


def test_only_pages_with_charts_allow_their_style_sheets_and_none_allows_others(
    studio: httpx.Client,
) -> None:
    empty = base64.b64encode(hashlib.sha256(b"").digest()).decode()
    without = ("/", "/flights", "/diagnose")
    for path in (*without, *PAGES_WITH_CHARTS):
        allows = path in PAGES_WITH_CHARTS
        policy = studio.get(path).headers["content-security-policy"]
        assert (f"style-src 'self' 'sha256-{empty}'" in policy) == allows
        assert "script-src 'self';" in policy
        assert "unsafe" not in policy
