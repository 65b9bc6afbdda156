"""Uploads from the Flights page: broken connections, reloads, refusals, giving up."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import cv2
import httpx
import numpy as np
import recordings
from browser_support import FOOTAGE, Complaints, set_up_reading
from playwright.sync_api import Page, Route, expect

SLOW_MS = 120_000
UPLOAD = "**/api/v1/uploads/*"


def _large(folder: Path, video: Path) -> Path:
    """The video with bytes behind its end, which players pass over: sent in several parts."""
    path = folder / "large.mp4"
    path.write_bytes(video.read_bytes() + b"\0\0\x20\0free" + bytes(8184) + bytes(5_000_000))
    return path


def _uploads(studio_url: str) -> list[dict[str, object]]:
    answer = httpx.get(f"{studio_url}/api/v1/uploads?limit=1000", trust_env=False, timeout=60)
    return list(answer.raise_for_status().json()["items"])


def test_a_broken_connection_costs_nothing(
    open_page: Callable[..., Page], complaints: Complaints, footage: tuple[Path, Path]
) -> None:
    complaints.expected = {503}
    page = open_page("/flights")
    broken: list[str] = []

    def cut(route: Route) -> None:
        broken.append(route.request.method)
        route.fulfill(status=503)

    page.route(UPLOAD, cut, times=2)
    page.get_by_label("Choose files").set_input_files(footage[0])
    row = page.locator("#uploads li")
    expect(row).to_contain_text("Trying again", timeout=SLOW_MS)
    expect(page.locator("#uploads")).to_contain_text("1 file sent", timeout=SLOW_MS)
    assert broken == ["PATCH", "HEAD"]


def test_a_second_click_orders_no_second_flight(
    open_page: Callable[..., Page],
    complaints: Complaints,
    footage: tuple[Path, Path],
    flight_path: str,
) -> None:
    complaints.expected = {422}
    held: list[Route] = []
    refusal = {"error": {"code": "x", "message": "not now", "detail": {}}}

    def orders(page: Page, address: str, button: str, says: str) -> None:
        held.clear()
        page.route(address, lambda route: held.append(route))
        order = page.get_by_role("button", name=button, exact=True)
        order.click()
        expect(order).to_be_disabled()
        order.dispatch_event("click")
        page.wait_for_timeout(100)
        assert [route.request.method for route in held] == ["POST"]
        held[0].fulfill(status=422, json=refusal)
        expect(page.locator(says)).to_contain_text("Not now.")
        expect(order).to_be_enabled()

    page = open_page("/flights")
    set_up_reading(page)
    page.get_by_label("Choose files").set_input_files(footage[0])
    expect(page.locator("#uploads")).to_contain_text("1 file sent", timeout=SLOW_MS)
    orders(page, "**/api/v1/flights", "Analyse", "#status")
    page.goto(flight_path)
    page.get_by_role("button", name="Run again …").click()
    orders(page, "**/rerun", "Run", "#rerun [data-ref=refusal]")


def test_each_tab_has_its_own_files_and_takes_over_those_of_closed_ones(
    open_page: Callable[..., Page], footage: tuple[Path, Path]
) -> None:
    first = open_page("/flights")
    second = first.context.new_page()
    second.goto("/flights")
    first.get_by_label("Choose files").set_input_files(footage[0])
    expect(first.locator("#uploads")).to_contain_text("1 file sent", timeout=SLOW_MS)
    second.reload()
    second.get_by_label("Choose files").set_input_files(footage[1])
    expect(second.locator("#uploads li")).to_contain_text([footage[1].name])
    expect(second.locator("#uploads li")).to_have_count(1)
    first.reload()
    expect(first.locator("#uploads li")).to_contain_text([footage[0].name])
    first.close()
    third = second.context.new_page()
    third.goto("/flights")
    expect(third.locator("#uploads li")).to_contain_text([footage[0].name])
    expect(second.locator("#uploads li")).to_have_count(1)
    second.context.close()


def test_an_upload_goes_on_after_a_reload(
    open_page: Callable[..., Page], footage: tuple[Path, Path], tmp_path: Path, studio_url: str
) -> None:
    page = open_page("/flights")
    page.on("dialog", lambda dialog: dialog.accept())
    large = _large(tmp_path, footage[0])
    offsets: list[int] = []

    def hold(route: Route) -> None:
        offset = int(route.request.headers.get("upload-offset", "0"))
        offsets.append(offset)
        if offset == 0:
            route.continue_()

    page.route(UPLOAD, hold)
    page.get_by_label("Choose files").set_input_files(large)
    expect(page.locator("#uploads")).to_contain_text("1.0 MB of", timeout=SLOW_MS)
    # What is held goes on its way once nothing holds it, so the page lets go of it first.
    page.reload()
    row = page.locator("#uploads li")
    expect(row).to_contain_text("Choose the file again", timeout=SLOW_MS)
    page.unroute(UPLOAD)
    expect(page.get_by_role("button", name="Analyse when sent")).to_be_disabled()
    begun = [upload["id"] for upload in _uploads(studio_url) if upload["name"] == large.name]
    page.get_by_label("Choose files").set_input_files(large)
    expect(page.locator("#uploads")).to_contain_text("1 file sent", timeout=SLOW_MS)
    done = [upload for upload in _uploads(studio_url) if upload["name"] == large.name]
    assert [upload["id"] for upload in done] == begun
    assert [upload["complete"] for upload in done] == [True]
    page.reload()
    expect(page.locator("#uploads")).to_contain_text("1 file sent", timeout=SLOW_MS)


def test_an_upload_can_be_given_up(
    open_page: Callable[..., Page], footage: tuple[Path, Path], tmp_path: Path, studio_url: str
) -> None:
    page = open_page("/flights")
    page.route(UPLOAD, lambda route: None if route.request.method == "PATCH" else route.continue_())
    # The list names an upload before the server has heard of it.
    with page.expect_response(lambda response: response.request.method == "POST"):
        page.get_by_label("Choose files").set_input_files(_large(tmp_path, footage[0]))
    expect(page.locator("#uploads")).to_contain_text("0 B of")
    begun = [upload["id"] for upload in _uploads(studio_url) if not upload["complete"]]
    assert len(begun) == 1
    with page.expect_response(lambda response: response.request.method == "DELETE"):
        page.get_by_role("button", name="Remove large.mp4").click()
    expect(page.locator("#uploads")).to_be_hidden()
    assert [upload for upload in _uploads(studio_url) if not upload["complete"]] == []


def test_what_is_no_footage_is_refused_by_name(
    open_page: Callable[..., Page], complaints: Complaints, tmp_path: Path
) -> None:
    complaints.expected = {422}
    text, empty = tmp_path / "notes.mp4", tmp_path / "empty.mp4"
    text.write_text("these are notes and no video")
    empty.touch()
    page = open_page("/flights")
    page.get_by_label("Choose files").set_input_files([text, empty])
    expect(page.locator("#uploads li", has_text="empty.mp4")).to_contain_text("empty")
    expect(page.locator("#uploads li", has_text="notes.mp4")).to_contain_text("send a video")
    expect(page.locator("#missing")).to_contain_text("a video or stills")
    expect(page.get_by_role("button", name="Analyse when sent")).to_be_disabled()


def test_a_folder_of_many_stills_is_one_line(
    open_page: Callable[..., Page], tmp_path: Path
) -> None:
    folder = tmp_path / "stills"
    folder.mkdir()
    for number in range(9):
        cv2.imwrite(str(folder / f"{number}.png"), np.full((9, 16, 3), number, np.uint8))
    (folder / ".hidden").write_text("no still")
    page = open_page("/flights")
    page.get_by_label("Choose a folder").set_input_files(folder)
    expect(page.locator("#uploads li")).to_have_count(1)
    expect(page.locator("#uploads li")).to_contain_text("9 of 9 stills sent", timeout=SLOW_MS)


def test_a_recordings_topic_is_chosen(
    open_page: Callable[..., Page], complaints: Complaints, tmp_path: Path, studio_url: str
) -> None:
    complaints.expected = {422}
    topics = ("/down/image_raw", "/front/image_raw")
    scene = recordings.Scene(recordings.shots(2), "compressed", topics=topics)
    path = recordings.write_mcap(tmp_path / "two.mcap", scene)
    pad = {"file": ("pad.json", (FOOTAGE / "pad_a.json").read_bytes())}
    httpx.post(
        f"{studio_url}/api/v1/pads/import", files=pad, trust_env=False, timeout=60
    ).raise_for_status()
    page = open_page("/flights")
    expect(page.locator("#topic-field")).to_be_hidden()
    page.get_by_label("Choose files").set_input_files(path)
    expect(page.locator("#uploads")).to_contain_text("1 file sent", timeout=SLOW_MS)
    page.get_by_label("Take the camera that was recorded").check()
    page.get_by_role("button", name="Analyse").click()
    expect(page.locator("#status")).to_contain_text("2 topics with pictures: /down/image_raw")
    topic = page.get_by_label("Topic")
    expect(topic).to_be_focused()
    assert page.locator("#topics option").count() == len(topics)
    topic.fill(topics[1])
    page.get_by_role("button", name="Analyse").click()
    # The recording has no calibration.
    expect(page.locator("#status")).to_contain_text(f"no calibration beside {topics[1]}")
    page.locator("#uploads").get_by_role("button").first.click()
