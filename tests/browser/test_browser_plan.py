"""The Plan page: coverage, advice, simulated pictures and what Diagnose makes of them."""

from __future__ import annotations

import re
import zipfile
from collections.abc import Callable

import pytest
from browser_support import CAMERA_FILE, PAD_FILE, Complaints, choose
from playwright.sync_api import Page, Route, expect

from padstudio.pad.coverage.pinhole import View
from padstudio.pad.coverage.spans import METHOD_LIMITS, cells_needed


@pytest.fixture
def plan(open_page: Callable[..., Page]) -> Page:
    """The page with the footage's pad and camera chosen."""
    page = open_page("/plan")
    page.get_by_label("Upload a pad file").set_input_files(PAD_FILE)
    expect(page.locator("#status")).to_contain_text("Imported the pad")
    page.get_by_label("Upload a camera file").set_input_files(CAMERA_FILE)
    expect(page.locator("#status")).to_contain_text("Added the camera")
    expect(page.locator("#chart")).to_be_visible()
    return page


def _expect_drawn(plan: Page, name: str, count: int | None = None) -> None:
    """Wait until the chart has so many lines or areas of a name; None: any."""
    plan.wait_for_function(
        """([name, count]) => {
          const drawn = document.querySelector("#chart .plot").data
            ?.filter(trace => trace.name === name).length;
          return count === null ? drawn > 0 : drawn === count;
        }""",
        arg=[name, count],
    )


def _points(plan: Page, name: str, colour: str) -> int:
    """Points of a name on the chart, in a colour of the page."""
    return int(
        plan.evaluate(
            """([name, colour]) => {
              const probe = document.body.appendChild(document.createElement("span"));
              probe.style.color = `var(--${colour})`;
              const { data } = document.querySelector("#chart .plot");
              const { marker } = data.find(trace => trace.name === name);
              const wanted = getComputedStyle(probe).color;
              probe.remove();
              return marker.color.filter(each => each === wanted).length;
            }""",
            [name, colour],
        )
    )


def test_the_chart_shows_layers_methods_and_the_dead_band(plan: Page) -> None:
    # Two layers and the whole sign.
    _expect_drawn(plan, "area", 3)
    _expect_drawn(plan, "outline", 3)
    _expect_drawn(plan, "dead band", 0)
    # So many cells of 10 mm across 765 px at f = 943 px.
    view = View(width_px=1360, height_px=765, focal_px=943.0)
    low = cells_needed(5, 2, (125, 125), view, METHOD_LIMITS["dense"]) * 10 * 943 / 765
    shown = re.compile(rf"Red layer\s*{low:.1f} mm")
    expect(plan.locator("#chart-facts")).to_contain_text(shown)
    expect(plan.locator("#chart-facts")).to_contain_text("Whole sign")
    choose(plan, "Paper")
    _expect_drawn(plan, "dead band")
    expect(plan.locator("#dead-band")).to_contain_text("no layer reads")
    expect(plan.locator("#chart-note")).to_contain_text("fades")
    expect(plan).to_have_url(re.compile("method=paper"))
    plan.reload()
    _expect_drawn(plan, "dead band")


def test_the_chart_is_read_under_the_pointer(plan: Page) -> None:
    box = plan.locator("#chart .plot").bounding_box()
    assert box
    readout = plan.locator("#chart [data-ref=readout]")
    plan.mouse.move(box["x"] + 70, box["y"] + 0.5 * box["height"])
    expect(readout).to_contain_text(re.compile("tilt [01]°: (red|blue)"))
    plan.mouse.move(box["x"] + 70, box["y"] + box["height"] - 45)
    expect(readout).to_contain_text("nothing reads")


def test_arrow_keys_move_the_place_and_enter_takes_the_picture(plan: Page) -> None:
    plan.locator("#chart .plot").focus()
    plan.keyboard.press("ArrowRight")
    plan.keyboard.press("ArrowDown")
    expect(plan.get_by_label("Tilt", exact=True)).to_have_value("12.5")
    expect(plan.get_by_label("Height", exact=True)).to_have_value("909")
    expect(plan.locator("#film")).to_be_hidden()
    plan.keyboard.press("Enter")
    expect(plan.get_by_alt_text("Simulated picture from 909 mm, 13°")).to_be_visible()


def test_advice_becomes_a_pad_on_the_design_page(plan: Page) -> None:
    facts = plan.locator("#advice-facts")
    expect(facts).to_contain_text("Reads")
    plan.get_by_label("Highest").fill("50")
    expect(plan.locator("#wish-high_mm-error")).to_contain_text("more than the lowest")
    plan.get_by_label("Highest").fill("900")
    plan.get_by_label("Off the centre").fill("0")
    expect(facts).to_have_attribute("aria-busy", "false")
    expect(facts).to_contain_text("one layer")
    cells = re.search(r"(\d+) × \d+, ([\d.]+) mm", facts.inner_text())
    assert cells
    plan.get_by_role("link", name="Design this pad").click()
    expect(plan).to_have_url(re.compile("/design"))
    expect(plan.get_by_label("Rows", exact=True)).to_have_value(cells[1])
    expect(plan.get_by_label("Red cell")).to_have_value(cells[2])
    expect(plan.get_by_label("Blue : red")).to_have_value("1")


def test_a_click_on_the_chart_takes_a_picture_that_diagnose_reads(plan: Page) -> None:
    plan.locator("#chart .plot").click(position={"x": 150, "y": 170})
    expect(plan.get_by_alt_text(re.compile("Simulated picture from"))).to_be_visible()
    height = plan.get_by_label("Height", exact=True).input_value()
    truth = plan.locator("#film [data-ref=truth]")
    expect(truth).to_contain_text(f"{float(height):.1f} mm")
    plan.get_by_role("link", name="Read in Diagnose").click()
    expect(plan.locator("#verdict")).to_contain_text("Pose found")
    z = plan.locator("[data-ref=pose-facts] dd").nth(2).inner_text()
    assert float(z.split()[0].replace("\u202f", "")) == pytest.approx(float(height), rel=0.02)


def test_a_short_descent_is_a_strip_of_pictures(plan: Page) -> None:
    plan.get_by_label("Pictures", exact=True).select_option("descent")
    plan.get_by_label("How many").fill("3")
    plan.get_by_label("Height", exact=True).fill("900")
    plan.get_by_label("Down to").fill("100")
    plan.wait_for_function(
        """() => document.querySelector("#chart .plot").data?.at(-1).x.length === 3"""
    )
    plan.get_by_role("button", name="Take the pictures").click()
    shots = plan.locator("#film .shot")
    expect(shots.locator("img")).to_have_count(3)
    assert [text.split(",")[0] for text in shots.all_inner_texts()] == [
        "900 mm",
        "300 mm",
        "100 mm",
    ]
    shots.nth(2).click()
    expect(plan.locator("#film [data-ref=truth]")).to_contain_text("100.0 mm")
    expect(plan).to_have_url(re.compile("kind=descent"))


def test_a_map_fills_row_by_row(plan: Page) -> None:
    asked: list[float] = []

    def answer(route: Route) -> None:
        # What a detector makes of the frames is the server's tests' matter.
        wish = route.request.post_data_json
        asked.extend(wish["heights_mm"])
        reads = float(wish["heights_mm"][0] < 1000)
        row = [[reads] * len(wish["values"])]
        none = [[0.0] * len(wish["values"])]
        body = {key: wish[key] for key in ("axis", "heights_mm", "values", "trials")}
        route.fulfill(json=body | {"success": row, "wrong": none})

    plan.route("**/pads/*/coverage", answer)
    plan.get_by_text("Check it with simulated pictures").click()
    plan.get_by_label("Heights", exact=True).fill("3")
    plan.get_by_role("button", name="Simulate").click()
    rows = plan.locator("#map tbody tr")
    expect(rows).to_have_count(3)
    expect(plan.locator("#map-stop")).to_be_hidden()
    assert asked == sorted(asked, reverse=True)
    shares = ["100 %" if height < 1000 else "0 %" for height in asked]
    assert rows.locator("td:nth-child(2)").all_inner_texts() == shares
    plan.wait_for_function(
        """() => document.querySelector("#chart .plot").data?.at(-2).x.length === 15"""
    )
    assert _points(plan, "simulated", "bad") == 5 * shares.count("0 %")
    assert _points(plan, "simulated", "ok") == 5 * shares.count("100 %")


def test_a_whole_flight_goes_straight_into_an_analysis(plan: Page) -> None:
    form = plan.locator("#fly-form")
    form.get_by_label("Frames", exact=True).fill("0")
    expect(form).to_contain_text("from 1 to 600, whole")
    form.get_by_label("Frames", exact=True).fill("3")
    form.get_by_label("Starts at").fill("900")
    form.get_by_label("Ends at").fill("500")
    form.get_by_role("button", name="Fly and analyse").click()
    expect(form.get_by_role("status")).to_have_text("3 frames are done.")
    expect(plan).to_have_url(re.compile("fly-frames=3&fly-from_mm=900"))
    with plan.expect_download() as download:
        form.get_by_role("link", name="Download with truth").click()
    with zipfile.ZipFile(download.value.path()) as pack:
        # A camera of 1360 x 765 makes no video, whose size must be even.
        assert {"stills/landing_2.jpg", "stills/truth.json"} <= set(pack.namelist())
    form.get_by_role("link", name="Open the flight").click()
    expect(plan.get_by_role("heading", level=1)).to_contain_text("simulated landing, clear")
    expect(plan.locator("main")).to_contain_text(re.compile("3 of 3|3 frames"))


def test_a_flight_is_stopped_or_refused_in_words(plan: Page, complaints: Complaints) -> None:
    form = plan.locator("#fly-form")
    form.get_by_label("Flight", exact=True).select_option("gusty")
    form.get_by_label("Frames", exact=True).fill("400")
    form.get_by_role("button", name="Fly and analyse").click()
    form.get_by_role("button", name="Stop").click()
    expect(form.get_by_role("status")).to_have_text("Stopped.")
    form.get_by_label("Flight", exact=True).select_option("tilts")
    expect(form.get_by_label("Ends at")).to_be_hidden()
    complaints.expected = {413}
    error = {"code": "too_many_frames", "message": "at most 50 frames at once", "detail": {}}
    plan.route("**/simulations", lambda route: route.fulfill(status=413, json={"error": error}))
    form.get_by_role("button", name="Fly and analyse").click()
    expect(plan.locator("#status")).to_have_text("At most 50 frames at once.")


def test_what_cannot_be_is_marked_or_explained(plan: Page, complaints: Complaints) -> None:
    complaints.expected = {422}
    plan.get_by_label("Tilt", exact=True).fill("95")
    expect(plan.locator("#frame-tilt_deg-error")).to_contain_text("from 0 to 89")
    plan.get_by_role("button", name="Take the picture").click()
    expect(plan.get_by_label("Tilt", exact=True)).to_be_focused()
    plan.get_by_label("Tilt", exact=True).fill("10")
    error = {"code": "camera_sees_no_ground", "message": "the camera sees no ground", "detail": {}}
    plan.route("**/simulate", lambda route: route.fulfill(status=422, json={"error": error}))
    plan.get_by_role("button", name="Take the picture").click()
    expect(plan.locator("#status")).to_have_text("The camera sees no ground.")


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_a_phone_shows_it_without_scrolling_sideways(
    open_page: Callable[..., Page], theme: str
) -> None:
    for path in ("/design?rows=20&cols=20&ratio=2", "/plan"):
        page = open_page(path, width=390, height=844, theme=theme)
        expect(page.locator(".panel").first).to_be_visible()
        assert page.evaluate("document.documentElement.scrollWidth") <= 390
