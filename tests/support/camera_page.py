"""A calibration on the Cameras page, for tests of how it looks."""

from __future__ import annotations

from functools import cache

import cv2
import numpy as np
from browser_support import PAD_FILE
from calibration_shots import LENSES, poses_about, shots
from playwright.sync_api import FilePayload, Page, expect

from padstudio.pad.spec import Pad

SLOW_MS = 180_000


def calibrate_on(page: Page) -> None:
    """Calibrate from nine stills and one without the pad."""
    page.get_by_label("Upload a pad file").set_input_files(PAD_FILE)
    page.get_by_label("Choose files").set_input_files(_stills())
    page.get_by_role("button", name="Calibrate").click()
    expect(page.locator("#result")).to_be_visible(timeout=SLOW_MS)
    residuals = page.locator("[data-ref=residual-picture]")
    expect(residuals).to_have_js_property("naturalWidth", 960, timeout=SLOW_MS)


@cache
def _stills() -> list[FilePayload]:
    camera, pad = LENSES["straight"], Pad.load(PAD_FILE)
    pictures = shots(pad, camera, poses_about(max(pad.size_mm), camera, 9, seed=1))
    pictures.append(np.full_like(pictures[0], 90))
    return [
        FilePayload(
            name=f"IMG_{number:04d}.jpg",
            mimeType="image/jpeg",
            buffer=cv2.imencode(".jpg", picture)[1].tobytes(),
        )
        for number, picture in enumerate(pictures)
    ]
