"""A server that cannot answer while a page loads: it is said, and tried again at a press."""

from __future__ import annotations

from collections.abc import Callable
from urllib.parse import urlsplit

import pytest
from browser_support import Complaints
from playwright.sync_api import Page, Route, expect

AWAY = {"error": {"code": "unavailable", "message": "the server is going down", "detail": {}}}


def _away(page: Page) -> None:
    page.route("**/api/v1/**", lambda route: route.fulfill(status=503, json=AWAY))
    page.reload()


def _tries_again(page: Page) -> None:
    status = page.locator("#status")
    expect(status).to_contain_text("going down")
    page.unroute_all(behavior="ignoreErrors")
    status.get_by_role("button", name="Try again").click()
    expect(page.get_by_role("button", name="Try again")).to_have_count(0)
    expect(status).not_to_contain_text("going down")


@pytest.mark.parametrize(
    "path", ["/", "/design", "/plan", "/diagnose", "/flights", "/cameras", "/live"]
)
def test_what_could_not_be_loaded_is_tried_again(
    open_page: Callable[..., Page], complaints: Complaints, path: str
) -> None:
    complaints.expected = {503}
    page = open_page(path)
    _away(page)
    _tries_again(page)


@pytest.mark.parametrize("late", ["/api/v1/pads", "/api/v1/cameras"])
def test_so_is_whatever_fails_last(
    open_page: Callable[..., Page], complaints: Complaints, late: str
) -> None:
    complaints.expected = {503}
    page = open_page("/design")
    held: list[Route] = []

    def answer(route: Route) -> None:
        if urlsplit(route.request.url).path == late:
            held.append(route)
        else:
            route.fulfill(status=503, json=AWAY)

    page.route("**/api/v1/**", answer)
    page.reload()
    expect(page.locator("#status")).to_contain_text("going down")
    with page.expect_response(lambda response: urlsplit(response.url).path == late):
        held[0].fulfill(status=503, json=AWAY)
    page.evaluate("() => new Promise((done) => setTimeout(done, 50))")
    _tries_again(page)


def test_so_is_a_flight(
    open_page: Callable[..., Page], complaints: Complaints, flight_path: str
) -> None:
    complaints.expected = {503}
    page = open_page(f"{flight_path}?frame=2")
    _away(page)
    expect(page.locator("#status")).to_contain_text("going down")
    page.unroute_all(behavior="ignoreErrors")
    page.locator("#status").get_by_role("button", name="Try again").click()
    expect(page.locator("#frame canvas[data-frame='2']")).to_be_visible()
