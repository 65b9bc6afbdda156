"""The first page: what is stored as cards, searched, sorted, renamed, deleted and brought back."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

import httpx
import pytest
from playwright.sync_api import Page, expect
from web_server import running, settings_for, wait_until

NAMES = ("roof 10", "roof 9", "yard")


@pytest.fixture(scope="module")
def studio_url(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Address of a server of this module's own: it counts what is stored."""
    with running(settings_for(tmp_path_factory.mktemp("home"))) as client:
        yield str(client.base_url).rstrip("/")


@pytest.fixture
def pads(studio_url: str) -> Iterator[None]:
    """Three pads, and nothing else."""
    with httpx.Client(base_url=studio_url + "/api/v1", timeout=120) as client:
        for seed, name in enumerate(NAMES):
            spec = {"name": name, "rows": 12, "cols": 12, "ratio": 2, "distance": 1, "seed": seed}
            client.post("/pads", json=spec).raise_for_status()
        yield
        for pad in client.get("/pads").json()["items"]:
            client.delete(f"/pads/{pad['id']}")


def _titles(page: Page) -> list[str]:
    return page.locator("#pads .card-title").all_inner_texts()


def test_an_empty_studio_teaches_and_has_a_sample(open_page: Callable[..., Page]) -> None:
    page = open_page("/")
    expect(page.locator("#welcome")).to_be_visible()
    for kind in ("flights", "pads", "cameras"):
        expect(page.locator(f"#{kind} [data-ref=empty]")).to_be_visible()
    page.get_by_role("button", name="Try a sample flight").click()
    expect(page).to_have_url(re.compile(r"/flights/[0-9a-f]+"))
    expect(page.locator("#head [data-ref=state]")).to_have_text("Done", timeout=120_000)
    page.get_by_role("link", name="Pad Studio").click()
    expect(page.locator("#flights .card")).to_contain_text("sample landing")
    expect(page.locator("#cameras .card")).to_contain_text("drone_stream")
    picture = page.locator("#flights .card-picture")
    expect(picture).to_have_js_property("complete", True)
    assert picture.evaluate("image => image.naturalWidth") > 100
    expect(page.locator("#welcome")).to_be_hidden()


@pytest.mark.usefixtures("pads")
def test_search_and_order_stay_in_the_address(open_page: Callable[..., Page]) -> None:
    page = open_page("/")
    expect(page.locator("#pads .card", has_text="yard")).to_be_visible()
    page.get_by_label("Order").select_option("name")
    expect(page.locator("#pads .card-title").first).not_to_have_text("yard")
    named = [title for title in _titles(page) if title in NAMES]
    assert named == ["roof 9", "roof 10", "yard"]
    page.keyboard.press("/")
    page.keyboard.type("ROOF")
    expect(page.locator("#pads .card")).to_have_count(2)
    expect(page).to_have_url(re.compile("search=ROOF&order=name"))
    page.reload()
    expect(page.locator("#pads .card")).to_have_count(2)
    page.get_by_label("Search").fill("nothing of the kind")
    expect(page.locator("#pads [data-ref=none]")).to_be_visible()


@pytest.mark.usefixtures("pads")
def test_rename(open_page: Callable[..., Page]) -> None:
    page = open_page("/")
    page.get_by_role("button", name="Rename yard").click()
    dialog = page.get_by_role("dialog")
    expect(dialog.get_by_label("Name")).to_have_value("yard")
    dialog.get_by_label("Name").fill(" ")
    dialog.get_by_role("button", name="Rename").click()
    expect(dialog).to_contain_text("Enter a name.")
    dialog.get_by_label("Name").fill("<b>garden</b>")
    dialog.get_by_role("button", name="Rename").click()
    expect(dialog).to_be_hidden()
    expect(page.locator("#pads .card", has_text="<b>garden</b>")).to_have_count(1)


@pytest.mark.usefixtures("pads")
def test_delete_can_be_undone_and_is_done_when_the_page_is_left(
    open_page: Callable[..., Page], studio_url: str
) -> None:
    page = open_page("/")

    def stored() -> set[str]:
        items = httpx.get(f"{studio_url}/api/v1/pads", timeout=60).json()["items"]
        return {item["name"] for item in items} & set(NAMES)

    page.get_by_role("button", name="Delete yard").click()
    expect(page.locator("#undo")).to_contain_text("Deleted “yard”.")
    expect(page.locator("#pads .card", has_text="yard")).to_have_count(0)
    page.get_by_role("button", name="Undo").click()
    expect(page.locator("#pads .card", has_text="yard")).to_have_count(1)
    expect(page.locator("#undo")).to_be_hidden()
    page.get_by_role("button", name="Delete roof 9").click()
    assert stored() == set(NAMES)
    page.goto("/design")
    wait_until(lambda: stored() == {"roof 10", "yard"})
