"""Runs the tests of the page's logic (``logic/*.test.js``) in the browser that will run it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from browser_support import FRONTEND
from playwright.sync_api import Page, Route

LOGIC = Path(__file__).parent / "logic"
FILES = sorted(path.name for path in LOGIC.glob("*.test.js"))

_RUN = """async name => {
  const { tests } = await import(`/tests/${name}`);
  const faults = [];
  for (const [title, run] of Object.entries(tests)) {
    try { await run(); } catch (error) { faults.push(`${title}: ${error.message}`); }
  }
  return [Object.keys(tests).length, faults];
}"""


@pytest.mark.parametrize("name", FILES)
def test_logic(open_page: Callable[..., Page], name: str) -> None:
    # A document of the studio's own without scripts.
    page = open_page("/api/v1/health")

    def serve(route: Route) -> None:
        path = urlsplit(route.request.url).path
        folder = FRONTEND if path.startswith("/static/") else LOGIC
        file = folder / path.split("/", 2)[2]
        route.fulfill(body=file.read_text(encoding="utf-8"), content_type="text/javascript")

    # Modules one by one, which the studio itself serves joined.
    for served in ("**/tests/*.js", "**/static/js/**"):
        page.route(served, serve)
    count, faults = page.evaluate(_RUN, name)
    assert count > 3
    assert faults == []


def test_every_logic_module_is_tested() -> None:
    tested = "".join((LOGIC / name).read_text(encoding="utf-8") for name in FILES)
    modules = {
        path.relative_to(FRONTEND).as_posix() for path in (FRONTEND / "js").rglob("*Logic.js")
    }
    assert {name for name in modules if f"/static/{name}" not in tested} == set()
