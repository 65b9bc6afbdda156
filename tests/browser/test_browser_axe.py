"""axe finds nothing on any page, in the states that people see, wide and narrow, light and dark."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import axe
import numpy as np
import pytest
from browser_support import (
    CAMERA_FILE,
    NEGATIVE,
    PAD_FILE,
    STILL,
    THEMES,
    set_up_reading,
    show_theme,
)
from camera_page import calibrate_on
from playwright.sync_api import FilePayload, Page, expect

from padstudio.flights.bundles.contents import Alone, Neighbour, pack
from padstudio.flights.bundles.making import bundle_still
from padstudio.flights.tasks.detectors import Recipe

WIDTHS = (1280, 390)
SLOW_MS = 120_000


def _read(page: Page, picture: Any, verdict: str) -> None:
    set_up_reading(page)
    page.get_by_label("Choose pictures").set_input_files(picture)
    expect(page.locator("#verdict")).to_contain_text(verdict)
    expect(page.locator("#workbench .stage-row-blue .tile").last).to_be_visible()


def _flight(page: Page) -> None:
    expect(page.locator("#workbench .tile").first).to_be_visible(timeout=SLOW_MS)
    page.locator("#charts").scroll_into_view_if_needed()
    expect(page.locator("[data-ref=space] .main-svg").first).to_be_attached(timeout=SLOW_MS)
    for panel in ("#sweep", "#frames"):
        page.locator(f"{panel} summary").click()
    expect(page.locator("#frames tbody tr").first).to_be_visible()
    expect(page.locator("#sweep option").first).to_be_attached()


def _shows_cells(page: Page) -> None:
    _read(page, STILL, "Pose found")
    page.get_by_role("button", name="With the frame's pose").click()
    expect(page.locator("[data-ref=cells-verdicts]")).to_contain_text("cells agree")


def _opens_bundle(page: Page) -> None:
    """A frame of a run with neighbours, whose result is another here."""
    texts = PAD_FILE.read_text(), CAMERA_FILE.read_text()
    made = bundle_still(Recipe(*texts), STILL.read_bytes(), "a.jpg")
    beside = tuple(
        Neighbour(offset, np.full((90, 160, 3), 90, np.uint8), made.result) for offset in (-1, 1)
    )
    altered = {**made.result, "cells_read": 1}
    alone = Alone("dense", "{}", made.result)
    made = replace(
        made, reading="run", result=altered, recorded=altered, alone=alone, neighbours=beside
    )
    files = FilePayload(name="a.zip", mimeType="application/zip", buffer=pack(made))
    page.get_by_label("Choose pictures").set_input_files(files)
    expect(page.locator("#bundle [data-ref=verdict]")).to_contain_text("another", timeout=SLOW_MS)
    expect(page.locator("#workbench .stage-row-blue .tile").last).to_be_visible()
    page.locator("#bundle summary").click()
    expect(page.locator("#bundle figure")).to_have_count(2)


def _opens(name: str) -> Callable[[Page], None]:
    def act(page: Page) -> None:
        if name == "Keys":
            page.keyboard.press("?")
        else:
            page.get_by_role("button", name=name).click()
        expect(page.get_by_role("dialog")).to_be_visible()

    return act


#: What is done on a page before it is looked at; "flight" stands for one that is done.
STATES: dict[str, tuple[str, Callable[[Page], object]]] = {
    "home": ("/", lambda page: expect(page.locator("h1")).to_be_attached()),
    "design": (
        "/design?rows=25&cols=25",
        lambda page: expect(page.locator("#pad-facts")).to_contain_text("25 × 25"),
    ),
    "plan": ("/plan", lambda page: expect(page.locator("h1")).to_be_attached()),
    "diagnose": ("/diagnose", lambda page: expect(page.locator("#welcome")).to_be_visible()),
    "diagnose, cells": ("/diagnose", _shows_cells),
    "diagnose, no pose": ("/diagnose", lambda page: _read(page, NEGATIVE, "No pose")),
    "diagnose, bundle": ("/diagnose", _opens_bundle),
    "cameras": ("/cameras", lambda page: expect(page.locator("#stored")).to_be_visible()),
    "calibration": ("/cameras", calibrate_on),
    "experiments": (
        "/experiments",
        lambda page: expect(page.locator("#reproduction")).to_be_visible(),
    ),
    "live": ("/live", lambda page: expect(page.locator("#order")).to_be_visible()),
    "flights": ("/flights", lambda page: expect(page.locator("#order")).to_be_visible()),
    "flight": ("flight", _flight),
    "run again": ("flight", _opens("Run again …")),
    "keys": ("flight", _opens("Keys")),
}


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("state", STATES)
def test_axe_finds_nothing(
    open_page: Callable[..., Page],
    request: pytest.FixtureRequest,
    state: str,
    width: int,
) -> None:
    path, act = STATES[state]
    address = str(request.getfixturevalue("flight_path")) if path == "flight" else path
    page = open_page(address, width=width)
    act(page)
    for theme in THEMES:
        show_theme(page, theme)
        passed, found = axe.checked(page)
        assert found == [], theme
        assert passed > 10


def test_axe_is_at_work(open_page: Callable[..., Page]) -> None:
    page = open_page("/diagnose")
    page.evaluate("""() => {
      const button = document.createElement("button");
      document.querySelector("main").append(button);
    }""")
    _, found = axe.checked(page)
    assert any(line.startswith("button-name") for line in found)
