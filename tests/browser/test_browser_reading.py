"""What is known of a picture beforehand: pads that may be in view, the shutter, a tripod."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
from browser_support import CAMERA_FILE, PAD_FILE, set_up_reading
from dense_frames import random_pad
from playwright.sync_api import Page, expect

from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import look_at_pad
from padstudio.pad.spec import Pad
from padstudio.simulate.radiance.scene import Neighbour, Scene
from padstudio.simulate.render import render


def _both_pads(beside: Pad) -> bytes:
    """A picture of the footage's pad with another one beside it."""
    pad = Pad.load(PAD_FILE)
    gap_mm = (pad.size_mm[0] + beside.size_mm[0]) / 2 + 120
    scene = Scene(pad=pad, neighbours=(Neighbour(pad=beside, x_mm=gap_mm, y_mm=0.0),))
    pose = look_at_pad(2.2 * gap_mm, tilt_deg=6, target_mm=(gap_mm / 2, 0.0))
    image = render(scene, Camera.load(CAMERA_FILE), pose).image
    return np.asarray(cv2.imencode(".jpg", image)[1]).tobytes()


def test_several_pads_are_looked_for_and_named(
    open_page: Callable[..., Page], tmp_path: Path
) -> None:
    other = replace(random_pad(7, cells=(60, 12)), name="the one beside")
    other.save(tmp_path / "other.json")
    page = open_page("/diagnose")
    page.get_by_label("Upload a pad file").set_input_files(tmp_path / "other.json")
    expect(page.locator("#status")).to_contain_text("Imported the pad")
    beside = str(page.locator("#pad-choice select").input_value())
    set_up_reading(page)
    page.locator("#more-pads summary").click()
    page.locator(f"#more-pads input[value='{beside}']").check()
    expect(page.locator("#more-pads [data-ref=note]")).to_contain_text("2 pads are looked for")
    expect(page).to_have_url(re.compile(f"others={beside}"))
    picture = {"name": "both.jpg", "mimeType": "image/jpeg", "buffer": _both_pads(other)}
    page.get_by_label("Choose pictures").set_input_files([picture])  # type: ignore[list-item]
    names = {other.name, Pad.load(PAD_FILE).name}
    source = page.locator("#report [data-ref=source]")
    expect(source).to_contain_text("pad “", timeout=90_000)
    told = str(source.text_content())
    [left] = [name for name in names if f"“{name}”" not in told]
    also = page.locator("#report [data-ref=notes]")
    expect(also).to_contain_text(f"Also in the picture: the pad “{left}”")
    # A link brings the ticks back, and Flights takes them, too.
    page.goto(page.url.replace("/diagnose", "/flights"))
    page.locator("#more-pads summary").click()
    expect(page.locator(f"#more-pads input[value='{beside}']")).to_be_checked()


def test_the_shutter_of_a_camera_and_a_tripod(open_page: Callable[..., Page]) -> None:
    page = open_page("/diagnose")
    set_up_reading(page)
    page.locator("#shutter summary").click()
    field = page.get_by_label("Readout time, ms")
    field.fill("fast")
    page.get_by_role("button", name="Store").click()
    expect(page.locator("#shutter [data-ref=error]")).to_contain_text("Milliseconds from 0")
    field.fill("18.5")
    field.press("Enter")
    expect(page.locator("#camera-choice [data-ref=note]")).to_contain_text("shutter rolls 18.5 ms")
    expect(page.locator("#shutter [data-ref=error]")).to_be_empty()
    page.get_by_label("at rest (tripod)").check()
    expect(page).to_have_url(re.compile("rest=1"))
    page.reload()
    expect(page.get_by_label("at rest (tripod)")).to_be_checked()
    expect(field).to_have_value("18.5")
