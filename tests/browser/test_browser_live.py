"""The Live page with a camera that shows simulated frames."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from urllib.parse import urlsplit

import axe
import fake_camera
import httpx
import pytest
from browser_support import PAD_FILE, Complaints
from camera_server import StartServer
from document_pictures import LIVE, keep_or_compare
from flight_footage import FLIGHT_CAMERA, write_flight
from playwright.sync_api import Browser, Page, Route, expect
from web_server import wait_until

SLOW_MS = 120_000
Opener = Callable[..., Page]


@pytest.fixture(scope="module")
def address(studio_url: str) -> str:
    """The Live page with the pad and the camera chosen."""
    files = {
        "pads/import": ("pad.json", PAD_FILE.read_bytes()),
        "cameras": ("camera.yaml", fake_camera.camera().to_ros_yaml().encode()),
    }
    pad, camera = (
        httpx.post(f"{studio_url}/api/v1/{path}", files={"file": file}, timeout=60).json()["id"]
        for path, file in files.items()
    )
    return f"/live?pad={pad}&camera={camera}"


@pytest.fixture(scope="module")
def seeing(
    launch: Callable[..., Browser], tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Browser]:
    """A browser whose camera is over the pad."""
    video = tmp_path_factory.mktemp("camera") / "pad.mjpeg"
    browser = launch(*fake_camera.flags_for(fake_camera.write_mjpeg(video, [fake_camera.view()])))
    yield browser
    browser.close()


@pytest.fixture
def open_in(studio_url: str, complaints: Complaints) -> Iterator[Opener]:
    """Opens a path in a browser; fails the test on any complaint of the page."""
    contexts = []

    def open_path(browser: Browser, path: str, width: int = 1280) -> Page:
        size = {"width": width, "height": 900}
        context = browser.new_context(base_url=studio_url, viewport=size, locale="en-GB")  # type: ignore[arg-type]
        contexts.append(context)
        page = context.new_page()
        page.set_default_timeout(120_000)
        complaints.watch(page, urlsplit(studio_url).netloc)
        page.goto(path)
        return page

    yield open_path
    for context in contexts:
        context.close()
    for session in httpx.get(f"{studio_url}/api/v1/live", timeout=60).json()["items"]:
        httpx.delete(f"{studio_url}/api/v1/live/{session['id']}", timeout=60)
    assert complaints.faults == []


def start(page: Page, sight: str = "found") -> None:
    page.get_by_role("button", name="Start").click()
    expect(page.locator(f"#view[data-sight={sight}]")).to_be_visible(timeout=SLOW_MS)


def figure(page: Page, name: str) -> float:
    text = page.locator(f"#view [data-ref={name}]").inner_text()
    return float(text.replace("−", "-"))


def test_figures_are_those_of_the_simulated_camera(
    open_in: Opener, seeing: Browser, address: str
) -> None:
    page = open_in(seeing, address)
    start(page)
    truth = fake_camera.POSE
    x, y, z = truth.position_mm
    bound = 0.005 * z
    assert page.locator("#view [data-ref=main-unit]").inner_text() == "m"
    assert 1000 * figure(page, "main") == pytest.approx(z, abs=bound)
    assert figure(page, "x") == pytest.approx(x, abs=bound)
    assert figure(page, "y") == pytest.approx(y, abs=bound)
    assert figure(page, "heading") == pytest.approx(truth.heading_deg, abs=0.3)
    assert figure(page, "tilt") == pytest.approx(truth.tilt_deg, abs=0.3)
    size_px = page.locator("#view [data-ref=main]").evaluate(
        "element => parseFloat(getComputedStyle(element).fontSize)"
    )
    # A twentieth of a metre on a common screen: read from three metres away.
    assert size_px >= 120
    expect(page.locator("#figures [data-ref=verdict]")).to_contain_text("Yes", timeout=SLOW_MS)
    expect(page.locator("#figures")).to_contain_text("Decoded to pose")
    expect(page.locator("#print")).to_contain_text("Contrast, red", timeout=SLOW_MS)
    expect(page.locator("#print")).to_contain_text("lay a ruler")
    (name,) = LIVE
    page.evaluate("() => { document.querySelector('.site-header').style.position = 'static'; }")
    keep_or_compare(name, page.locator("main").screenshot())


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_axe_finds_nothing_while_frames_are_read(
    open_in: Opener, seeing: Browser, address: str, theme: str
) -> None:
    page = open_in(seeing, address)
    page.emulate_media(color_scheme="dark" if theme == "dark" else "light")
    start(page)
    expect(page.locator("#print")).to_contain_text("Contrast, red", timeout=SLOW_MS)
    passed, found = axe.checked(page)
    assert found == []
    assert passed > 10


def test_a_frame_of_the_last_seconds_opens_with_all_stages(
    open_in: Opener, seeing: Browser, address: str
) -> None:
    page = open_in(seeing, address)
    start(page)
    place = page.get_by_label("Last ten seconds")
    expect(place).not_to_have_attribute("max", "0")
    place.focus()
    page.keyboard.press("Home")
    expect(page.locator("#view")).to_have_attribute("data-past", "true")
    expect(page.locator("#strip")).to_contain_text("before the newest")
    page.get_by_role("button", name="Back to live").click()
    expect(page.locator("#view")).to_have_attribute("data-past", "false")
    place.focus()
    page.keyboard.press("Home")
    page.get_by_role("button", name="All stages of this frame").click()
    expect(page).to_have_url(re.compile(r"/diagnose\?.*trace="), timeout=SLOW_MS)
    expect(page.locator("#verdict")).to_contain_text("Pose found")
    expect(page.locator("#workbench .stage-row-blue .tile").last).to_be_visible()


def test_a_reload_goes_on_with_its_own_session(
    open_in: Opener, seeing: Browser, address: str, studio_url: str
) -> None:
    page = open_in(seeing, address)
    start(page)
    expect(page).to_have_url(re.compile("session="))
    asked: list[str] = []
    page.route(
        re.compile(r"/api/v1/live/\w+$"), lambda route: asked.append(page.url) or route.continue_()
    )
    page.reload()
    expect(page.locator("#view[data-sight=found]")).to_be_visible(timeout=SLOW_MS)
    assert asked, "the session was not asked for"
    assert all("session=" in url for url in asked), "a second reload would have lost it"
    listed = httpx.get(f"{studio_url}/api/v1/live", timeout=60).json()["items"]
    assert [item["id"] for item in listed] == re.findall(r"session=(\w+)", page.url)
    page.get_by_role("button", name="Stop", exact=True).click()
    expect(page.get_by_role("button", name="Start")).to_be_visible()
    wait_until(lambda: httpx.get(f"{studio_url}/api/v1/live", timeout=60).json()["total"] == 0)


def test_a_nominal_camera_reads_but_promises_no_heights(
    open_in: Opener, seeing: Browser, address: str
) -> None:
    page = open_in(seeing, address.split("&", maxsplit=1)[0])
    page.get_by_label("Its calibration").select_option("nominal-70")
    expect(page.locator("#camera-choice-note")).to_contain_text("only roughly")
    start(page)
    expect(page.locator("#view [data-ref=nominal]")).to_contain_text("approximate")
    assert 1000 * figure(page, "main") == pytest.approx(fake_camera.POSE.position_mm[2], rel=0.05)


def test_without_the_pad_the_reason_is_shown(
    open_in: Opener, launch: Callable[..., Browser], tmp_path: Path, address: str
) -> None:
    video = fake_camera.write_mjpeg(tmp_path / "empty.mjpeg", [fake_camera.nothing()])
    browser = launch(*fake_camera.flags_for(video))
    page = open_in(browser, address)
    start(page, "lost")
    expect(page.locator("#view [data-ref=badge]")).to_contain_text("Lost: ")
    expect(page.locator("#view [data-ref=reason]")).to_have_text(re.compile(r"\w{3,}.*\."))
    expect(page.locator("#figures [data-ref=verdict]")).to_contain_text("No: ", timeout=SLOW_MS)
    expect(page.locator("#view [data-ref=readout]")).to_be_hidden()
    page.context.close()
    browser.close()


def test_a_camera_that_may_not_be_used_is_told(
    open_in: Opener,
    launch: Callable[..., Browser],
    tmp_path: Path,
    address: str,
    complaints: Complaints,
) -> None:
    video = fake_camera.write_mjpeg(tmp_path / "empty.mjpeg", [fake_camera.nothing()])
    browser = launch(*fake_camera.flags_for(video))
    page = open_in(browser, address)

    def forbid(route: Route) -> None:
        answer = route.fetch()
        headers = {**answer.headers, "permissions-policy": "camera=()"}
        route.fulfill(response=answer, headers=headers)

    # A headless browser has nobody who would refuse; the document's own policy does.
    page.route("**/live?*", forbid)
    page.reload()
    page.get_by_role("button", name="Start").click()
    expect(page.locator("#camera-source")).to_contain_text("Allow it")
    expect(page.get_by_role("button", name="Start")).to_be_enabled()
    # The browser notes what the policy forbade.
    complaints.faults[:] = [each for each in complaints.faults if "not allowed" not in each]
    page.context.close()
    browser.close()


def test_no_camera_at_all_is_told(open_in: Opener, browser: Browser, address: str) -> None:
    page = open_in(browser, address)
    page.get_by_role("button", name="Start").click()
    expect(page.locator("#camera-source [data-ref=advice]")).not_to_be_empty()


def test_what_is_recorded_opens_as_a_flight(open_in: Opener, seeing: Browser, address: str) -> None:
    page = open_in(seeing, address)
    start(page)
    page.get_by_role("button", name="Record", exact=True).click()
    expect(page.locator("#recording")).to_contain_text(re.compile(r"\d+ frames"), timeout=SLOW_MS)
    page.get_by_role("button", name="Stop recording").click()
    expect(page.locator("#recording")).to_contain_text("Recorded", timeout=SLOW_MS)
    page.get_by_role("button", name="Open as flight").click()
    expect(page).to_have_url(re.compile("/flights/"), timeout=SLOW_MS)
    expect(page.locator("#verdict")).to_contain_text("Pose found", timeout=SLOW_MS)


def test_a_stream_is_watched_by_its_address(
    open_in: Opener,
    browser: Browser,
    address: str,
    studio_url: str,
    rtsp_server: StartServer,
    tmp_path: Path,
) -> None:
    camera = {"file": ("camera.yaml", FLIGHT_CAMERA.read_bytes())}
    stored = httpx.post(f"{studio_url}/api/v1/cameras", files=camera, timeout=60).json()["id"]
    server = rtsp_server(write_flight(tmp_path)[0], password="mysecret")
    page = open_in(browser, f"{address.split('&', maxsplit=1)[0]}&camera={stored}&source=stream")
    page.get_by_label("Address", exact=True).fill(server.url_for("mysecret"))
    start(page)
    expect(page.locator("#view canvas[data-frame]")).to_be_visible()
    expect(page.locator("#figures")).to_contain_text("Taken or received to pose")
    assert "mysecret" not in page.url
    assert "mysecret" not in page.evaluate("JSON.stringify(localStorage)")
    page.reload()
    expect(page.locator("#view[data-sight=found]")).to_be_visible(timeout=SLOW_MS)
    assert "mysecret" not in page.content()
