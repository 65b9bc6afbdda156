"""The Print panel and the verification: sheets, heights, measured size, strip, tables, windows."""

from __future__ import annotations

import io
import json
import re
import zipfile
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest
from browser_support import Complaints
from playwright.sync_api import Page, expect
from strip_photo import strip_photo

SMALL = "/design?rows=30&cols=20&ratio=2&cell_mm=15&quiet_mm=12&name=sheets"


def _facts(page: Page, within: str) -> dict[str, str]:
    terms = page.locator(f"{within} dt").all_inner_texts()
    return dict(zip(terms, page.locator(f"{within} dd").all_inner_texts(), strict=True))


def _plan(page: Page) -> dict[str, str]:
    expect(page.locator("#print-panel")).to_contain_text("One red cell")
    expect(page.locator("#print-panel")).to_contain_text("Sheets")
    return _facts(page, "#print-panel [data-ref=facts]")


def test_sheets_follow_the_form_and_the_address(open_page: Callable[..., Page]) -> None:
    page = open_page(SMALL)
    facts = _plan(page)
    # 324 mm x 474 mm; the cell edges that fit leave two columns of two sheets.
    assert facts["Sheets"] == "4 of paper size A4, portrait"
    assert (facts["One red cell"], facts["One blue cell"]) == ("15 mm", "30 mm")
    expect(page.locator("#sheet-preview .sheet")).to_have_count(4)
    page.get_by_label("Paper size").select_option("A2")
    expect(page.locator("#sheet-preview .sheet")).to_have_count(1)
    page.get_by_label("Joints").select_option("overlap")
    page.get_by_label("Overlap").fill("25")
    expect(page).to_have_url(re.compile(r"paper=A2&joint=overlap&overlap_mm=25"))
    page.reload()
    expect(page.get_by_label("Overlap")).to_have_value("25")
    assert _plan(page)["Sheets"].startswith("1 of paper size A2")


@pytest.mark.parametrize(
    ("label", "value", "says"),
    [("Printer margin", "-3", "from 0 to 1000"), ("Overlap", "0", "from 0.1 to 1000")],
)
def test_lengths_that_cannot_be_are_marked(
    open_page: Callable[..., Page], label: str, value: str, says: str
) -> None:
    page = open_page(SMALL + "&joint=overlap")
    _plan(page)
    page.get_by_label(label).fill(value)
    expect(page.get_by_label(label)).to_have_attribute("aria-invalid", "true")
    expect(page.locator("#print-panel")).to_contain_text(says)
    expect(page.get_by_role("button", name="PDF")).to_be_disabled()


def test_a_sheet_smaller_than_its_margins_is_explained(
    open_page: Callable[..., Page], complaints: Complaints
) -> None:
    complaints.expected = {422}
    page = open_page(SMALL)
    _plan(page)
    page.get_by_label("Printer margin").fill("120")
    fault = page.locator("#print-panel [data-ref=fault]")
    expect(fault).to_contain_text("take smaller margins")
    page.get_by_label("Printer margin").fill("5")
    expect(fault).to_be_empty()
    page.get_by_label("Paper size").select_option("custom")
    page.get_by_label("Width × height, mm").fill("600 × 500")
    expect(page.locator("#sheet-preview .sheet")).to_have_count(1)


def test_the_print_is_what_the_panel_says(open_page: Callable[..., Page], tmp_path: Path) -> None:
    page = open_page(SMALL)
    _plan(page)
    with page.expect_download() as download:
        page.get_by_role("button", name="Download as PDF").click()
    download.value.save_as(tmp_path / "sheets.pdf")
    assert b"/Count 5" in (tmp_path / "sheets.pdf").read_bytes()  # four sheets and their map
    with page.expect_download() as download:
        page.get_by_role("button", name="Download as NPY").click()
    download.value.save_as(tmp_path / "fields.zip")
    fields = zipfile.ZipFile(tmp_path / "fields.zip")
    shapes = {np.load(io.BytesIO(fields.read(name))).shape for name in fields.namelist()}
    assert shapes == {(30, 20), (15, 10)}
    with page.expect_download() as download:
        page.get_by_role("button", name="Download the test strip").click()
    assert download.value.suggested_filename == "sheets-strip.pdf"


def test_a_refused_download_says_why(
    open_page: Callable[..., Page], complaints: Complaints
) -> None:
    complaints.expected = {422}
    page = open_page(SMALL.replace("quiet_mm=12", "quiet_mm=0") + "&header=north")
    _plan(page)
    page.get_by_role("button", name="Download as PDF").click()
    expect(page.locator("#status")).to_contain_text("quiet margin")


def test_a_measured_size_is_stored_with_the_pad(
    open_page: Callable[..., Page], tmp_path: Path
) -> None:
    page = open_page(SMALL)
    _plan(page)
    page.get_by_label("Ruler along x").fill("20")
    page.get_by_role("button", name="Set the measured size").click()
    expect(page.locator("#status")).to_contain_text("from 100 to 400")
    page.get_by_label("Ruler along x").fill("199.2")
    page.get_by_label("Ruler along y").fill("200.4")
    page.get_by_role("button", name="Set the measured size").click()
    expect(page.locator("#status")).to_contain_text("Set the measured size")
    assert _plan(page)["One red cell"] == "14.94 × 15.03 mm"
    expect(page).to_have_url(re.compile(r"\?pad="))
    page.reload()
    expect(page.get_by_label("Ruler along x")).to_have_value("199.2")
    page.get_by_label("Ruler along y").fill("200.9")
    page.reload()
    expect(page.get_by_label("Ruler along y")).to_have_value("200.9")
    expect(page.get_by_label("Ruler along x")).to_have_value("199.2")
    with page.expect_download() as download:
        page.get_by_role("button", name="Download as JSON").click()
    download.value.save_as(tmp_path / "pad.json")
    scale = json.loads((tmp_path / "pad.json").read_text())["scale"]
    assert scale == pytest.approx([0.996, 1.002])


def test_a_photo_of_the_strip_unmixes_the_pads_pictures(
    open_page: Callable[..., Page], tmp_path: Path
) -> None:
    photo = tmp_path / "strip.png"
    photo.write_bytes(strip_photo([[0.55, 0, 0.45], [0, 1, 0], [0.45, 0, 0.55]]))
    page = open_page(SMALL)
    _plan(page)
    panel = page.locator("#print-panel")
    forget = page.get_by_role("button", name="Forget the strip")
    expect(forget).to_be_hidden()
    page.get_by_label("Photo of the test strip").set_input_files(photo)
    expect(panel.locator("[data-ref=strip-note]")).to_contain_text("Kept with the pad")
    expect(panel.locator("[data-ref=strip-warning]")).to_contain_text("Red and blue are too close")
    expect(page).to_have_url(re.compile(r"\?pad="))
    page.reload()
    expect(panel.locator("[data-ref=strip-warning]")).to_contain_text("Red and blue are too close")
    pad = re.search(r"pad=(\w+)", page.url)[1]  # type: ignore[index]
    page.goto(f"/diagnose?pad={pad}")
    expect(page.locator("#pad-choice")).to_contain_text("un-mixed by its test strip")
    page.goto(f"/design?pad={pad}")
    forget.click()
    expect(forget).to_be_hidden()
    expect(page.locator("#status")).to_contain_text("not un-mixed any more")


def test_a_photo_without_a_strip_is_refused(
    open_page: Callable[..., Page], complaints: Complaints, tmp_path: Path
) -> None:
    complaints.expected = {422}
    photo = tmp_path / "photo.png"
    cv2.imwrite(str(photo), np.full((200, 300, 3), 180, np.uint8))
    page = open_page(SMALL)
    _plan(page)
    page.get_by_label("Photo of the test strip").set_input_files(photo)
    expect(page.locator("#status")).to_contain_text("strip")
    expect(page.locator("#status")).to_have_class(re.compile("notice-bad"))


def test_the_weakest_windows_are_shown_in_the_preview(open_page: Callable[..., Page]) -> None:
    page = open_page(SMALL)
    panel = page.locator("#verification")
    expect(panel).to_contain_text("in all rotations")
    expect(panel.locator(".bar-box")).not_to_have_count(0)
    canvas = page.locator("#viewer [data-ref=canvas]")
    before = canvas.evaluate("canvas => canvas.toDataURL()")
    first = panel.locator(".pair").first
    distance = int(re.search(r"(\d+) cells?$", first.inner_text())[1])  # type: ignore[index]
    assert distance >= 3
    first.click()
    expect(first).to_have_attribute("aria-pressed", "true")
    assert canvas.evaluate("canvas => canvas.toDataURL()") != before
    first.click()
    expect(first).to_have_attribute("aria-pressed", "false")
    assert canvas.evaluate("canvas => canvas.toDataURL()") == before


def test_a_table_is_imported_with_the_forms_sizes(
    open_page: Callable[..., Page], tmp_path: Path
) -> None:
    field = np.random.default_rng(3).integers(0, 2, (16, 18))
    table = tmp_path / "my table.csv"
    np.savetxt(table, field, "%d", delimiter=",")
    page = open_page("/design?cell_mm=4&ratio=2")
    page.get_by_label("Import a pad file").set_input_files(table)
    expect(page.locator("#status")).to_have_text("Imported “my table”.")
    expect(page.locator("#pad-facts")).to_contain_text("72 × 64 mm")
    expect(page.locator("#pad-facts")).to_contain_text("9 × 8, 8 mm")
    expect(page.locator("#verification")).to_contain_text("Windows checked")
    expect(page.get_by_label("Columns")).to_have_value("18")


def test_bounds_are_told_and_the_impossible_is_refused_at_once(
    open_page: Callable[..., Page], complaints: Complaints
) -> None:
    complaints.expected = {422}
    page = open_page("/design?rows=20&cols=20&ratio=1&window=4&distance=1")
    sums = page.locator("#spec-form .spec-sums")
    expect(sums).to_contain_text("289 of")
    expect(sums).to_contain_text("130 × 130")
    page.goto("/design?rows=20&cols=20&ratio=1&window=4&distance=9")
    expect(page.locator("#viewer [data-ref=message]")).to_contain_text("at most")
