"""A studio with the real detector, a browser, and pages that must not complain."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from browser_support import PAD_FILE, Complaints
from flight_footage import FLIGHT_CAMERA, order_flight, write_flight
from playwright.sync_api import Browser, Page, expect, sync_playwright
from web_server import running, settings_for

LIMITS = {
    "max_upload_bytes": 3_000_000,
    "max_image_pixels": 2_000_000,
    "max_cells": 300,
    "generate_seconds": 20,
    "detect_seconds": 60,
}
# The headless shell opens a page at a sixth of the cost of a browser that could show windows.
_NAMES = (
    "chromium-headless-shell",
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
)
_MAC = (
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    "/Applications/Chromium.app/Contents/MacOS/Chromium",
)
_FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


@pytest.fixture(scope="package")
def studio_url(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Address of a server with the real detector."""
    with running(settings_for(tmp_path_factory.mktemp("studio"), **LIMITS)) as client:
        yield str(client.base_url).rstrip("/")


@pytest.fixture(scope="package")
def footage(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A small video and its telemetry."""
    return write_flight(tmp_path_factory.mktemp("footage"))


@pytest.fixture(scope="package")
def flight_path(studio_url: str, footage: tuple[Path, Path]) -> str:
    """The page of a flight that is done."""
    return f"/flights/{order_flight(studio_url, footage, PAD_FILE, FLIGHT_CAMERA)}"


@pytest.fixture(scope="package")
def launch() -> Iterator[Callable[..., Browser]]:
    """Starts the system's Chromium or Chrome, with further flags."""
    candidates = [os.environ.get("PADSTUDIO_CHROMIUM"), *map(shutil.which, _NAMES), *_MAC]
    found = next((path for path in candidates if path and Path(path).exists()), None)
    assert found, "no Chromium or Chrome: install one, or name it in PADSTUDIO_CHROMIUM"
    # The first picture waits for a worker process to start, on a machine that tests keep busy.
    expect.set_options(timeout=120_000)
    with sync_playwright() as playwright:
        yield lambda *flags: playwright.chromium.launch(
            executable_path=found, args=[*_FLAGS, *flags]
        )


@pytest.fixture(scope="package")
def browser(launch: Callable[..., Browser]) -> Iterator[Browser]:
    """The browser of most tests, without a camera."""
    browser = launch()
    yield browser
    browser.close()


@pytest.fixture
def complaints() -> Complaints:
    """What the test's pages complained of."""
    return Complaints()


@pytest.fixture
def open_page(
    browser: Browser, studio_url: str, complaints: Complaints
) -> Iterator[Callable[..., Page]]:
    """Opens a path in a context of its own; fails the test on any complaint of the page."""
    contexts = []

    def open_path(path: str, *, width: int = 1280, height: int = 900, theme: str = "light") -> Page:
        context = browser.new_context(
            base_url=studio_url,
            viewport={"width": width, "height": height},
            color_scheme="dark" if theme == "dark" else "light",
            locale="en-GB",
            timezone_id="UTC",
        )
        contexts.append(context)
        page = context.new_page()
        page.set_default_timeout(120_000)
        complaints.watch(page, urlsplit(studio_url).netloc)
        page.goto(path)
        return page

    yield open_path
    for context in contexts:
        context.close()
    assert complaints.faults == []
