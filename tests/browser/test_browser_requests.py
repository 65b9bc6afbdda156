"""A page costs a handful of requests, and once it was seen none for files that did not change."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import Page

PAGES = ("/design", "/plan", "/diagnose", "/flights", "/cameras", "/live", "flight")
MOST_REQUESTS = 8

# Bytes over the network of each file, the page's own included; none from the browser's cache.
_FILES = """() => ["navigation", "resource"].flatMap(kind => performance.getEntriesByType(kind))
  .map(entry => [new URL(entry.name).pathname, entry.transferSize])
  .filter(([path]) => !path.startsWith("/api/"))"""


@pytest.mark.parametrize("path", PAGES)
def test_first_and_second_view(
    open_page: Callable[..., Page], request: pytest.FixtureRequest, path: str
) -> None:
    address = request.getfixturevalue("flight_path") if path == "flight" else path
    page = open_page(address)
    page.wait_for_load_state("networkidle")
    files = page.evaluate(_FILES)
    assert 4 <= len(files) <= MOST_REQUESTS, files
    page.goto("about:blank")
    page.goto(address)
    page.wait_for_load_state("networkidle")
    sent = [name for name, size in page.evaluate(_FILES) if size]
    assert sent == [address]
