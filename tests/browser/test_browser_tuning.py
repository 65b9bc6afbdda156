"""The workbench on real pictures: every sentence of docs/tuning.md, walked in the browser."""

from __future__ import annotations

import re
from collections.abc import Callable

import cv2
import pytest
from browser_support import NEGATIVE, STILL, Complaints, set_up_reading
from flight_footage import BLANK
from playwright.sync_api import Locator, Page, expect

# Parameters under which a frame has no pose.
LOSES = "search.least_edges%3A90000~outline.largest_px%3A32"


@pytest.fixture
def bench(open_page: Callable[..., Page]) -> Page:
    """Diagnose with a picture on the workbench, its stages there."""
    page = open_page("/diagnose", height=1100)
    set_up_reading(page)
    page.get_by_label("Choose pictures").set_input_files(STILL)
    expect(page.locator("#verdict")).to_contain_text("Pose found")
    page.locator("#workbench").scroll_into_view_if_needed()
    _wait_for_views(page)
    return page


def _wait_for_views(page: Page) -> None:
    expect(page.locator("#workbench [data-ref=busy]")).to_be_hidden()
    expect(page.locator("#workbench .tile").first).to_be_visible()


def _row(page: Page, name: str) -> Locator:
    return page.locator(f".param[data-name='{name}']")


def _open_stage(page: Page, stage: str) -> None:
    group = page.locator(f".params-stage[data-stage={stage}]")
    if group.get_attribute("open") is None:
        group.locator("summary").click()


def _set(page: Page, name: str, value: str) -> None:
    number = _row(page, name).locator("[data-ref=number]")
    number.fill(value)
    number.press("Enter")


def test_red_stands_above_blue_and_a_click_makes_a_view_the_large_one(bench: Page) -> None:
    red, blue = (bench.locator(f".stage-row-{name}").bounding_box() for name in ("red", "blue"))
    assert red is not None
    assert blue is not None
    assert red["y"] + red["height"] <= blue["y"] + 1
    bench.get_by_role("button", name="Look at Lines, blue").click()
    expect(bench.locator(".bench-name [data-ref=title]")).to_have_text("Lines, blue")
    expect(bench).to_have_url(re.compile("view=blue-lines"))


def test_a_parameter_beside_its_stage_changes_the_pose_and_is_marked(bench: Page) -> None:
    _open_stage(bench, "edges")
    row = _row(bench, "search.least_step")
    expect(row).to_contain_text("grey/px")
    expect(row).to_contain_text("brightness changes by more than this")
    slider = row.locator("[data-ref=slider]")
    slider.focus()
    for _ in range(12):
        slider.press("ArrowRight")
    expect(row.locator("[data-ref=changed]")).to_be_visible()
    expect(bench.locator("#workbench [data-ref=changed-count]")).to_have_text("1 changed")
    expect(bench).to_have_url(re.compile(r"set=search.least_step"))
    _open_stage(bench, "outline")
    _set(bench, "search.least_edges", "90000")
    _set(bench, "outline.largest_px", "32")
    expect(bench.locator("#verdict")).to_contain_text("No pose")
    _set(bench, "search.least_edges", "7")
    expect(_row(bench, "search.least_edges").locator("[data-ref=fault]")).to_contain_text("From 16")
    name = bench.locator("#workbench [data-ref=preset-name]")
    name.fill("half a na")
    bench.reload()
    expect(name).to_have_value("half a na")
    expect(bench.locator("#workbench [data-ref=changed-count]")).to_have_text(
        re.compile("[23] changed")
    )
    bench.get_by_role("button", name="Reset all").click()
    expect(bench.locator("#verdict")).to_contain_text("Pose found")
    expect(bench.locator("#workbench [data-ref=changed-count]")).to_have_text("all as usual")


def test_presets_the_link_and_the_command_line(bench: Page) -> None:
    bench.context.grant_permissions(["clipboard-read", "clipboard-write"])
    _open_stage(bench, "edges")
    _set(bench, "search.least_step", "0.4")
    bench.get_by_role("button", name="Copy command line").click()
    expect(bench.locator("#status")).to_contain_text("command line")
    command = bench.evaluate("navigator.clipboard.readText()")
    assert re.fullmatch(
        r"padstudio detect --pad '?[^']*\.json'? --camera \S+ --param search\.least_step=0\.4 "
        r"a_cast0_1300\.jpg -o poses\.jsonl",
        command,
    )
    bench.get_by_label("Keep these as").fill("faint print")
    bench.get_by_role("button", name="Keep", exact=True).click()
    expect(bench.locator("#preset")).to_contain_text("faint print")
    bench.get_by_role("button", name="Reset all").click()
    expect(bench.locator("#workbench [data-ref=changed-count]")).to_have_text("all as usual")
    bench.locator("#preset").select_option("faint print")
    expect(_row(bench, "search.least_step").locator("[data-ref=number]")).to_have_value("0.4")
    bench.once("dialog", lambda dialog: dialog.accept())
    bench.get_by_role("button", name="Remove the preset").click()
    expect(bench.locator("#status")).to_contain_text("Removed")
    bench.locator("#workbench").get_by_role("button", name="Copy link").click()
    expect(bench.locator("#status")).to_contain_text("Copied the link")
    assert "set=search.least_step" in bench.evaluate("navigator.clipboard.readText()")


def test_views_are_linked_and_tell_the_value_under_the_cursor(bench: Page) -> None:
    large = bench.locator("#workbench [data-ref=focus]")
    bench.locator("#workbench .stage-table").scroll_into_view_if_needed()
    _wait_for_views(bench)
    large.scroll_into_view_if_needed()
    large.hover()
    expect(bench.locator("#workbench [data-ref=readout]")).to_contain_text(
        re.compile(r"x \d+ px, y \d+ px")
    )
    tile = bench.locator(".tile", has=bench.get_by_role("button", name="Look at Channel, red"))
    expect(tile.locator("[data-ref=value]")).to_have_text(re.compile(r"\d+"))
    bench.mouse.wheel(0, -600)
    expect(bench).to_have_url(re.compile(r"at=\d"))
    shown = bench.locator("#workbench [data-ref=zoom]").inner_text()
    bench.reload()
    expect(bench.locator("#workbench [data-ref=zoom]")).to_have_text(shown)
    large.dblclick()
    expect(bench).not_to_have_url(re.compile(r"at=\d"))


def test_opacity_and_difference_against_the_original(bench: Page) -> None:
    bench.locator("#workbench [data-ref=opacity]").fill("40")
    expect(bench).to_have_url(re.compile("over=40"))
    bench.get_by_label("Difference").check()
    expect(bench).to_have_url(re.compile("difference=1"))
    _wait_for_views(bench)


def test_lines_say_what_they_are(bench: Page) -> None:
    bench.get_by_role("button", name="Look at Lines, blue").click()
    expect(bench.locator(".bench-name [data-ref=title]")).to_have_text("Lines, blue")
    _wait_for_views(bench)
    large = bench.locator("#workbench [data-ref=focus]")
    large.scroll_into_view_if_needed()
    box = large.bounding_box()
    assert box is not None
    tip = bench.locator("#workbench [data-ref=tip]")
    for step in range(200):
        x = box["x"] + box["width"] * (0.35 + 0.3 * step / 200)
        bench.mouse.move(x, box["y"] + box["height"] * 0.5)
        bench.wait_for_timeout(20)
        if tip.is_visible():
            break
    expect(tip).to_contain_text(re.compile("line"))


def test_expected_against_read_with_the_frames_pose(bench: Page) -> None:
    bench.get_by_role("button", name="With the frame's pose").click()
    verdicts = bench.locator("[data-ref=cells-verdicts]")
    expect(verdicts).to_contain_text(re.compile(r"[\d.]+ % of .* red cells agree"))
    expect(verdicts).to_contain_text("blue cells agree")
    bench.locator("[data-ref=cells-layers]").get_by_role("radio", name="Blue").check()
    expect(bench.locator("[data-ref=cells-rest], [data-ref=cells-rows] tr").first).to_be_visible()
    large = bench.locator("#workbench [data-ref=focus]")
    large.hover()
    expect(bench.locator("#workbench [data-ref=tip]")).to_contain_text(
        re.compile(
            r"blue cell, row \d+, column \d+: expected level \d, read \d; "
            r"grey [\d.]+ of 255, threshold"
        )
    )
    bench.get_by_role("button", name="Close").click()
    expect(verdicts).to_be_hidden()


def test_expected_against_read_with_four_clicks_where_there_is_no_pose(
    open_page: Callable[..., Page],
) -> None:
    page = open_page("/diagnose", height=1100)
    set_up_reading(page)
    page.get_by_label("Choose pictures").set_input_files(NEGATIVE)
    expect(page.locator("#verdict")).to_contain_text("No pose")
    _wait_for_views(page)
    expect(page.get_by_role("button", name="With the frame's pose")).to_be_disabled()
    page.get_by_role("button", name="Click four corners").click()
    hint = page.locator("[data-ref=cells-hint]")
    expect(hint).to_contain_text("0 of 4")
    large = page.locator("#workbench [data-ref=focus]")
    large.scroll_into_view_if_needed()
    box = large.bounding_box()
    assert box is not None
    for dx, dy in ((-0.2, -0.3), (0.2, -0.3), (0.2, 0.3), (-0.2, 0.3)):
        page.mouse.click(
            box["x"] + box["width"] * (0.5 + dx), box["y"] + box["height"] * (0.5 + dy)
        )
    expect(hint).to_have_text("")
    expect(page.locator("[data-ref=cells-verdicts]")).to_contain_text("cells agree")
    expect(page.locator("[data-ref=cells-rows] tr").first).to_be_visible()


def _walk_by_keys(page: Page) -> None:
    """Tab to a small view, enlarge it, move and zoom, and come back to it."""
    large = page.locator("#workbench [data-ref=focus]")
    zoom = page.locator("#workbench [data-ref=zoom]")
    title = page.locator(".bench-name [data-ref=title]")
    tile = page.locator("#workbench .tile[data-view='blue/edges'] .tile-view")
    page.get_by_role("button", name="Look at Channel, blue").focus()
    for _ in range(20):
        page.keyboard.press("Tab")
        if tile.evaluate("tile => tile === document.activeElement"):
            break
    expect(tile).to_be_focused()
    page.keyboard.press("Enter")
    expect(title).to_have_text("Edges, blue")
    expect(large).to_be_focused()
    fitted = zoom.inner_text()
    page.keyboard.press("+")
    expect(zoom).not_to_have_text(fitted)
    expect(page).to_have_url(re.compile("at="))
    before = page.url
    page.keyboard.press("ArrowRight")
    expect(page).not_to_have_url(before)
    assert "frame=" not in before or before.split("&")[0] == page.url.split("&")[0]
    page.keyboard.press("-")
    expect(zoom).to_have_text(fitted)
    page.keyboard.press("Escape")
    expect(tile).to_be_focused()
    page.keyboard.press("Tab")
    expect(page.get_by_role("button", name="Look at Edges, blue")).to_be_focused()
    page.keyboard.press("Enter")
    expect(large).to_be_focused()
    page.keyboard.press("Escape")
    expect(page.get_by_role("button", name="Look at Edges, blue")).to_be_focused()


def test_small_views_are_enlarged_by_keys(bench: Page) -> None:
    _walk_by_keys(bench)


def test_small_views_of_a_flights_frame_are_enlarged_by_keys(
    open_page: Callable[..., Page], flight_path: str
) -> None:
    page = open_page(f"{flight_path}?frame=2")
    _wait_for_views(page)
    _walk_by_keys(page)
    expect(page.locator("#frame canvas")).to_have_attribute("data-frame", "2")


def test_expected_against_read_in_a_frame_of_a_flight_that_has_no_pose(
    open_page: Callable[..., Page], flight_path: str
) -> None:
    page = open_page(f"{flight_path}?frame={min(BLANK)}", height=1100)
    _wait_for_views(page)
    neighbour = page.get_by_role("button", name="With the nearest frame's pose")
    neighbour.click()
    # A blank picture has nothing to read, wherever the pad is.
    expect(page.locator("[data-ref=cells-fault]")).to_contain_text("the picture is flat there")
    page.goto(f"{flight_path}?frame=2&set={LOSES}")
    expect(page.locator("#verdict")).to_contain_text("No pose")
    expect(page.get_by_role("button", name="With the frame's pose")).to_be_disabled()
    verdicts = page.locator("[data-ref=cells-verdicts]")
    neighbour.click()
    # The camera has moved by some small cells, and by little of a large one.
    expect(page.locator("[data-ref=cells-hint]")).to_contain_text("The pose of frame 1")
    expect(verdicts).to_contain_text(re.compile(r"9\d[\d.]* % of \d+ blue cells agree\."))
    page.get_by_role("button", name="Click four corners").click()
    expect(verdicts).to_be_hidden()
    large = page.locator("#workbench [data-ref=focus]")
    large.scroll_into_view_if_needed()
    box = large.bounding_box()
    assert box is not None
    for dx, dy in ((-0.2, -0.3), (0.2, -0.3), (0.2, 0.3), (-0.2, 0.3)):
        page.mouse.click(
            box["x"] + box["width"] * (0.5 + dx), box["y"] + box["height"] * (0.5 + dy)
        )
    expect(page.locator("[data-ref=cells-hint]")).to_have_text("")
    expect(verdicts).to_contain_text("cells agree")


def test_a_turned_picture_is_turned_back_and_read(
    open_page: Callable[..., Page], complaints: Complaints
) -> None:
    complaints.expected = {422}
    page = open_page("/diagnose")
    set_up_reading(page)
    picture = cv2.rotate(cv2.imread(str(STILL)), cv2.ROTATE_90_CLOCKWISE)
    content = cv2.imencode(".png", picture)[1].tobytes()
    page.get_by_label("Choose pictures").set_input_files(
        {"name": "portrait.png", "mimeType": "image/png", "buffer": content}
    )
    report = page.locator("#report")
    expect(report.get_by_role("alert")).to_contain_text("turned by a quarter")
    report.get_by_role("button", name="Turn left and read").click()
    expect(page.locator("#verdict")).to_contain_text("Pose found")
    expect(report.locator("[data-ref=source]")).to_contain_text("portrait-turned.png")
    expect(report.get_by_role("button", name="Turn left and read")).to_be_hidden()
