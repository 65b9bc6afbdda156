"""The pictures of the documents, taken from the pages as they are (`document_pictures`)."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterator

import httpx
import pytest
from browser_support import STILL, set_up_reading
from camera_page import calibrate_on
from document_pictures import IMAGES, LIVE, SESSION, keep_or_compare
from places import ROOT
from playwright.sync_api import Page, expect

SLOW_MS = 120_000
PAD = "rows=60&cols=60&ratio=5&cell_mm=10&quiet_mm=20&seed=1&name=landing"
ANOTHER_PAD = ROOT / "samples" / "another_pad.jpg"
OVER = ("done", "failed", "cancelled")


@pytest.fixture(scope="module")
def runs(studio_url: str) -> Iterator[tuple[str, str]]:
    """The sample flight, and a run of it by the paper's method."""
    with httpx.Client(base_url=studio_url + "/api/v1", timeout=60) as client:

        def finished(flight: str) -> str:
            end = time.monotonic() + 120
            while client.get(f"/flights/{flight}").json()["state"] not in OVER:
                assert time.monotonic() < end
                time.sleep(0.2)
            return flight

        first = finished(client.post("/samples/flight").raise_for_status().json()["id"])
        again = client.post(f"/flights/{first}/rerun", json={"method": "paper", "stride": 4})
        yield first, finished(again.raise_for_status().json()["id"])


# Every view that is shown has something in it.
_PAINTED = """() => {
  const views = [...document.querySelectorAll("#workbench canvas")]
    .filter(each => each.checkVisibility());
  return views.length > 9 && views.every(canvas => {
    const { width, height } = canvas;
    const pixels = canvas.getContext("2d").getImageData(0, 0, width, height).data;
    return new Set(new Uint32Array(pixels.buffer)).size > 1;
  });
}"""


def _wait_for_bench(page: Page) -> None:
    expect(page.locator("#workbench .stage-row-blue .tile").last).to_be_visible(timeout=SLOW_MS)
    page.locator("#workbench .stage-table").scroll_into_view_if_needed()
    end = time.monotonic() + SLOW_MS / 1000
    while not page.evaluate(_PAINTED):
        assert time.monotonic() < end
        page.wait_for_timeout(100)


def _diagnose(page: Page) -> None:
    set_up_reading(page)
    page.get_by_label("Choose pictures").set_input_files(STILL)
    _wait_for_bench(page)
    page.get_by_role("button", name="Look at Lines, red").click()
    _wait_for_bench(page)


def _flight(page: Page) -> None:
    expect(page.locator("#frame canvas[data-sharp=true]")).to_be_visible(timeout=SLOW_MS)
    _wait_for_bench(page)


def _compared(page: Page) -> None:
    panel = page.locator("#compared")
    expect(panel.locator("[data-ref=strip] .main-svg").first).to_be_attached(timeout=SLOW_MS)
    expect(panel.locator("[data-ref=pair-words]")).to_contain_text("Frame", timeout=SLOW_MS)
    expect(page.locator("#frame canvas[data-sharp=true]")).to_be_visible(timeout=SLOW_MS)


def _design(page: Page) -> None:
    page.get_by_label("Camera").select_option("preset-dji-mini-27k")
    expect(page.locator("#seen .main-svg").first).to_be_attached(timeout=SLOW_MS)
    expect(page.locator("#verification")).to_contain_text("Windows checked", timeout=SLOW_MS)


def _plan(page: Page) -> None:
    page.get_by_label("Camera", exact=True).select_option("preset-dji-mini-27k")
    expect(page.locator("#chart .main-svg").first).to_be_attached(timeout=SLOW_MS)
    expect(page.locator("#advice-facts")).to_contain_text("Red cells", timeout=SLOW_MS)
    page.locator("#frame-take").click()
    expect(page.locator("#film img[data-ref=large]")).to_be_visible(timeout=SLOW_MS)
    page.evaluate("() => scrollTo(0, 0)")


def _print(page: Page) -> None:
    expect(page.locator("#sheet-preview .sheet").first).to_be_attached(timeout=SLOW_MS)
    expect(page.locator("#print-panel")).to_contain_text("Total paper")


def _reasons(page: Page) -> None:
    set_up_reading(page)
    page.get_by_label("Choose pictures").set_input_files(ANOTHER_PAD)
    expect(page.locator("#verdict")).to_contain_text("No pose", timeout=SLOW_MS)
    expect(page.locator("#report [data-ref=failure-list] li").first).to_be_visible()


#: Name: address, with the runs' ids; what is done there; what is taken, empty for what is in view.
# Of `padstudio reproduce`, which docs show as they are.
DRAWN = ("reproduction-sampling", "reproduction-stages")
PICTURES: dict[str, tuple[str, Callable[[Page], None], str]] = {
    "workbench": ("/diagnose", _diagnose, "#workbench"),
    "flight": ("/flights/{0}?frame=20", _flight, ".flight-frame"),
    "compared": ("/flights/{1}?with={0}&frame=40", _compared, "#compared"),
    "design": (f"/design?{PAD}", _design, ""),
    "plan": ("/plan", _plan, "main"),
    "cameras": ("/cameras", calibrate_on, ""),
    "print": (f"/design?{PAD}", _print, "#print-panel"),
    "reasons": ("/diagnose", _reasons, "#report"),
    "home": (
        "/",
        lambda page: expect(page.locator("main")).to_contain_text("sample landing"),
        "",
    ),
}


@pytest.mark.parametrize("name", PICTURES)
def test_pictures_of_the_documents(
    open_page: Callable[..., Page], runs: tuple[str, str], name: str
) -> None:
    address, act, part = PICTURES[name]
    page = open_page(address.format(*runs))
    # It would stand over what is taken.
    page.evaluate("() => { document.querySelector('.site-header').style.position = 'static'; }")
    act(page)
    data = page.locator(part).screenshot() if part else page.screenshot()
    keep_or_compare(name, data)


def test_every_picture_is_taken_here_and_shown() -> None:
    text = "".join(
        path.read_text("utf-8") for path in (ROOT / "README.md", *(ROOT / "docs").glob("*.md"))
    )
    shown = set(re.findall(r"images/([\w-]+)\.webp", text))
    # Experiments draw their own.
    there = {path.stem for path in IMAGES.glob("*.webp")} - {*DRAWN}
    assert shown - {*DRAWN} == {*PICTURES, *SESSION, *LIVE} == there
