"""The Experiments page's section of shoot-outs: from the form to the order."""

from __future__ import annotations

from collections.abc import Callable

from browser_support import CAMERA_FILE, PAD_FILE, Complaints
from playwright.sync_api import Page, expect


def test_the_form_becomes_an_order_and_a_refusal_is_shown(
    open_page: Callable[..., Page], complaints: Complaints
) -> None:
    page = open_page("/experiments")
    part = page.locator("#shootout")
    status = part.locator("[data-ref=status]")
    part.get_by_label("Upload a pad file").set_input_files(PAD_FILE)
    expect(status).to_contain_text("Imported the pad")
    part.get_by_label("Upload a camera file").set_input_files(CAMERA_FILE)
    expect(status).to_contain_text("Added the camera")
    part.get_by_label("Flight", exact=True).select_option("edge")
    part.get_by_label("Conditions").select_option("dusk")
    part.get_by_label("Disturbances").fill("rain=1  fog=20")
    for box in part.locator("[name=boards]:enabled").all():
        box.set_checked(box.get_attribute("value") == "charuco")
    complaints.expected.add(422)
    with page.expect_request("**/api/v1/experiments") as asked:
        part.get_by_role("button", name="Start").click()
    order = asked.value.post_data_json
    assert order["pad"]
    assert order["camera"]
    chosen = {name: order[name] for name in ("kind", "flight", "frames", "look", "boards")}
    assert chosen == {
        "kind": "shootout",
        "flight": "edge",
        "frames": 24,
        "look": "dusk",
        "boards": ["charuco"],
    }
    assert order["disturbances"] == ["rain=1", "fog=20"]
    expect(status).to_contain_text("No disturbance 'rain'")
