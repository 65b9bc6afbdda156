"""Bundles in the browser: made on Diagnose and of a flight, opened in a second, fresh studio."""

from __future__ import annotations

import json
import re
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

import pytest
from browser_support import STILL, Complaints, set_up_reading
from playwright.sync_api import Browser, Page, expect
from web_server import running, settings_for

LIMITS = {"max_upload_bytes": 3_000_000, "max_image_pixels": 2_000_000, "detect_seconds": 60}
VIEW = ("view", "at", "set", "over", "difference", "cells", "corners", "rest")


@pytest.fixture(scope="module")
def fresh_url(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Another install, without pads, cameras or pictures."""
    with running(settings_for(tmp_path_factory.mktemp("fresh"), **LIMITS)) as client:
        yield str(client.base_url).rstrip("/")


@pytest.fixture
def elsewhere(browser: Browser, fresh_url: str, complaints: Complaints) -> Iterator[Page]:
    """Diagnose in the other install, in another browser profile."""
    context = browser.new_context(
        base_url=fresh_url, viewport={"width": 1280, "height": 1100}, locale="en-GB"
    )
    page = context.new_page()
    page.set_default_timeout(120_000)
    complaints.watch(page, urlsplit(fresh_url).netloc)
    page.goto("/diagnose")
    yield page
    context.close()
    assert complaints.faults == []


def _saved(page: Page, folder: Path) -> Path:
    with page.expect_download(timeout=120_000) as waiting:
        page.get_by_role("button", name="Failure bundle").click()
    path = folder / waiting.value.suggested_filename
    waiting.value.save_as(path)
    expect(page.locator("#status")).to_contain_text("Saved")
    return path


def _opened(page: Page, bundle: Path) -> None:
    page.get_by_label("Choose pictures").set_input_files(bundle)
    expect(page.locator("#status")).to_contain_text("Opened the bundle", timeout=120_000)
    expect(page.locator("#workbench .tile").first).to_be_visible()
    expect(page.locator("#workbench [data-ref=busy]")).to_be_hidden()


def _view(page: Page) -> dict[str, list[str]]:
    found = parse_qs(urlsplit(page.url).query)
    # Parameters are in the order in which they were set.
    ordered = {"set": sorted(found.get("set", [""])[0].split("~"))}
    return {name: found[name] for name in VIEW if name in found} | ordered


def _texts(page: Page, *places: str) -> list[str]:
    return [page.locator(place).inner_text() for place in places]


def test_a_picture_opens_elsewhere_at_the_very_view(
    open_page: Callable[..., Page], elsewhere: Page, tmp_path: Path
) -> None:
    page = open_page("/diagnose", height=1100)
    set_up_reading(page)
    page.get_by_label("Choose pictures").set_input_files(STILL)
    expect(page.locator("#verdict")).to_contain_text("Pose found")
    page.get_by_label("at rest (tripod)").check()
    expect(page.locator("#verdict")).to_contain_text("Pose found")
    page.locator(".params-stage[data-stage=edges] summary").click()
    number = page.locator(".param[data-name='search.least_step'] [data-ref=number]")
    number.fill("0.5")
    number.press("Enter")
    page.get_by_role("button", name="Look at Edges, red").click()
    large = page.locator("#workbench [data-ref=focus]")
    large.hover()
    page.mouse.wheel(0, -500)
    expect(page).to_have_url(re.compile(r"at=\d"))
    page.locator("#workbench [data-ref=opacity]").fill("60")
    page.get_by_role("button", name="Click four corners").click()
    box = large.bounding_box()
    assert box is not None
    for x, y in ((0.2, 0.2), (0.8, 0.2), (0.8, 0.8)):
        large.click(position={"x": x * box["width"], "y": y * box["height"]})
    hint = page.locator("#workbench [data-ref=cells-hint]")
    expect(hint).to_contain_text("3 of 4")
    expect(page).to_have_url(re.compile("corners=([0-9.]+%2C){5}[0-9.]+(&|$)"))
    expect(page.locator("#workbench [data-ref=busy]")).to_be_hidden()
    told = ("#verdict", "[data-ref=pose-facts]", "#workbench [data-ref=zoom]")
    before, view = _texts(page, *told), _view(page)
    facts_before = str(page.locator("[data-ref=pose-facts]").text_content())
    assert set(view) == {"view", "at", "set", "over", "cells", "corners", "rest"}

    _opened(elsewhere, _saved(page, tmp_path))
    panel = elsewhere.locator("#bundle")
    expect(panel.locator("[data-ref=verdict]")).to_have_text(
        "This install gives the very same result."
    )
    expect(elsewhere.locator("#workbench [data-ref=cells-hint]")).to_contain_text("3 of 4")
    expect(elsewhere.locator("#workbench [data-ref=zoom]")).to_have_text(before[2])
    assert _texts(elsewhere, *told) == before
    expect(elsewhere).to_have_url(re.compile("corners="))
    assert _view(elsewhere) == view
    expect(elsewhere.locator("#pad-choice select option:checked")).to_contain_text("open pad A")
    # Under other terms it is read anew, and stays.
    facts = elsewhere.locator("[data-ref=pose-facts]")
    elsewhere.get_by_label("at rest (tripod)").uncheck()
    expect(elsewhere.locator("#frames .item")).to_have_count(1)
    expect(facts).not_to_have_text(facts_before)
    elsewhere.get_by_label("at rest (tripod)").check()
    expect(facts).to_have_text(facts_before)
    expect(elsewhere).to_have_url(re.compile("rest=1"))
    # A reload has it again, the bundle's panel with it.
    elsewhere.reload()
    expect(panel.locator("[data-ref=verdict]")).to_contain_text("very same")
    expect(elsewhere.locator("#workbench [data-ref=cells-hint]")).to_contain_text("3 of 4")
    assert _view(elsewhere) == view


def test_a_frame_of_a_flight_opens_elsewhere_with_what_the_run_said(
    open_page: Callable[..., Page], flight_path: str, elsewhere: Page, tmp_path: Path
) -> None:
    page = open_page(f"{flight_path}?frame=5&view=blue-edges", height=1100)
    expect(page.locator("#verdict")).to_contain_text("Pose found")
    expect(page.locator("#workbench .tile").first).to_be_visible()
    bundle = _saved(page, tmp_path)
    assert "frame 5" in bundle.name
    _opened(elsewhere, bundle)
    panel = elsewhere.locator("#bundle")
    expect(panel.locator("[data-ref=verdict]")).to_contain_text("the very same result")
    rows = panel.locator("[data-ref=results] tr")
    expect(rows).to_have_count(3)
    for row in rows.all():
        then, now, differences = row.locator("td").all_inner_texts()
        assert (then, differences) == (now, "none")
    expect(panel).to_contain_text("the run also knew the frames before it")
    expect(panel.locator("figure")).to_have_count(2)
    for picture in panel.locator("img").all():
        picture.scroll_into_view_if_needed()
        expect(picture).to_have_js_property("complete", value=True)
        assert picture.evaluate("image => image.naturalWidth") > 0
    expect(elsewhere.locator(".bench-name [data-ref=title]")).to_have_text("Edges, blue")
    expect(elsewhere.locator("#verdict")).to_contain_text("Pose found")


def test_what_is_otherwise_is_told_and_odd_zips_are_refused(
    open_page: Callable[..., Page],
    flight_path: str,
    elsewhere: Page,
    complaints: Complaints,
    tmp_path: Path,
) -> None:
    complaints.expected = {413, 422}
    page = open_page(f"{flight_path}?frame=6", height=1100)
    expect(page.locator("#workbench .tile").first).to_be_visible()
    bundle = _saved(page, tmp_path)
    with zipfile.ZipFile(bundle) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    manifest = json.loads(members["bundle.json"])
    manifest["recorded"]["cells_read"] += 1
    manifest["versions"]["numpy"] = "1.0"
    altered, odd = tmp_path / "altered.zip", tmp_path / "odd.zip"
    with zipfile.ZipFile(altered, "w") as archive:
        for name, data in (members | {"bundle.json": json.dumps(manifest).encode()}).items():
            archive.writestr(name, data)
    with zipfile.ZipFile(odd, "w") as archive:
        archive.writestr("../../evil.txt", b"x")
    _opened(elsewhere, altered)
    panel = elsewhere.locator("#bundle")
    expect(panel.locator("[data-ref=verdict]")).to_contain_text("another result")
    expect(panel.locator("[data-ref=versions]")).to_contain_text("numpy 1.0 in the bundle")
    panel.locator("summary").click()
    expect(panel.locator("[data-ref=differences] tr")).to_have_count(1)
    expect(panel.locator("[data-ref=differences] tr")).to_contain_text("cells_read")
    elsewhere.get_by_label("Choose pictures").set_input_files(odd)
    expect(elsewhere.locator("#status")).to_contain_text("evil.txt', which no bundle does")
