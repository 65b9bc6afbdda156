"""What the browser tests share: the footage, and a watch over what a page does."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from urllib.parse import urlsplit

from places import FOOTAGE, ROOT
from playwright.sync_api import Locator, Page, Response, expect

FRONTEND = ROOT / "frontend"
PAD_FILE = FOOTAGE / "pad_a.json"
CAMERA_FILE = FOOTAGE / "camera_drone_half.yaml"
STILL = FOOTAGE / "stills" / "a_cast0_1300.jpg"
NEGATIVE = FOOTAGE / "negatives" / "n08_checker.jpg"

# Advice of the browser and of graphics drivers on how Plotly draws, which no page can heed.
_DRAWING_NOTES = ("Canvas2D: Multiple readback", "GL Driver Message")


def set_up_reading(page: Page) -> None:
    """Upload the footage's pad and camera on the Diagnose page."""
    page.get_by_label("Upload a pad file").set_input_files(PAD_FILE)
    expect(page.locator("#status")).to_contain_text("Imported the pad")
    page.get_by_label("Upload a camera file").set_input_files(CAMERA_FILE)
    expect(page.locator("#status")).to_contain_text("Added the camera")


THEMES = ("light", "dark")


def choose(place: Page | Locator, name: str | re.Pattern[str]) -> None:
    """One of several, by its label: the button itself is out of sight."""
    radio = place.get_by_role("radio", name=name)
    radio.locator("xpath=ancestor::label").click()
    expect(radio).to_be_checked()


def show_theme(page: Page, theme: str) -> None:
    """Have the system ask for a theme, and wait until the page is drawn in it."""
    page.emulate_media(color_scheme=theme)  # type: ignore[arg-type]
    # Charts are drawn anew at the next frame.
    page.evaluate("() => new Promise(then => requestAnimationFrame(() => setTimeout(then)))")


@dataclass
class Complaints:
    """What a page did that it must not; a test says which refusals it asks for.

    Attributes
    ----------
    faults : list of str
        Console errors, uncaught exceptions, requests to other hosts, refused requests.
    expected : set of int
        Statuses that the test provokes.
    """

    faults: list[str] = field(default_factory=list)
    expected: set[int] = field(default_factory=set)

    def watch(self, page: Page, host: str) -> None:
        def on_response(response: Response) -> None:
            if response.status >= 400 and response.status not in self.expected:
                self.faults.append(f"{response.status} {response.url}")

        def on_request(url: str) -> None:
            parts = urlsplit(url)
            if parts.scheme not in ("data", "blob") and parts.netloc != host:
                self.faults.append(f"request to another host: {url}")

        def on_console(kind: str, text: str) -> None:
            # The browser notes every refused request by itself; on_response judges those.
            if text.startswith("Failed to load resource"):
                return
            is_note = kind == "warning" and any(note in text for note in _DRAWING_NOTES)
            if kind in ("error", "warning") and not is_note:
                self.faults.append(f"console {kind}: {text}")

        page.on("response", on_response)
        page.on("request", lambda request: on_request(request.url))
        page.on("requestfailed", lambda request: self._on_failed(request.url, request.failure))
        page.on("console", lambda message: on_console(message.type, message.text))
        page.on("pageerror", lambda error: self.faults.append(f"exception: {error}"))

    def _on_failed(self, url: str, failure: str | None) -> None:
        # A newer request takes the place of an older one, and downloads leave the page.
        if failure != "net::ERR_ABORTED":
            self.faults.append(f"failed: {url}: {failure}")
