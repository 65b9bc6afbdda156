"""The Design page: live preview, zoom, layers, saved pads, its state in the address."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

from browser_support import PAD_FILE, choose
from playwright.sync_api import Page, expect

SMALL = "/design?rows=20&cols=30&ratio=4&cell_mm=5&quiet_mm=10&name=small"
# Mean red, green and blue of a canvas's middle ninth.
_MEAN_COLOUR = """canvas => {
  const { width, height } = canvas;
  const copy = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
  copy.drawImage(canvas, 0, 0);
  const { data } = copy.getImageData(width / 3, height / 3, width / 3, height / 3);
  const sums = [0, 0, 0];
  for (let i = 0; i < data.length; i += 4) for (let c = 0; c < 3; c += 1) sums[c] += data[i + c];
  return sums.map(sum => Math.round((4 * sum) / data.length));
}"""


def _drawn(page: Page) -> list[int]:
    expect(page.locator("#viewer [data-ref=canvas]")).to_be_visible()
    colour: list[int] = page.locator("#viewer [data-ref=canvas]").evaluate(_MEAN_COLOUR)
    return colour


def test_preview_shows_the_print_and_each_layer(open_page: Callable[..., Page]) -> None:
    page = open_page(SMALL)
    # Grey lines between the cells lend every channel a little.
    assert [value > 60 for value in _drawn(page)] == [True, False, True]
    choose(page, re.compile("Red layer"))
    assert [value > 60 for value in _drawn(page)] == [True, False, False]
    choose(page, re.compile("Blue layer"))
    assert [value > 60 for value in _drawn(page)] == [False, False, True]
    expect(page).to_have_url(re.compile("view=blue"))


def test_a_new_seed_changes_the_pad_and_the_old_one_brings_it_back(
    open_page: Callable[..., Page],
) -> None:
    page = open_page(SMALL)
    canvas = page.locator("#layer-strip canvas").nth(1)
    picture = "canvas => canvas.toDataURL()"
    _drawn(page)
    first = canvas.evaluate(picture)
    for seed, same in (("2", False), ("1", True)):
        with page.expect_response("**/pads/preview") as answer:
            page.get_by_label("Seed").fill(seed)
        assert answer.value.ok
        expect(page.locator("#viewer [data-ref=busy]")).to_be_hidden()
        assert (canvas.evaluate(picture) == first) is same


def test_the_keyboard_zooms_to_a_single_cell_and_reads_it(
    open_page: Callable[..., Page],
) -> None:
    page = open_page(SMALL + "&view=red")
    _drawn(page)
    page.get_by_role("button", name="One cell").click()
    canvas = page.locator("#viewer [data-ref=canvas]")
    canvas.focus()
    readout = page.locator("#viewer [data-ref=readout]")
    expect(readout).to_contain_text(re.compile(r"red row 10, column 15: level [01]"))
    colour = canvas.evaluate(_MEAN_COLOUR)
    level = int(re.search(r"level (\d)", readout.inner_text())[1])  # type: ignore[index]
    assert (colour[0] > 128) is (level == 1)
    page.keyboard.press("0")
    expect(page.locator("#viewer [data-ref=zoom]")).to_have_text("100 %")


def test_wheel_and_drag_move_the_view_and_a_reload_keeps_it(
    open_page: Callable[..., Page],
) -> None:
    page = open_page(SMALL)
    _drawn(page)
    box = page.locator("#viewer [data-ref=canvas]").bounding_box()
    assert box
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.wheel(0, -600)
    zoom = page.locator("#viewer [data-ref=zoom]")
    expect(zoom).not_to_have_text("100 %")
    page.mouse.down()
    page.mouse.move(x + 40, y + 10)
    page.mouse.up()
    expect(page).to_have_url(re.compile(r"at=[\d.]+%2C[\d.]+%2C[\d.]+"))
    text = zoom.inner_text()
    page.reload()
    expect(zoom).to_have_text(text)


def test_a_saved_pad_opens_again_and_can_be_deleted(open_page: Callable[..., Page]) -> None:
    page = open_page(SMALL.replace("small", "keep me"))
    _drawn(page)
    page.get_by_role("button", name="Save pad").click()
    expect(page.locator("#status")).to_have_text("Saved “keep me”.")
    expect(page).to_have_url(re.compile(r"\?pad="))
    page.reload()
    expect(page.get_by_label("Columns")).to_have_value("30")
    expect(page.get_by_label("Blue : red")).to_have_value("4")
    item = page.locator("#pad-list li", has_text="keep me")
    item.get_by_role("button", name="Delete keep me").click()
    item.get_by_role("button", name="Really delete keep me?").click()
    expect(page.locator("#status")).to_have_text("Deleted the pad.")
    expect(item).to_have_count(0)


def test_the_layers_codes_are_chosen_and_told(open_page: Callable[..., Page]) -> None:
    page = open_page(SMALL)
    facts = page.locator("#verification [data-ref=facts]")
    warning = page.locator("#verification [data-ref=warning]")
    expect(facts).to_contain_text("independent")
    expect(warning).to_be_empty()
    page.get_by_label("Codes of the layers").select_option("paper")
    expect(warning).to_contain_text("reads as another height")
    expect(facts).to_contain_text("one copies the other's corner")
    expect(page).to_have_url(re.compile(r"layers=paper"))


def test_a_pad_made_before_shows_that_its_layers_share_a_code(
    open_page: Callable[..., Page],
) -> None:
    page = open_page("/design")
    page.get_by_label("Import a pad file").set_input_files(PAD_FILE)
    expect(page.get_by_label("Codes of the layers")).to_have_value("paper")
    expect(page.locator("#verification [data-ref=warning]")).to_contain_text("share a code")
    expect(page.locator("#verification [data-ref=facts]")).to_contain_text("441 windows in both")


def test_import_and_every_download(open_page: Callable[..., Page], tmp_path: Path) -> None:
    page = open_page("/design")
    page.get_by_label("Import a pad file").set_input_files(PAD_FILE)
    expect(page.locator("#status")).to_contain_text("Imported")
    expect(page.locator("#pad-facts")).to_contain_text("1250 × 1250 mm")
    heads = {"pdf": b"%PDF", "svg": b"<", "png": b"\x89PNG", "json": b"{"}
    for kind, head in heads.items():
        with page.expect_download() as download:
            page.get_by_role("button", name=f"Download as {kind.upper()}").click()
        file = tmp_path / f"pad.{kind}"
        download.value.save_as(file)
        assert file.read_bytes().startswith(head)
    codes = [layer["codes"] for layer in json.loads(PAD_FILE.read_text())["layers"]]
    saved = json.loads((tmp_path / "pad.json").read_text())
    assert [layer["codes"] for layer in saved["layers"]] == codes
