"""Reachable and legible for everyone: names, headings, contrast, focus, widths, keyboard."""

from __future__ import annotations

from collections.abc import Callable
from itertools import groupby, pairwise
from typing import Any

import pytest
from browser_support import STILL, THEMES, choose, set_up_reading, show_theme
from camera_page import calibrate_on
from playwright.sync_api import Page, expect

#: The last stands for the page of a flight that is done.
PAGES = ("/design?rows=25&cols=25", "/diagnose", "/flights", "/cameras", "/live", "flight")
WIDTHS = (1280, 390)

# Elements that a user operates or reads, without those that are hidden.
_NAMELESS = """() => [
  ...document.querySelectorAll("button, a[href], input, select, [tabindex='0']")]
  .filter(e => e.checkVisibility())
  .filter(e => {
    const labels = [...(e.labels ?? [])].map(l => l.textContent).join("");
    const said = e.getAttribute("aria-label") ?? "";
    return !(said + labels + (e.matches("button, a") ? e.textContent : "")).trim();
  }).map(e => e.outerHTML.slice(0, 120))"""

# Pairs of text and its effective background whose contrast is below 4.5 (WCAG 2.2, 1.4.3; text of
# 24 px, or 18.66 px and bold, 3.0).
_FAINT = """() => {
  const context = new OffscreenCanvas(1, 1).getContext("2d", { willReadFrequently: true });
  const rgba = colour => {
    context.clearRect(0, 0, 1, 1);
    context.fillStyle = colour;
    context.fillRect(0, 0, 1, 1);
    return [...context.getImageData(0, 0, 1, 1).data];
  };
  const luminance = rgb => rgb.slice(0, 3).map(v => v / 255)
    .map(v => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
    .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
  const background = element => {
    for (let e = element; e; e = e.parentElement) {
      const colour = rgba(getComputedStyle(e).backgroundColor);
      if (colour[3] === 255) return colour;
    }
    return rgba("white");
  };
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  const faint = [];
  for (let node; (node = walker.nextNode());) {
    const element = node.parentElement;
    if (!node.data.trim() || !element.checkVisibility() || element.closest(":disabled")) continue;
    if (element.closest(".visually-hidden, .skip-link, noscript, option")) continue;
    const style = getComputedStyle(element);
    const [a, b] = [luminance(rgba(style.color)), luminance(background(element))];
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    const size = parseFloat(style.fontSize);
    const isLarge = size >= 24 || (size >= 18.66 && Number(style.fontWeight) >= 700);
    const text = node.data.trim().slice(0, 40);
    if (ratio < (isLarge ? 3 : 4.5)) faint.push(`${ratio.toFixed(2)} ${text}`);
  }
  return faint;
}"""

_OVERFLOWING = """() => [...document.querySelectorAll("body *")]
  .filter(e => e.checkVisibility() && !e.closest(".visually-hidden, .skip-link, dialog"))
  .filter(e => e.getBoundingClientRect().right > document.documentElement.clientWidth + 1)
  .map(e => e.outerHTML.slice(0, 120))"""

_FOCUSED = """() => {
  const e = document.activeElement;
  const shown = e.closest("label") ?? e;
  const ring = [e, shown, e.nextElementSibling].filter(Boolean)
    .some(x => getComputedStyle(x).outlineStyle !== "none");
  const box = shown.getBoundingClientRect();
  // A list with a scroll bar of its own moves its rows as the focus goes through them.
  let scrolled = scrollY;
  for (let p = e.parentElement; p && p !== document.documentElement; p = p.parentElement)
    scrolled += p.scrollTop;
  return { tag: e.tagName, id: e.id || e.dataset.ref || e.textContent.trim().slice(0, 20),
           ring, top: box.top + scrolled, region: e.closest(".panel, header, footer")?.id,
           left: box.left, right: box.right };
}"""


@pytest.fixture
def address(request: pytest.FixtureRequest, path: str) -> str:
    """The address of a page of `PAGES`."""
    return str(request.getfixturevalue("flight_path")) if path == "flight" else path


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("path", PAGES)
def test_names_contrast_and_width(
    open_page: Callable[..., Page], address: str, path: str, width: int
) -> None:
    page = open_page(address, width=width)
    if path == "flight":
        expect(page.locator("#verdict")).to_contain_text("Pose found")
        page.locator("#charts").scroll_into_view_if_needed()
        chart = page.locator("[data-ref=space] .main-svg").first
        expect(chart).to_be_attached(timeout=120_000)
    elif path == "/cameras":
        calibrate_on(page)
    elif path in ("/flights", "/live"):
        expect(page.locator("#order")).to_be_visible()
    elif path.startswith("/diagnose"):
        set_up_reading(page)
        page.get_by_label("Choose pictures").set_input_files(STILL)
        expect(page.locator("#verdict")).to_contain_text("Pose found")
        expect(page.locator("#workbench .stage-row-blue .tile").last).to_be_visible()
    else:
        expect(page.locator("#pad-facts")).to_contain_text("25 × 25")
    assert page.evaluate(_NAMELESS) == []
    for theme in THEMES:
        show_theme(page, theme)
        assert page.evaluate(_FAINT) == [], theme
    assert page.evaluate(_OVERFLOWING) == []
    assert page.evaluate("document.documentElement.scrollWidth") <= width


@pytest.mark.parametrize("path", PAGES)
def test_a_key_lists_the_keys(open_page: Callable[..., Page], address: str, path: str) -> None:
    page = open_page(address, width=390)
    dialog = page.get_by_role("dialog", name="Keys")
    expect(dialog).to_be_hidden()
    page.keyboard.press("?")
    expect(dialog).to_be_visible()
    expect(dialog).to_contain_text("this list")
    assert page.evaluate(_NAMELESS) == []
    assert page.evaluate(_FAINT) == []
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    page.keyboard.press("Escape")
    expect(dialog).to_be_hidden()
    page.get_by_role("button", name="Keys", exact=True).click()
    expect(dialog).to_be_visible()
    dialog.get_by_role("button", name="Close").click()
    expect(dialog).to_be_hidden()


@pytest.mark.parametrize("path", PAGES)
def test_structure(open_page: Callable[..., Page], address: str) -> None:
    page = open_page(address)
    assert page.locator("html").get_attribute("lang") == "en"
    assert page.locator("h1").count() == 1
    assert page.locator("main").count() == 1
    ids = page.evaluate("() => [...document.querySelectorAll('[id]')].map(e => e.id)")
    assert len(ids) == len(set(ids))
    dangling = page.evaluate(
        """() => [...document.querySelectorAll("[aria-describedby], [aria-labelledby], label[for]")]
          .flatMap(e => [e.getAttribute("aria-describedby"), e.getAttribute("aria-labelledby"),
                         e.getAttribute("for")].filter(Boolean).join(" ").split(/\\s+/))
          .filter(id => !document.getElementById(id))"""
    )
    assert dangling == []
    inline = page.evaluate(
        "async () => { const text = await (await fetch(location.href)).text();"
        " return text.match(/ style=| on[a-z]+=|<style|<script(?![^>]*src)/g) ?? []; }"
    )
    assert inline == []


@pytest.mark.parametrize("path", PAGES[:-1])
def test_tab_reaches_everything_in_reading_order_with_a_visible_focus(
    open_page: Callable[..., Page], path: str
) -> None:
    page = open_page(path)
    expect(page.locator("#viewer canvas, #welcome, #order").first).to_be_visible()
    seen: list[dict[str, Any]] = []
    for _ in range(150):
        page.keyboard.press("Tab")
        focus = page.evaluate(_FOCUSED)
        if focus["tag"] == "BODY":
            break
        seen.append(focus)
    else:
        pytest.fail("the focus never leaves the page")
    assert [focus["id"] for focus in seen if not focus["ring"]] == []
    assert seen[0]["id"] == "Skip to the content"
    regions = [focus["region"] for focus in seen if focus["region"]]
    # Each region is left once and for all.
    assert len({*regions}) == len([region for region, _ in groupby(regions)])
    for before, after in pairwise(seen):
        if before["region"] and before["region"] == after["region"]:
            # Neighbours in a row may differ a little in height, and a column may follow.
            below = after["top"] >= before["top"] - 40
            assert below or after["left"] >= before["right"], (before, after)


def test_the_theme_switch_outlives_a_reload(open_page: Callable[..., Page]) -> None:
    page = open_page("/design?rows=25&cols=25")
    ground = "() => getComputedStyle(document.body).backgroundColor"
    light = page.evaluate(ground)
    choose(page, "Dark")
    dark = page.evaluate(ground)
    assert dark != light
    page.reload()
    assert page.evaluate(ground) == dark
    choose(page, "Auto")
    assert page.evaluate(ground) == light
