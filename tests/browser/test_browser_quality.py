"""What the pages show of poses whose range and bearing alone can be used."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from browser_support import STILL, set_up_reading
from playwright.sync_api import Page, Route, expect

# Frames of the flight that the server is made to tell so of; the others stay as they are.
BEARING = frozenset(range(7))
FAR = {
    "quality": "bearing",
    "range_sigma_mm": 12.0,
    "bearing_sigma_deg": 0.01,
    "position_sigma_mm": [160.0, 120.0, 8.0],
    "attitude_sigma_deg": [6.0, 8.0, 0.1],
}


def _told(body: Any, frames: frozenset[int]) -> Any:
    """An answer of the server with its poses of some frames made uncertain, wherever they stand."""
    if isinstance(body, list):
        return [_told(item, frames) for item in body]
    if not isinstance(body, dict):
        return body
    body = {key: _told(value, frames) for key, value in body.items()}
    is_pose = "axis" in body or body.get("status") == "ok"
    if is_pose and body["frame"] in frames:
        return body | FAR
    if "qualities" in body:
        body["qualities"] = {"full": body["ok"] - len(frames), "bearing": len(frames), "unknown": 0}
    if "trajectory" in body:
        trajectory = body["trajectory"]
        trajectory["quality"] = ["bearing" if n in frames else "full" for n in trajectory["frame"]]
    if "outcomes" in body and body["first_frame"] == body["last_frame"] in frames:
        body["outcomes"] = [0, 0, 0, 0, 0, 1]
    return body


@contextmanager
def _tell(page: Page, frames: frozenset[int]) -> Iterator[None]:
    def answer(route: Route) -> None:
        response = route.fetch()
        if "json" in response.headers.get("content-type", ""):
            route.fulfill(response=response, body=json.dumps(_told(response.json(), frames)))
        else:
            route.fulfill(response=response)

    # Kept answers, and those that the workbench asks for.
    for name in ("detect/*", "looks"):
        page.route(f"**/api/v1/{name}", answer)
    for name in ("summary", "timeline*", "figures*", "frames*", "frames/*", "frames/*/stages*"):
        page.route(f"**/api/v1/flights/*/{name}", answer)
    yield
    page.unroute_all(behavior="ignoreErrors")


def test_a_picture_that_shows_range_and_bearing_alone(open_page: Callable[..., Page]) -> None:
    page = open_page("/diagnose")
    set_up_reading(page)
    page.get_by_label("Choose pictures").set_input_files(STILL)
    expect(page).to_have_url(re.compile("trace="))
    # The answer that is kept comes again, and tells of a pad that is far away.
    with _tell(page, frozenset({0})):
        page.reload()
        report = page.locator("#report")
        expect(report.locator("[data-ref=quality]")).to_have_text("bearing only")
        expect(page.locator("#verdict")).to_contain_text("Range and direction found")
        words = report.locator("[data-ref=words] p")
        expect(words.first).to_contain_text("± 12.0 mm away")
        expect(words.last).to_contain_text("too uncertain to use")
        expect(report.locator("[data-ref=range-facts]")).to_contain_text("± 12.0 mm")
        # The pose is there for who asks, greyed, with the reason.
        pose = report.locator("[data-ref=pose]")
        expect(pose).to_contain_text("one standard deviation is 10.0° of attitude")
        assert float(pose.locator("dl").evaluate("list => getComputedStyle(list).opacity")) < 0.7
        expect(page.locator("#frames [data-ref=tally]")).to_have_text(
            "1 with range and bearing only"
        )


def test_a_full_pose_has_no_badge(open_page: Callable[..., Page]) -> None:
    page = open_page("/diagnose")
    set_up_reading(page)
    page.get_by_label("Choose pictures").set_input_files(STILL)
    expect(page.locator("#verdict")).to_contain_text("Pose found")
    expect(page.locator("#report [data-ref=range-facts]")).to_contain_text("mm")
    expect(page.locator("#report [data-ref=quality]")).to_be_hidden()
    expect(page.locator("#report [data-ref=doubt]")).to_be_hidden()


def test_a_flight_tells_its_frames_apart(open_page: Callable[..., Page], flight_path: str) -> None:
    page = open_page("/flights")
    with _tell(page, BEARING):
        page.goto(flight_path)
        expect(page.locator("#report [data-ref=quality]")).to_have_text("bearing only")
        summary = page.locator("#summary")
        expect(summary).to_contain_text("Range and bearing only")
        expect(summary.locator("dd").nth(2)).to_have_text(str(len(BEARING)))
        page.locator("#timeline [data-ref=track]").hover(position={"x": 20, "y": 60})
        expect(page.locator("#timeline [data-ref=hint]")).to_contain_text("range and bearing only")
        page.locator("#frames summary").click()
        row = page.locator("#frames tbody tr").first
        expect(row).to_have_attribute("data-kind", "bearing")
        expect(row).to_contain_text("bearing only")
        page.locator("#charts").scroll_into_view_if_needed()
        note = page.locator("#charts [data-ref=trajectory-note]")
        expect(note).to_contain_text(f"{len(BEARING)} frames show range and bearing only")


def test_the_table_is_narrowed_by_quality(open_page: Callable[..., Page], flight_path: str) -> None:
    page = open_page(flight_path)
    page.locator("#frames summary").click()
    expect(page.locator("#frames tbody tr").first).to_be_visible()
    with page.expect_request("**/frames?*quality=bearing*"):
        page.get_by_label("Pose", exact=True).select_option("bearing")
    expect(page.locator("#frames [data-ref=empty]")).to_be_visible()
