"""What one would take along is copied by a button beside it."""

from __future__ import annotations

import json
import re
from collections.abc import Callable

from browser_support import STILL, set_up_reading
from playwright.sync_api import Page, expect

# A button says for a moment only that it copied: a look now and then may miss it.
RECORD = """() => {
  delete document.body.dataset.copied;
  const note = (changes) => changes.forEach(({ target }) => {
    if (target.textContent === "Copied") document.body.dataset.copied = "";
  });
  new MutationObserver(note).observe(document.body, { childList: true, subtree: true });
}"""


def _copied(page: Page, name: str) -> str:
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    button = page.get_by_role("button", name=name, exact=True)
    page.evaluate(RECORD)
    button.click()
    expect(page.locator("body[data-copied]")).to_have_count(1)
    expect(button).to_be_visible()
    return str(page.evaluate("navigator.clipboard.readText()"))


def test_a_pose_and_the_id_of_its_pad(open_page: Callable[..., Page]) -> None:
    page = open_page("/diagnose")
    set_up_reading(page)
    page.get_by_label("Choose pictures").set_input_files(STILL)
    expect(page.locator("#verdict")).to_contain_text("Pose found")
    pose = json.loads(_copied(page, "Copy pose"))
    assert set(pose) == {"position_mm", "quaternion_xyzw", "heading_deg", "tilt_deg"}
    shown = page.locator("[data-ref=pose-facts] dd").nth(2).inner_text()
    assert shown.startswith(f"{pose['position_mm'][2]:.2f}")
    assert re.fullmatch("[0-9A-Z]{8}", _copied(page, "Copy pad's printed id"))


def test_the_ids_of_a_flight_and_its_frame_s_pose(
    open_page: Callable[..., Page], flight_path: str
) -> None:
    page = open_page(flight_path)
    expect(page.locator("#verdict")).to_contain_text("Pose found")
    assert _copied(page, "Copy flight's id") == flight_path.split("/")[-1]
    assert re.fullmatch("[0-9a-f]{16}", _copied(page, "Copy pad's id"))
    assert "position_mm" in _copied(page, "Copy pose")


def test_a_stored_pad_and_the_link_to_a_page(open_page: Callable[..., Page]) -> None:
    page = open_page("/design?rows=25&cols=25&ratio=5&name=copied&seed=3")
    expect(page.locator("#pad-facts")).to_contain_text("25 × 25")
    expect(page.get_by_role("button", name="Copy pad's id")).to_have_count(0)
    page.get_by_role("button", name="Save pad").click()
    stored = _copied(page, "Copy pad's id")
    assert page.request.get(f"/api/v1/pads/{stored}").json()["name"] == "copied"
    link = _copied(page, "Copy link")
    assert link == page.url
