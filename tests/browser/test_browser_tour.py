"""The whole tour as a new user walks it: design, look, print, upload, read."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from browser_support import CAMERA_FILE, FOOTAGE, PAD_FILE, STILL, set_up_reading
from playwright.sync_api import Page, expect

CHANNEL_STAGES = ("channel", "block_mean", "clean", "edges", "lines", "grid", "decode")


def _truth_mm(still: Path) -> list[float]:
    entries = json.loads((FOOTAGE / "stills" / "truth.json").read_text())
    return next(entry["position_mm"] for entry in entries if entry["file"].endswith(still.name))


def _facts(page: Page, ref: str) -> dict[str, str]:
    terms = page.locator(f"[data-ref={ref}] dt").all_inner_texts()
    return dict(zip(terms, page.locator(f"[data-ref={ref}] dd").all_inner_texts(), strict=True))


@pytest.mark.parametrize(("width", "theme"), [(1280, "light"), (390, "dark")])
def test_tour(open_page: Callable[..., Page], tmp_path: Path, width: int, theme: str) -> None:
    page = open_page("/", width=width, theme=theme)
    page.get_by_role("link", name="Design", exact=True).click()
    expect(page).to_have_url(re.compile("/design$"))
    _design_and_download(page, tmp_path)
    page.get_by_role("link", name="Diagnose").click()
    _read_a_frame(page)
    _look_at_every_stage(page)


def _design_and_download(page: Page, folder: Path) -> None:
    page.get_by_label("Name").fill("tour pad")
    page.get_by_label("Rows", exact=True).fill("40")
    page.get_by_label("Columns").fill("30")
    facts = page.locator("#pad-facts")
    expect(facts).to_contain_text("300 × 400 mm")
    expect(page.locator("#verification")).to_contain_text("in all rotations")
    expect(page.locator("#viewer canvas").first).to_be_visible()
    with page.expect_download() as download:
        page.get_by_role("button", name="PDF").click()
    assert re.fullmatch(r"tour.pad.*\.pdf", download.value.suggested_filename)
    download.value.save_as(folder / "pad.pdf")
    assert (folder / "pad.pdf").read_bytes().startswith(b"%PDF-")
    expect(page.locator("#pad-list")).to_contain_text("tour pad")


def _read_a_frame(page: Page) -> None:
    expect(page.get_by_label("Pad", exact=True)).to_contain_text("tour pad")
    page.get_by_label("Upload a pad file").set_input_files(PAD_FILE)
    expect(page.locator("#status")).to_contain_text("open pad A")
    page.get_by_label("Upload a camera file").set_input_files(CAMERA_FILE)
    expect(page.locator("#camera-choice-note")).to_contain_text("943.0 px")
    page.get_by_label("Choose pictures").set_input_files(STILL)
    expect(page.locator("#verdict")).to_contain_text("Pose found")
    facts = _facts(page, "pose-facts")
    position = [float(facts[axis].split()[0].replace("−", "-")) for axis in "XYZ"]
    assert math.dist(position, _truth_mm(STILL)) < 20
    expect(page.locator("[data-ref=words]")).to_contain_text("above the pad")


def _look_at_every_stage(page: Page) -> None:
    for stage in CHANNEL_STAGES:
        for channel in ("red", "blue"):
            tile = page.locator(f".tile[data-view='{channel}/{stage}']")
            tile.scroll_into_view_if_needed()
            expect(tile.locator("canvas")).to_be_visible()
    for stage in ("stretch", "denoise", "choose", "pose"):
        expect(page.locator(f".tile[data-view='/{stage}']")).to_have_count(1)
    expect(page.locator("#workbench [data-ref=busy]")).to_be_hidden()


def test_the_sample_is_read_at_one_click(open_page: Callable[..., Page]) -> None:
    page = open_page("/diagnose")
    page.get_by_role("button", name="Try with the sample").click()
    expect(page.locator("#frames [data-ref=tally]")).to_have_text(
        "4 with a pose, 1 without", timeout=60_000
    )
    page.get_by_role("button", name="another_pad.jpg").first.click()
    expect(page.locator("#verdict")).to_contain_text("No pose")
    expect(page.locator("[data-ref=failure-list]")).to_contain_text(re.compile(r"\d"))


def test_a_reload_brings_the_result_and_the_view_back(open_page: Callable[..., Page]) -> None:
    page = open_page("/diagnose")
    set_up_reading(page)
    page.get_by_label("Choose pictures").set_input_files(STILL)
    page.get_by_role("button", name="Look at Lines, blue").click()
    title, zoom = (page.locator(f".bench-bar [data-ref={name}]") for name in ("title", "zoom"))
    expect(title).to_have_text("Lines, blue")
    page.locator("#workbench [data-ref=focus]").focus()
    page.keyboard.press("+")
    expect(page).to_have_url(re.compile("trace=.*view=blue-lines.*at="))
    shown = zoom.inner_text()
    page.reload()
    expect(title).to_have_text("Lines, blue")
    expect(zoom).to_have_text(shown)
    expect(page.locator("#verdict")).to_contain_text("Pose found")
    expect(page.get_by_label("Camera", exact=True).locator("option:checked")).to_contain_text(
        "drone_half"
    )
