"""What cannot be: a message in the page, at the place it belongs to, and the studio goes on."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest
from browser_support import CAMERA_FILE, NEGATIVE, PAD_FILE, STILL, Complaints, set_up_reading
from playwright.sync_api import Page, expect


@pytest.mark.parametrize(
    ("label", "value", "says"),
    [
        ("Window (b × b)", "40", "from 2 to 16"),
        ("Rows", "1000000", "from 2 to 300"),
        ("Rows", "3", "At least 5 rows"),
        ("Columns", "12.5", "whole number"),
        ("Red cell", "", "enter a number"),
        ("Blue : red", "90", "At most 25"),
        ("Window (b × b)", "3", "only 128 codes"),
    ],
)
def test_a_field_out_of_bounds_says_so_beside_it(
    open_page: Callable[..., Page], label: str, value: str, says: str
) -> None:
    page = open_page("/design")
    field = page.get_by_label(label)
    field.fill(value)
    expect(field).to_have_attribute("aria-invalid", "true")
    described = (field.get_attribute("aria-describedby") or "").split()[0]
    expect(page.locator(f"#{described}")).to_contain_text(says)
    expect(page.get_by_role("button", name="PDF")).to_be_disabled()
    page.get_by_role("button", name="Save pad").click()
    expect(field).to_be_focused()


@pytest.mark.parametrize(
    ("detail", "beside"),
    [
        ({}, ""),
        ({"fields": [{"place": "distance", "message": "distance is too large"}]}, "Distance is"),
    ],
)
def test_a_pad_that_the_server_cannot_make_is_explained(
    open_page: Callable[..., Page], complaints: Complaints, detail: object, beside: str
) -> None:
    complaints.expected = {422}
    page = open_page("/design?rows=25&cols=25")
    expect(page.locator("#pad-facts")).to_contain_text("25 × 25")
    # A search that fails takes as long as it may; its answer is known.
    error = {"code": "search_exhausted", "message": "the search ended at 3 of 9", "detail": detail}
    page.route(
        "**/pads/preview", lambda route: route.fulfill(status=422, json={"error": error}), times=1
    )
    page.locator("#spec-form summary").click()
    page.get_by_label("Least distance").fill("9")
    message = page.locator("#viewer [data-ref=message]")
    expect(message).to_have_text("The search ended at 3 of 9.")
    expect(page.locator("#distance-error")).to_contain_text(beside)
    page.get_by_label("Least distance").fill("1")
    expect(page.locator("#pad-facts")).to_contain_text("25 × 25")
    expect(message).to_be_empty()


def test_ill_formed_files_are_refused_with_the_reason(
    open_page: Callable[..., Page], complaints: Complaints, tmp_path: Path
) -> None:
    complaints.expected = {422}
    ragged = json.loads(PAD_FILE.read_text())
    ragged["layers"][0]["codes"][7] += "1"
    pad = tmp_path / "ragged.json"
    pad.write_text(json.dumps(ragged))
    camera = tmp_path / "camera.yaml"
    camera.write_text("image_width: 640\n")
    page = open_page("/design")
    page.get_by_label("Import a pad file").set_input_files(pad)
    expect(page.locator("#status")).to_contain_text("codes[7]")
    page.goto("/diagnose")
    page.get_by_label("Upload a camera file").set_input_files(camera)
    expect(page.locator("#status")).to_contain_text("camera.yaml: ")
    expect(page.locator("#status")).to_have_class(re.compile("notice-bad"))


def _png(path: Path, width: int, height: int) -> Path:
    cv2.imwrite(str(path), np.zeros((height, width), np.uint8))
    return path


def test_pictures_that_cannot_be_read_are_explained_and_the_rest_goes_on(
    open_page: Callable[..., Page], complaints: Complaints, tmp_path: Path
) -> None:
    complaints.expected = {413, 422}
    (tmp_path / "empty.jpg").touch()
    (tmp_path / "text.jpg").write_text("not a picture")
    (tmp_path / "cut.jpg").write_bytes(STILL.read_bytes()[:4000])
    (tmp_path / "heavy.jpg").write_bytes(b"\xff" * 3_100_000)
    _png(tmp_path / "vast.png", 4000, 2250)
    _png(tmp_path / "square.png", 500, 500)
    reasons = {
        "empty.jpg": "empty",
        "text.jpg": "no picture",
        "cut.jpg": "cut off",
        "heavy.jpg": "MB",
        "vast.png": "pixels",
        "square.png": "500 x 500",
    }
    page = open_page("/diagnose")
    set_up_reading(page)
    page.get_by_label("Choose pictures").set_input_files(
        [*(tmp_path / name for name in reasons), STILL]
    )
    expect(page.locator("#frames [data-ref=tally]")).to_have_text(
        "1 with a pose, 6 not readable", timeout=60_000
    )
    for name, reason in reasons.items():
        page.locator("#frames li", has_text=name).locator("[data-ref=open]").click()
        expect(page.locator("[data-ref=refusal]")).to_contain_text(re.compile(reason, re.I))
        expect(page.locator("#workbench")).to_be_hidden()


def test_a_picture_without_the_pad_says_where_it_failed_and_why(
    open_page: Callable[..., Page],
) -> None:
    page = open_page("/diagnose")
    set_up_reading(page)
    page.get_by_label("Choose pictures").set_input_files(NEGATIVE)
    expect(page.locator("#verdict")).to_have_text(re.compile(r"No pose: .+ at stage \w+"))
    failures = page.locator("[data-ref=failure-list] li")
    expect(failures.first).to_contain_text(re.compile(r"\d"))
    expect(page.locator("#workbench .tile[data-failed]").first).to_be_visible()
    expect(page.locator("[data-ref=figures]")).to_be_hidden()


def test_a_link_to_a_result_that_is_gone(
    open_page: Callable[..., Page], complaints: Complaints
) -> None:
    complaints.expected = {404}
    page = open_page("/diagnose?trace=0123456789abcdef&view=red-lines")
    expect(page.locator("#status")).to_have_class(re.compile("notice-bad"))
    expect(page.locator("#workbench")).to_be_hidden()


def test_a_server_that_does_not_answer(
    open_page: Callable[..., Page], complaints: Complaints
) -> None:
    page = open_page("/diagnose")
    set_up_reading(page)
    page.route("**/api/v1/detect", lambda route: route.abort("connectionrefused"))
    page.get_by_label("Choose pictures").set_input_files(STILL)
    expect(page.locator("[data-ref=refusal]")).to_contain_text("does not answer")
    assert [fault.split(":")[0] for fault in complaints.faults] == ["failed"]
    complaints.faults.clear()
    page.unroute("**/api/v1/detect")
    page.locator("#report").get_by_role("button", name="Try again").click()
    expect(page.locator("#verdict")).to_contain_text("Pose found")


def test_an_address_without_a_page(open_page: Callable[..., Page], complaints: Complaints) -> None:
    complaints.expected = {404}
    page = open_page("/nowhere")
    expect(page.get_by_role("heading", level=1)).to_have_text("Not Found")
    page.get_by_role("link", name="Design a pad").click()
    expect(page).to_have_url(re.compile("/design$"))


def test_a_dropped_calibration_is_taken_as_the_camera(open_page: Callable[..., Page]) -> None:
    page = open_page("/diagnose")
    page.get_by_label("Choose pictures").set_input_files([PAD_FILE, CAMERA_FILE, STILL])
    expect(page.locator("#verdict")).to_contain_text("Pose found")
