"""What axe, a checker of accessibility, says of a page."""

from __future__ import annotations

from importlib import resources

from playwright.sync_api import Page

_AXE = resources.files("axe_playwright_python").joinpath("axe.min.js").read_text("utf-8")
_RUN = """async () => {
  const found = await axe.run(document, { resultTypes: ["violations"] });
  return [found.passes.length, found.violations.flatMap(({ id, nodes }) =>
    nodes.map(({ target, failureSummary }) => `${id}: ${target.join(" ")}: ${failureSummary}`))];
}"""


def checked(page: Page) -> tuple[int, list[str]]:
    """How many rules were met, and a line for each place where one was not."""
    page.evaluate(_AXE)
    passed, found = page.evaluate(_RUN)
    return passed, found
