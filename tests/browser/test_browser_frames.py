"""A flight's frames at hand: steps, jumps, play, loops, waits and faults, on a real upload."""

from __future__ import annotations

import re
from collections.abc import Callable

from browser_support import Complaints
from flight_footage import BLANK, FPS, FRAMES
from playwright.sync_api import Page, expect

_DRAWN = """() => {
  const canvas = document.querySelector("#frame canvas");
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let least = 255, most = 0;
  for (let at = 0; at < data.length; at += 4) {
    least = Math.min(least, data[at]);
    most = Math.max(most, data[at]);
  }
  return most - least;
}"""

# Which frame stands, and since when.
_WATCH = """() => {
  window.seen = [];
  const canvas = document.querySelector("#frame canvas");
  const note = () => {
    const { frame } = canvas.dataset;
    if (frame) window.seen.push([Number(frame), performance.now()]);
  };
  new MutationObserver(note).observe(canvas, { attributeFilter: ["data-frame"] });
}"""


def _stands_at(page: Page, number: int) -> None:
    expect(page.locator("#frame canvas")).to_have_attribute("data-frame", str(number))
    expect(page.locator("#report [data-ref=source]")).to_contain_text(f"Frame {number} ·")


def test_steps_take_no_request(open_page: Callable[..., Page], flight_path: str) -> None:
    page = open_page(f"{flight_path}?frame=2")
    _stands_at(page, 2)
    # What the page holds ahead is there, too.
    page.wait_for_load_state("networkidle")
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    for key, frame in (
        ("ArrowRight", 3),
        ("Shift+ArrowRight", 13),
        ("Shift+ArrowRight", 23),
        ("ArrowLeft", 22),
        ("Shift+ArrowLeft", 12),
        ("Shift+ArrowLeft", 2),
    ):
        page.keyboard.press(key)
        _stands_at(page, frame)
        assert page.evaluate(_DRAWN) > 60
    assert [url for url in asked if "/proxies/" in url or "/frames?" in url] == []


def test_the_pad_is_drawn_over_the_frame_or_not(
    open_page: Callable[..., Page], flight_path: str
) -> None:
    page = open_page(f"{flight_path}?frame=2")
    expect(page.locator("#frame canvas")).to_have_attribute("data-sharp", "true")
    look = "() => document.querySelector('#frame canvas').toDataURL()"
    outlined = page.evaluate(look)
    page.get_by_role("checkbox", name="Pad").uncheck()
    expect(page).to_have_url(re.compile("outline=off"))
    assert page.evaluate(look) != outlined
    page.reload()
    expect(page.get_by_role("checkbox", name="Pad")).not_to_be_checked()


def test_a_loop_is_played_at_the_flights_rate(
    open_page: Callable[..., Page], flight_path: str
) -> None:
    page = open_page(f"{flight_path}?frame=10")
    _stands_at(page, 10)
    page.keyboard.press("[")
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowRight")
    page.keyboard.press("]")
    expect(page).to_have_url(re.compile("loop=10-13"))
    expect(page.get_by_role("button", name="Loop 10 – 13")).to_be_visible()
    page.evaluate(_WATCH)
    page.keyboard.press("Space")
    expect(page.get_by_role("button", name="Pause")).to_be_visible()
    page.wait_for_function("() => window.seen.length > 13")
    page.keyboard.press("Space")
    seen = page.evaluate("() => window.seen")
    frames = [frame for frame, _ in seen]
    assert set(frames) == {10, 11, 12, 13}
    took_s = (seen[12][1] - seen[0][1]) / 1000
    # A busy machine plays later, never faster.
    assert took_s > 0.8 * 12 / FPS
    page.get_by_role("button", name="Loop 10 – 13").click()
    expect(page).not_to_have_url(re.compile("loop="))


def test_keys_lead_to_frames(open_page: Callable[..., Page], flight_path: str) -> None:
    page = open_page(flight_path)
    _stands_at(page, 0)
    page.keyboard.press("g")
    page.keyboard.type("9999")
    page.keyboard.press("Enter")
    # The field tells where it leads to: no further than the last frame.
    expect(page.locator("#frame-number")).to_have_value(str(FRAMES - 1))
    page.keyboard.press("ControlOrMeta+a")
    page.keyboard.type("20")
    page.keyboard.press("Enter")
    _stands_at(page, 20)
    page.locator("h1").click()
    page.keyboard.press("p")
    _stands_at(page, max(BLANK))
    page.get_by_role("button", name="10 frames on").click()
    _stands_at(page, FRAMES - 1)


def test_what_fails_offers_another_try(
    open_page: Callable[..., Page], flight_path: str, complaints: Complaints
) -> None:
    complaints.expected = {500}
    page = open_page("/flights")
    body = '{"error": {"code": "x", "message": "the file is gone", "detail": {}}}'
    page.route("**/proxies/*", lambda route: route.fulfill(status=500, body=body))
    page.route("**/api/v1/looks", lambda route: route.fulfill(status=500, body=body))
    page.goto(f"{flight_path}?frame=3")
    fault = page.locator("#frame").get_by_role("alert")
    expect(fault).to_have_text("The file is gone.")
    page.unroute("**/proxies/*")
    page.locator("#frame").get_by_role("button", name="Try again").click()
    _stands_at(page, 3)
    page.route("**/preview.jpg*", lambda route: route.fulfill(status=500, body=body))
    page.keyboard.press("ArrowRight")
    expect(fault).to_have_text("Frame 4: The file is gone.")
    page.unroute("**/preview.jpg*")
    page.locator("#frame").get_by_role("button", name="Try again").click()
    expect(fault).to_be_hidden()
    bench = page.locator("#workbench")
    expect(bench.locator("[data-ref=fault].notice")).to_have_text("The file is gone.")
    page.unroute("**/api/v1/looks")
    bench.get_by_role("button", name="Try again").click()
    expect(bench.locator(".tile[data-view='blue/decode']")).to_be_visible(timeout=120_000)


def test_a_wait_shows_that_work_goes_on_and_how_far(
    open_page: Callable[..., Page], flight_path: str
) -> None:
    page = open_page("/flights")
    head = b'{"frames":[],"complete":false,"making":{"done":3,"total":9}}'
    body = len(head).to_bytes(4, "little") + head
    page.route("**/proxies/*", lambda route: route.fulfill(body=body))
    page.goto(f"{flight_path}?frame=3")
    page.route("**/preview.jpg*", lambda route: None)
    expect(page.locator("#frame").get_by_role("status")).to_contain_text("3 of 9 frames")
    page.unroute("**/proxies/*")
    _stands_at(page, 3)
    page.unroute_all(behavior="ignoreErrors")
