"""The Design page: sizes redraw without a new code, and what a camera sees from which height."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import Page, Request, expect

from padstudio.pad.coverage.pinhole import View
from padstudio.pad.coverage.spans import METHOD_LIMITS, cells_needed

SMALL = "/design?rows=20&cols=30&ratio=4&cell_mm=15&quiet_mm=10&name=small"
CAMERA = "preset-dji-mini-27k"
# One fine layer, which the webcam reads only from below where the whole sign is in view.
BANDED = "/design?rows=280&cols=280&ratio=1&window=6&distance=1&camera=preset-webcam-c270"


def _busy(page: Page) -> None:
    expect(page.locator("#viewer [data-ref=canvas]")).to_be_visible()
    expect(page.locator("#viewer [data-ref=busy]")).to_be_hidden()


def _codes(page: Page, pad_id: str) -> dict[str, object]:
    found: dict[str, object] = json.loads(
        page.evaluate("id => fetch(`/api/v1/pads/${id}`).then(a => a.text())", pad_id)
    )
    return found


def _saved_id(page: Page) -> str:
    expect(page).to_have_url(re.compile(r"pad=[0-9a-f-]+"))
    return re.search(r"pad=([0-9a-f-]+)", page.url)[1]  # type: ignore[index]


def test_sizes_margin_and_name_ask_the_server_for_no_code(open_page: Callable[..., Page]) -> None:
    page = open_page(SMALL)
    _busy(page)
    asked: list[str] = []

    def note(request: Request) -> None:
        asked.append(urlsplit(request.url).path)

    page.on("request", note)
    note_of_print = page.locator("#layer-strip [data-ref=note]").first
    expect(note_of_print).to_have_text("450 × 300 mm")
    for label, value, size in (
        ("Red cell side", "20", "600 × 400 mm"),
        ("Quiet margin", "30", "600 × 400 mm"),
        ("Name", "other", "600 × 400 mm"),
    ):
        page.get_by_label(label, exact=True).fill(value)
        expect(note_of_print).to_have_text(size)
        expect(page.locator("#viewer [data-ref=busy]")).to_be_hidden()
    expect(page.locator("#verification")).to_be_visible()
    expect(page).to_have_url(re.compile("cell_mm=20"))
    assert not [path for path in asked if "preview" in path or "bounds" in path]


@pytest.mark.parametrize("seed", ["1", ""])
def test_what_is_shown_is_what_is_saved(open_page: Callable[..., Page], seed: str) -> None:
    page = open_page(SMALL + f"&seed={seed}")
    _busy(page)
    page.get_by_label("Red cell").fill("7.5")
    strip = page.locator("#layer-strip canvas").nth(1)
    expect(page.locator("#layer-strip [data-ref=note]").first).to_have_text("225 × 150 mm")
    shown = strip.evaluate("canvas => canvas.toDataURL()")
    page.get_by_role("button", name="Save pad").click()
    saved = _codes(page, _saved_id(page))
    pad = saved["pad"]
    assert [layer["cell_mm"] for layer in pad["layers"]] == [7.5, 30.0]  # type: ignore[index]
    assert pad["quiet_mm"] == 10  # type: ignore[index]
    assert saved["distance"] == 3
    page.reload()
    _busy(page)
    expect(page.get_by_label("Red cell")).to_have_value("7.5")
    assert strip.evaluate("canvas => canvas.toDataURL()") == shown


def test_a_stored_pad_at_another_size_keeps_its_code(open_page: Callable[..., Page]) -> None:
    page = open_page(SMALL + "&seed=")
    _busy(page)
    page.get_by_role("button", name="Save pad").click()
    first = _saved_id(page)
    page.get_by_label("Red cell").fill("5")
    expect(page.locator("#layer-strip [data-ref=note]").first).to_have_text("150 × 100 mm")
    page.get_by_role("button", name="Save pad").click()
    expect(page).not_to_have_url(re.compile(first))
    second = _saved_id(page)
    codes = [
        [layer["codes"] for layer in _codes(page, each)["pad"]["layers"]]  # type: ignore[index]
        for each in (first, second)
    ]
    assert codes[0] == codes[1]


def test_heights_are_told_for_the_chosen_camera(open_page: Callable[..., Page]) -> None:
    page = open_page(SMALL)
    page.locator("#seen").get_by_label("Camera").select_option(CAMERA)
    # So many cells of 15 mm across 1530 px at f = 1886 px, as docs/simulation.md has it.
    view = View(width_px=2720, height_px=1530, focal_px=1886.0)
    low = cells_needed(5, 2, (20, 30), view, METHOD_LIMITS["dense"]) * 15 / (1530 / 1886.0)
    facts = page.locator("#seen-heights")
    expect(facts).to_contain_text(re.compile(rf"Red layer\s*{low:.1f}"))
    expect(facts).to_contain_text("Blue layer")
    expect(page).to_have_url(re.compile(f"camera={CAMERA}"))


def test_the_chart_tells_cells_in_view_and_pixels_a_cell(open_page: Callable[..., Page]) -> None:
    page = open_page(SMALL + f"&camera={CAMERA}")
    chart = page.locator("#seen [data-ref=chart]")
    expect(chart.locator(".scatterlayer path.js-line")).to_have_count(4)
    chart.hover()
    readout = page.locator("#seen [data-ref=readout]")
    expect(readout).to_contain_text(re.compile(r"red [\d.]+ cells of [\d.]+ px, blue"))
    found = re.search(
        r"^([\d.]+) (m|cm|mm): red ([\d.]+) cells of ([\d.]+) px", readout.inner_text()
    )
    assert found
    height = float(found[1]) * {"m": 1000, "cm": 10, "mm": 1}[found[2]]
    # 15 mm cells at f = 1886 px.
    assert float(found[4]) == pytest.approx(1886 * 15 / height, rel=0.03)


def test_a_dead_band_is_shaded_and_told(open_page: Callable[..., Page]) -> None:
    page = open_page(BANDED)
    _busy(page)
    expect(page.locator("#seen [data-ref=chart] .shapelayer path")).to_have_count(1)
    expect(page.locator("#seen [data-ref=chart]")).to_contain_text("dead band")
    expect(page.locator("#seen-warning")).to_contain_text("no layer reads")
    page.goto(page.url.replace("rows=280", "rows=60").replace("cols=280", "cols=60"))
    _busy(page)
    expect(page.locator("#seen [data-ref=chart] .scatterlayer path.js-line")).to_have_count(2)
    expect(page.locator("#seen [data-ref=chart] .shapelayer path")).to_have_count(0)
    # Leaning, this one has a band as well; from straight above it has none.
    expect(page.locator("#seen-warning")).not_to_contain_text("From 3280")
