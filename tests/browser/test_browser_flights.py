"""Flights: upload, progress, frames, figures, exports, other runs, as a user does it."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

from browser_support import PAD_FILE, Complaints
from flight_footage import BLANK, FLIGHT_CAMERA, FRAMES
from playwright.sync_api import Page, expect

CHARTS = ("trajectory", "space", "outcomes", "stages", "heights")
# A worker process starts, on a machine that tests keep busy.
SLOW_MS = 120_000
_IS_DRAWN = "image => image.complete && image.naturalWidth > 0"


def _set_up(page: Page) -> None:
    page.get_by_label("Upload a pad file").set_input_files(PAD_FILE)
    expect(page.locator("#status")).to_contain_text("Imported the pad")
    page.get_by_label("Upload a camera file").set_input_files(FLIGHT_CAMERA)
    expect(page.locator("#status")).to_contain_text("Added the camera")


def _at_frame(page: Page, number: int) -> None:
    expect(page.locator("#report [data-ref=source]")).to_contain_text(f"Frame {number} ·")
    expect(page).to_have_url(re.compile(rf"frame={number}\b"))


def test_a_flight_from_its_files_to_its_export(
    open_page: Callable[..., Page], footage: tuple[Path, Path], tmp_path: Path
) -> None:
    page = open_page("/")
    page.get_by_role("link", name="Flights").click()
    expect(page.get_by_role("button", name="Analyse")).to_be_disabled()
    _set_up(page)
    page.get_by_label("Name").fill("evening landing")
    page.get_by_label("Choose files").set_input_files(footage)
    page.get_by_role("button", name=re.compile("Analyse")).click()
    expect(page).to_have_url(re.compile("/flights/[0-9a-f]+"))
    expect(page.get_by_role("heading", level=1)).to_have_text("evening landing")
    expect(page.locator("#head [data-ref=state]")).to_have_text("Done", timeout=SLOW_MS)
    ok = FRAMES - len(BLANK)
    expect(page.locator("#summary")).to_contain_text(f"{ok} of {FRAMES}")
    expect(page.locator("#summary")).to_contain_text("3 frames")
    with page.expect_download() as download:
        page.locator("#downloads").get_by_role("link", name="CSV").click()
    download.value.save_as(tmp_path / "poses.csv")
    rows = (tmp_path / "poses.csv").read_text().splitlines()
    assert sum(not row.startswith("#") for row in rows) >= ok + 1
    page.get_by_role("link", name="Flights", exact=True).first.click()
    listed = page.locator("#flights li", has_text="evening landing")
    expect(listed).to_contain_text("Done")
    expect(listed).to_contain_text("83 % with a pose")


def test_frame_by_frame(open_page: Callable[..., Page], flight_path: str) -> None:
    page = open_page(flight_path)
    _at_frame(page, 0)
    expect(page.locator("#verdict")).to_contain_text("Pose found")
    for key, frame in (("ArrowRight", 1), ("n", 7), ("n", 8), ("ArrowLeft", 7), ("End", 7)):
        page.keyboard.press(key)
        _at_frame(page, frame)
    expect(page.locator("#verdict")).to_contain_text("No pose")
    expect(page.locator("[data-ref=failure-list]")).to_contain_text(re.compile(r"\d"))
    page.keyboard.press("p")
    expect(page.locator("#status")).to_contain_text("No earlier frame")
    track = page.get_by_role("slider", name="Frame")
    track.focus()
    page.keyboard.press("End")
    _at_frame(page, FRAMES - 1)
    page.keyboard.press("p")
    _at_frame(page, 15)
    box = track.bounding_box()
    assert box
    track.click(position={"x": box["width"] * 3.5 / FRAMES, "y": 20})
    _at_frame(page, 3)
    page.get_by_label("Frame", exact=True).last.fill("20")
    page.keyboard.press("Enter")
    _at_frame(page, 20)


def test_every_stage_of_a_frame_and_a_reload(
    open_page: Callable[..., Page], flight_path: str
) -> None:
    page = open_page(f"{flight_path}?frame=2")
    image = page.locator("#report [data-ref=picture]")
    expect(image).to_be_visible()
    assert image.evaluate(_IS_DRAWN)
    opener = page.get_by_role("button", name="Enlarge Edges, blue")
    opener.click(timeout=SLOW_MS)
    dialog = page.get_by_role("dialog")
    expect(dialog.get_by_role("heading")).to_have_text("Edges")
    expect(dialog.get_by_role("radio", name="Blue")).to_be_checked()
    page.keyboard.press("+")
    expect(page).to_have_url(re.compile("frame=2.*stage=edges.*channel=blue.*at="))
    page.reload()
    expect(dialog.get_by_role("heading")).to_have_text("Edges", timeout=SLOW_MS)
    page.keyboard.press("Escape")
    _at_frame(page, 2)
    expect(page.locator("#stages li[data-stage=decode]")).to_be_visible()


def test_an_address_beyond_the_flight_shows_its_last_frame(
    open_page: Callable[..., Page], flight_path: str
) -> None:
    page = open_page(f"{flight_path}?frame=5000")
    _at_frame(page, FRAMES - 1)
    expect(page.locator("#report [data-ref=source]")).to_contain_text(f"Frame {FRAMES - 1}")


def test_the_figures_show_what_was_flown(open_page: Callable[..., Page], flight_path: str) -> None:
    page = open_page(flight_path)
    page.locator("#charts").scroll_into_view_if_needed()
    for name in CHARTS:
        expect(page.locator(f"[data-ref={name}] .main-svg").first).to_be_attached(timeout=SLOW_MS)
    expect(page.locator("[data-ref=space-note]")).to_contain_text("missing: no pose")
    expect(page.locator("[data-ref=heights-note]")).to_contain_text("Slope 1.08")
    drawn = page.locator("[data-ref=trajectory]").evaluate("chart => chart.data[0].y")
    assert [frame for frame, height in enumerate(drawn) if height is None] == sorted(BLANK)
    heights = [height for height in drawn if height is not None]
    assert heights == sorted(heights, reverse=True)
    assert page.locator("[data-ref=space] canvas").count() > 0
    page.get_by_role("radio", name="Dark").check(force=True)
    font = "chart => chart.layout.font.color"
    ink = page.locator("#charts p").first.evaluate("() => getComputedStyle(document.body).color")
    assert page.locator("[data-ref=trajectory]").evaluate(font) != ink
    expect(page.locator("[data-ref=space] .main-svg").first).to_be_attached()


def test_frames_are_read_before_the_charts_have_loaded(
    open_page: Callable[..., Page], flight_path: str
) -> None:
    page = open_page("/flights")
    page.route("**/plotly.min.js", lambda route: None)
    page.goto(f"{flight_path}?frame=12")
    _at_frame(page, 12)
    page.get_by_role("slider", name="Frame").focus()
    page.keyboard.press("ArrowRight")
    _at_frame(page, 13)
    page.get_by_role("slider", name="Frame").click(position={"x": 1, "y": 20})
    _at_frame(page, 0)
    assert page.evaluate("() => typeof Plotly") == "undefined"
    page.unroute_all(behavior="ignoreErrors")


def test_the_timeline_shows_heights_and_outcomes(
    open_page: Callable[..., Page], flight_path: str
) -> None:
    page = open_page(f"{flight_path}?frame=12")
    timeline = page.locator("#timeline .plot")
    expect(timeline.locator(".heatmaplayer image")).to_be_attached(timeout=SLOW_MS)
    strip, heights = timeline.evaluate("chart => chart.data")
    failed = [frame for frame, outcome in enumerate(strip["z"][-1]) if outcome == 4]
    assert failed == sorted(BLANK)
    assert max(z for z in heights["y"] if z is not None) > 0


def test_the_timeline_zooms_and_keeps_its_part(
    open_page: Callable[..., Page], flight_path: str
) -> None:
    page = open_page(f"{flight_path}?frame=12")
    _at_frame(page, 12)
    page.get_by_role("slider", name="Frame").focus()
    page.keyboard.press("+")
    expect(page).to_have_url(re.compile(r"part=\d+-\d+"))
    page.reload()
    page.get_by_role("button", name="Whole flight").click()
    expect(page).not_to_have_url(re.compile("part="))
    page.get_by_role("button", name="Play").click()
    played = re.compile(r"Frame (1[4-9]|2\d) ·")
    expect(page.locator("#report [data-ref=source]")).to_contain_text(played)
    expect(page.get_by_role("button", name="Play")).to_be_visible(timeout=SLOW_MS)
    _at_frame(page, FRAMES - 1)


def test_another_run_beside_the_first(open_page: Callable[..., Page], flight_path: str) -> None:
    page = open_page(flight_path)
    page.get_by_role("button", name="Run again").click()
    dialog = page.get_by_role("dialog")
    dialog.get_by_label("Detector parameters").fill("[1]")
    dialog.get_by_role("button", name="Run", exact=True).click()
    expect(dialog).to_contain_text("JSON object")
    dialog.get_by_label("Detector parameters").fill("")
    dialog.get_by_label("Last frame").fill("11")
    dialog.get_by_label("Every n-th").fill("2")
    dialog.get_by_role("button", name="Run", exact=True).click()
    expect(page).to_have_url(re.compile(r"with="))
    assert flight_path not in page.url
    expect(page.locator("#head [data-ref=state]")).to_have_text("Done", timeout=SLOW_MS)
    expect(page.locator("#settings")).to_contain_text("0 to 11, every 2nd")
    runs = page.locator("#runs li")
    expect(runs.first).to_contain_text("Frames: all / 0 to 11, every 2nd")
    page.keyboard.press("ArrowRight")
    _at_frame(page, 2)
    page.get_by_role("button", name="Compare with").first.click()
    expect(page).not_to_have_url(re.compile("with="))


# Runs of a flight that keep the workers busy for some seconds.
_BEFORE = 20


def test_a_flight_is_stopped_and_taken_up_again(
    open_page: Callable[..., Page], flight_path: str
) -> None:
    page = open_page(flight_path)
    # Others wait before it, so that it cannot be done before it is stopped.
    flights = page.url.split("/flights/")[0] + "/api/v1/flights"
    begin = f"{flights}/{flight_path.split('/')[-1]}/rerun"
    others = [page.request.post(begin, data={}).json()["id"] for _ in range(_BEFORE)]
    page.get_by_role("button", name="Run again").click()
    page.get_by_role("dialog").get_by_role("button", name="Run", exact=True).click()
    expect(page).to_have_url(re.compile(r"with="))
    page.get_by_role("button", name="Cancel").click()
    state = page.locator("#head [data-ref=state]")
    expect(state).to_have_text("Cancelled")
    for other in others:
        page.request.post(f"{flights}/{other}/cancel")
        assert page.request.delete(f"{flights}/{other}").ok
    page.get_by_role("button", name="Try again").click()
    expect(state).to_have_text("Done", timeout=SLOW_MS)
    expect(page.locator("#summary")).to_contain_text(f"{FRAMES - len(BLANK)} of {FRAMES}")


def test_a_flight_that_is_not_there(open_page: Callable[..., Page], complaints: Complaints) -> None:
    complaints.expected = {404}
    page = open_page("/flights/0123456789abcdef")
    expect(page.locator("#status")).to_contain_text("no flight of that id")
    expect(page.locator("#charts")).to_be_hidden()
    expect(page.locator("#downloads")).to_be_hidden()


def test_progress_is_asked_for_where_events_do_not_come(
    open_page: Callable[..., Page], complaints: Complaints, flight_path: str
) -> None:
    complaints.expected = {503}
    page = open_page(flight_path)
    page.context.route("**/events", lambda route: route.fulfill(status=503))
    page.get_by_role("button", name="Run again").click()
    page.get_by_role("dialog").get_by_label("Last frame").fill("3")
    page.get_by_role("dialog").get_by_role("button", name="Run", exact=True).click()
    expect(page).to_have_url(re.compile(r"with="))
    expect(page.locator("#head [data-ref=state]")).to_have_text("Done", timeout=SLOW_MS)
    expect(page.locator("#summary")).to_contain_text("4 of 4")


def test_the_table_of_frames_is_narrowed_and_leads_to_frames(
    open_page: Callable[..., Page], flight_path: str
) -> None:
    page = open_page(flight_path)
    table = page.locator("#frames")
    table.get_by_role("heading", name="Frames").click()
    rows = table.locator("tbody tr")
    expect(rows).to_have_count(FRAMES)
    table.get_by_label("Outcome").select_option("failed")
    expect(rows).to_have_count(len(BLANK))
    expect(page).to_have_url(re.compile("frames=status%3Dfailed"))
    table.get_by_role("button", name="8", exact=True).press("Enter")
    _at_frame(page, 8)
    page.keyboard.press("ArrowDown")
    _at_frame(page, 9)
    expect(table.locator("tr[data-current=true]")).to_have_text(re.compile(r"^\s*9\b"))
    page.reload()
    expect(rows).to_have_count(len(BLANK))
    expect(table.get_by_label("Outcome")).to_have_value("failed")
    table.get_by_label("Time from, s").fill("1.0")
    expect(rows).to_have_count(sum(number >= 10 for number in BLANK))
    table.get_by_label("Time to, s").fill("0.5")
    expect(table.get_by_role("alert")).to_contain_text("must be after")
    table.get_by_role("button", name="All frames").click()
    expect(rows).to_have_count(FRAMES)
    expect(table.get_by_role("button", name="Later")).to_be_disabled()
