"""A live session's recording on the Flights page: dropped, opened, looked at, run again."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from browser_support import Complaints
from flight_footage import BLANK, FRAMES
from live_sessions import record_landing, zip_of
from playwright.sync_api import Page, expect

SLOW_MS = 120_000
MISSED = frozenset({5, 12, 20})
POSES = f"{FRAMES - len(BLANK | MISSED)} of {FRAMES}"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, footage: tuple[Path, Path]) -> Path:
    return record_landing(tmp_path_factory.mktemp("live") / "landing", footage[0], MISSED)


def open_recording(page: Page) -> None:
    """Press the button, and see the flight."""
    expect(page.locator("#live-recording")).to_be_visible(timeout=SLOW_MS)
    # Its pad and its camera come with it.
    expect(page.locator("#missing")).to_be_empty()
    button = page.get_by_role("button", name="Open", exact=True)
    expect(button).to_be_enabled(timeout=SLOW_MS)
    button.click()
    page.wait_for_url("**/flights/*", timeout=SLOW_MS)
    expect(page.locator("[data-ref=state]").first).to_have_text("Done", timeout=SLOW_MS)


def test_a_folder_opens_with_its_poses_and_what_was_dropped(
    open_page: Callable[..., Page], folder: Path
) -> None:
    page = open_page("/flights")
    page.get_by_label("Choose a folder").set_input_files(folder)
    open_recording(page)
    page.set_viewport_size({"width": 1280, "height": 900})
    expect(page.locator("main")).to_contain_text(POSES)
    expect(page.locator("main")).to_contain_text("rtsp://pilot@drone.local/live")
    dropped = min(MISSED)
    page.goto(f"{page.url.split('?')[0]}?frame={dropped}")
    expect(page.locator("main")).to_contain_text("passed over in the live session", timeout=SLOW_MS)
    expect(page.locator("main")).to_contain_text("run the flight again")
    # Its picture is there all the same.
    picture = page.locator("#player img, .player img, [data-ref=picture]").first
    expect(picture).to_be_visible(timeout=SLOW_MS)
    page.goto(f"{page.url.split('?')[0]}?frame=22")
    expect(page.locator("main")).to_contain_text("after the frame came", timeout=SLOW_MS)


def test_a_zip_opens_in_the_same_way(
    open_page: Callable[..., Page], folder: Path, tmp_path: Path
) -> None:
    page = open_page("/flights")
    page.get_by_label("Choose files").set_input_files(zip_of(folder, tmp_path / "landing.zip"))
    open_recording(page)
    expect(page.locator("main")).to_contain_text(POSES)


def test_what_is_no_recording_is_refused_in_words(
    open_page: Callable[..., Page], complaints: Complaints, folder: Path
) -> None:
    complaints.expected = {422}
    page = open_page("/flights")
    page.get_by_label("Choose files").set_input_files([folder / "session.json"])
    expect(page.locator("#uploads")).to_contain_text("1 file sent", timeout=SLOW_MS)
    with page.expect_response("**/from-recording"):
        page.get_by_role("button", name="Open", exact=True).click()
    expect(page.locator("#status")).to_contain_text("0001.mp4 is missing")
