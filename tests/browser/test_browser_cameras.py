"""The Cameras page: a camera from real uploads, its maps, its pictures, and where it is used."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest
from browser_support import CAMERA_FILE, PAD_FILE, Complaints
from calibration_shots import LENSES, poses_about, shots
from playwright.sync_api import Page, expect

from padstudio.pad.spec import Pad

SLOW_MS = 180_000
CAMERA = LENSES["straight"]


@pytest.fixture(scope="module")
def stills(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Four stills of the pad, and one without it."""
    pad = Pad.load(PAD_FILE)
    folder = tmp_path_factory.mktemp("stills")
    pictures = shots(pad, CAMERA, poses_about(max(pad.size_mm), CAMERA, 4, seed=1))
    pictures.append(np.full_like(pictures[0], 90))
    files = [folder / f"still {number}.jpg" for number in range(len(pictures))]
    for file, picture in zip(files, pictures, strict=True):
        cv2.imwrite(str(file), picture)
    return files


@pytest.fixture
def cameras(open_page: Callable[..., Page]) -> Page:
    page = open_page("/cameras")
    page.get_by_label("Upload a pad file").set_input_files(PAD_FILE)
    expect(page.locator("#status")).to_contain_text("Imported the pad")
    return page


def test_stills_become_a_camera_that_diagnose_offers(cameras: Page, stills: list[Path]) -> None:
    expect(cameras.locator("#missing")).to_contain_text("Add stills or a clip")
    expect(cameras.get_by_role("button", name="Calibrate")).to_be_disabled()
    cameras.get_by_label("Choose files").set_input_files(stills)
    cameras.get_by_label("Lens", exact=True).select_option("radtan")
    cameras.get_by_role("button", name="Calibrate").click()
    expect(cameras.locator("#running")).to_be_visible()
    result = cameras.locator("#result")
    expect(result).to_be_visible(timeout=SLOW_MS)
    expect(cameras.locator("#running")).to_be_hidden()
    # What it lacks is said, and which picture to take again.
    expect(result).to_contain_text("4 pictures; a dozen")
    expect(result.locator(".picture-item").last).to_contain_text("not read")
    expect(result.locator("[data-ref=parameters] tr")).to_have_count(9)
    expect(result.locator("[data-ref=coverage] rect")).to_have_count(160)
    fx = result.locator("[data-ref=parameters] tr").first.inner_text()
    assert abs(float(re.findall(r"[\d.]+", fx)[0]) - CAMERA.matrix[0, 0]) < 10
    result.get_by_role("button", name="still 2.jpg").click()
    picture = result.get_by_alt_text("still 2.jpg: points measured and their residuals")
    expect(picture).to_have_js_property("naturalWidth", 960)
    # A reload brings it back.
    cameras.reload()
    expect(result).to_be_visible()
    cameras.get_by_label("Name of the camera").fill("tripod <b>camera</b>")
    cameras.get_by_label("Readout time, ms").fill("-1")
    cameras.get_by_role("button", name="Store the camera").click()
    expect(cameras.locator("#camera-readout-error")).to_contain_text("Milliseconds from 0")
    cameras.get_by_label("Readout time, ms").fill("0")
    cameras.get_by_role("button", name="Store the camera").click()
    expect(result.locator("[data-ref=stored]")).to_contain_text("Stored as")
    row = cameras.locator("#stored .camera-item").filter(has_text="tripod <b>camera</b>")
    with cameras.expect_download() as downloaded:
        row.get_by_role("link", name=re.compile("Download")).click()
    assert "image_width: 960" in downloaded.value.path().read_text()
    row.locator("[data-ref=open]").click()
    expect(cameras.locator("#camera-choice select option:checked")).to_contain_text("tripod <b>")


def test_pictures_without_the_pad_are_told(cameras: Page, stills: list[Path]) -> None:
    cameras.get_by_label("Choose files").set_input_files([stills[-1]] * 3)
    cameras.get_by_role("button", name="Calibrate").click()
    expect(cameras.locator("#status")).to_contain_text(
        "No calibration: the pad was read in 0 of 3 pictures", timeout=SLOW_MS
    )
    cameras.get_by_role("button", name="Remove all").click()
    expect(cameras.locator("#picture-files")).to_be_hidden()


def test_a_calibration_can_be_stopped(cameras: Page, stills: list[Path]) -> None:
    cameras.get_by_label("Choose files").set_input_files(stills)
    cameras.get_by_role("button", name="Calibrate").click()
    cameras.get_by_role("button", name="Stop").click()
    expect(cameras.locator("#running")).to_be_hidden()
    expect(cameras.get_by_role("button", name="Calibrate")).to_be_enabled()
    expect(cameras.locator("#result")).to_be_hidden()


def test_a_camera_file_is_imported(cameras: Page, complaints: Complaints) -> None:
    complaints.expected = {422}
    cameras.get_by_label("Import a camera file").set_input_files(CAMERA_FILE)
    expect(cameras.locator("#status")).to_contain_text("Imported the camera")
    expect(cameras.locator("#stored .camera-item").first).to_be_visible()
    cameras.get_by_label("Import a camera file").set_input_files(PAD_FILE)
    expect(cameras.locator("#status")).to_have_class(re.compile("notice-bad"))


def test_a_lens_without_distortion_is_ticked(
    cameras: Page, complaints: Complaints, tmp_path: Path
) -> None:
    complaints.expected = {422}
    silent = tmp_path / "silent.yaml"
    silent.write_text("width: 640\nheight: 480\nK: [500, 0, 320, 0, 500, 240, 0, 0, 1]\n")
    cameras.get_by_label("Import a camera file").set_input_files(silent)
    expect(cameras.locator("#status")).to_contain_text("the tick on the Cameras page")
    cameras.get_by_label("The lens has no distortion").check()
    cameras.get_by_label("Import a camera file").set_input_files(silent)
    expect(cameras.locator("#status")).to_contain_text("Imported the camera “silent”")
    expect(cameras.get_by_label("The lens has no distortion")).not_to_be_checked()
    cameras.get_by_label("Download as").select_option("COLMAP")
    link = cameras.get_by_label("Download silent as of COLMAP").first
    expect(link).to_have_attribute("href", re.compile(r"/files/cameras\.txt$"))
    # What a camera's note says is there to be read, whole.
    note = cameras.locator("#stored .item-note", has_text="640 × 480").first
    assert note.evaluate("note => note.scrollWidth <= note.clientWidth")


def test_a_pad_and_a_camera_among_the_files_are_taken_as_such(
    open_page: Callable[..., Page],
) -> None:
    page = open_page("/cameras")
    page.get_by_label("Choose files").set_input_files([CAMERA_FILE, PAD_FILE])
    expect(page.locator("#status")).to_contain_text("Imported the pad")
    expect(page.locator("#stored li").first).to_be_visible()
    expect(page.locator("#picture-files li")).to_have_count(0)
