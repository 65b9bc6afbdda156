"""Flights: upload, progress, frames, figures, exports, other runs, as a user does it."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

from browser_support import PAD_FILE, Complaints, choose
from flight_footage import BLANK, FLIGHT_CAMERA, FRAMES
from playwright.sync_api import Page, Route, expect

CHARTS = ("trajectory", "space", "outcomes", "stages", "heights")
# A worker process starts, on a machine that tests keep busy.
SLOW_MS = 120_000


def _set_up(page: Page) -> None:
    page.get_by_label("Upload a pad file").set_input_files(PAD_FILE)
    expect(page.locator("#status")).to_contain_text("Imported the pad")
    page.get_by_label("Upload a camera file").set_input_files(FLIGHT_CAMERA)
    expect(page.locator("#status")).to_contain_text("Added the camera")


def _at_frame(page: Page, number: int) -> None:
    expect(page.locator("#report [data-ref=source]")).to_contain_text(f"Frame {number} ·")
    expect(page).to_have_url(re.compile(rf"frame={number}\b"))


def test_a_flight_from_its_files_to_its_export(
    open_page: Callable[..., Page], footage: tuple[Path, Path], tmp_path: Path
) -> None:
    page = open_page("/")
    page.get_by_role("link", name="Flights", exact=True).click()
    expect(page.get_by_role("button", name="Analyse")).to_be_disabled()
    _set_up(page)
    page.get_by_label("Name").fill("evening landing")
    page.get_by_label("Choose files").set_input_files(footage)
    page.get_by_role("button", name=re.compile("Analyse")).click()
    expect(page).to_have_url(re.compile("/flights/[0-9a-f]+"))
    expect(page.get_by_role("heading", level=1)).to_have_text("evening landing")
    expect(page.locator("#head [data-ref=state]")).to_have_text("Done", timeout=SLOW_MS)
    ok = FRAMES - len(BLANK)
    expect(page.locator("#summary")).to_contain_text(f"{ok} of {FRAMES}")
    expect(page.locator("#summary")).to_contain_text("3 frames")
    with page.expect_download() as download:
        page.locator("#downloads").get_by_role("link", name="CSV").click()
    download.value.save_as(tmp_path / "poses.csv")
    rows = (tmp_path / "poses.csv").read_text().splitlines()
    assert sum(not row.startswith("#") for row in rows) >= ok + 1
    page.get_by_role("link", name="Flights", exact=True).first.click()
    listed = page.locator("#flights li", has_text="evening landing")
    expect(listed).to_contain_text("Done")
    expect(listed).to_contain_text("83 % with a pose")


def test_frame_by_frame(open_page: Callable[..., Page], flight_path: str) -> None:
    page = open_page(flight_path)
    _at_frame(page, 0)
    expect(page.locator("#verdict")).to_contain_text("Pose found")
    for key, frame in (("ArrowRight", 1), ("n", 7), ("n", 8), ("ArrowLeft", 7), ("End", 7)):
        page.keyboard.press(key)
        _at_frame(page, frame)
    expect(page.locator("#verdict")).to_contain_text("No pose")
    expect(page.locator("[data-ref=failure-list]")).to_contain_text(re.compile(r"\d"))
    page.keyboard.press("p")
    expect(page.locator("#status")).to_contain_text("No earlier frame")
    track = page.get_by_role("slider", name="Frame")
    track.focus()
    page.keyboard.press("End")
    _at_frame(page, FRAMES - 1)
    page.keyboard.press("p")
    _at_frame(page, 15)
    box = track.bounding_box()
    assert box
    track.click(position={"x": box["width"] * 3.5 / FRAMES, "y": 20})
    _at_frame(page, 3)
    page.get_by_label("Frame", exact=True).last.fill("20")
    page.keyboard.press("Enter")
    _at_frame(page, 20)


def test_every_stage_of_a_frame_and_a_reload(
    open_page: Callable[..., Page], flight_path: str
) -> None:
    page = open_page(f"{flight_path}?frame=2")
    expect(page.locator("#frame canvas[data-frame='2']")).to_be_visible()
    title = page.locator(".bench-name [data-ref=title]")
    page.get_by_role("button", name="Stages", exact=True).click(timeout=SLOW_MS)
    expect(title).to_have_text("Pose")
    page.get_by_role("button", name="Look at Edges, blue").click()
    expect(title).to_have_text("Edges, blue")
    page.locator("#workbench [data-ref=focus]").focus()
    page.keyboard.press("+")
    expect(page).to_have_url(re.compile("frame=2.*view=blue-edges.*at="))
    page.reload()
    expect(title).to_have_text("Edges, blue", timeout=SLOW_MS)
    _at_frame(page, 2)
    expect(page.locator("#workbench .tile[data-view='blue/decode']")).to_be_visible()
    # Another frame comes to the same view.
    page.locator("h1").click()
    page.keyboard.press("ArrowRight")
    _at_frame(page, 3)
    expect(title).to_have_text("Edges, blue")
    expect(page).to_have_url(re.compile("frame=3.*view=blue-edges.*at="))


def test_a_parameter_reads_a_frame_otherwise(
    open_page: Callable[..., Page], flight_path: str
) -> None:
    """The report tells what the settings give; the flight's own result comes back with them."""
    page = open_page(f"{flight_path}?frame=2")
    verdict = page.locator("#verdict")
    expect(verdict).to_contain_text("Pose found")
    row = page.locator(".param[data-name='search.least_edges']")
    for stage in ("edges", "outline"):
        page.locator(f".params-stage[data-stage={stage}] summary").click(timeout=SLOW_MS)
    row.locator("[data-ref=number]").fill("90000")
    row.locator("[data-ref=number]").press("Enter")
    outline = page.locator(".param[data-name='outline.largest_px'] [data-ref=number]")
    outline.fill("32")
    outline.press("Enter")
    expect(verdict).to_contain_text("No pose")
    expect(page.locator("#workbench [data-ref=changed-count]")).to_have_text("2 changed")
    # They stay while frames go by.
    page.locator("h1").click()
    page.keyboard.press("ArrowRight")
    expect(verdict).to_contain_text("No pose")
    page.get_by_role("button", name="Reset all").click()
    expect(verdict).to_contain_text("Pose found")


def test_an_address_beyond_the_flight_shows_its_last_frame(
    open_page: Callable[..., Page], flight_path: str
) -> None:
    page = open_page(f"{flight_path}?frame=5000")
    _at_frame(page, FRAMES - 1)
    expect(page.locator("#report [data-ref=source]")).to_contain_text(f"Frame {FRAMES - 1}")


def test_the_figures_show_what_was_flown(open_page: Callable[..., Page], flight_path: str) -> None:
    page = open_page(flight_path)
    page.locator("#charts").scroll_into_view_if_needed()
    for name in CHARTS:
        expect(page.locator(f"[data-ref={name}] .main-svg").first).to_be_attached(timeout=SLOW_MS)
    expect(page.locator("[data-ref=space-note]")).to_contain_text("missing: no pose")
    expect(page.locator("[data-ref=heights-note]")).to_contain_text("Slope 1.08")
    drawn = page.locator("[data-ref=trajectory]").evaluate("chart => chart.data[0].y")
    assert [frame for frame, height in enumerate(drawn) if height is None] == sorted(BLANK)
    heights = [height for height in drawn if height is not None]
    assert heights == sorted(heights, reverse=True)
    assert page.locator("[data-ref=space] canvas").count() > 0
    choose(page, "Dark")
    font = "chart => chart.layout.font.color"
    ink = page.locator("#charts p").first.evaluate("() => getComputedStyle(document.body).color")
    assert page.locator("[data-ref=trajectory]").evaluate(font) != ink
    expect(page.locator("[data-ref=space] .main-svg").first).to_be_attached()


def test_frames_are_read_before_the_charts_have_loaded(
    open_page: Callable[..., Page], flight_path: str
) -> None:
    page = open_page("/flights")
    page.route("**/plotly.min.js", lambda route: None)
    page.goto(f"{flight_path}?frame=12")
    _at_frame(page, 12)
    page.get_by_role("slider", name="Frame").focus()
    page.keyboard.press("ArrowRight")
    _at_frame(page, 13)
    page.get_by_role("slider", name="Frame").click(position={"x": 1, "y": 20})
    _at_frame(page, 0)
    assert page.evaluate("() => typeof Plotly") == "undefined"
    page.unroute_all(behavior="ignoreErrors")


def test_the_timeline_shows_heights_and_outcomes(
    open_page: Callable[..., Page], flight_path: str
) -> None:
    page = open_page(f"{flight_path}?frame=12")
    timeline = page.locator("#timeline .plot")
    expect(timeline.locator(".heatmaplayer image").first).to_be_attached(timeout=SLOW_MS)
    red, blue, heights = timeline.evaluate("chart => chart.data")
    # Places of what a channel's cell may be; from the fourth on it has failed.
    for strip in (red, blue):
        failed = [frame for frame, kind in enumerate(strip["z"][-1]) if kind >= 4]
        assert failed == sorted(BLANK)
    legend = page.locator("#timeline [data-ref=legend]")
    expect(legend).to_contain_text("read, by channel")
    expect(legend.locator("[data-kind=file]")).to_be_hidden()
    assert max(z for z in heights["y"] if z is not None) > 0


def test_the_timeline_zooms_and_keeps_its_part(
    open_page: Callable[..., Page], flight_path: str
) -> None:
    page = open_page(f"{flight_path}?frame=12")
    _at_frame(page, 12)
    page.get_by_role("slider", name="Frame").focus()
    page.keyboard.press("+")
    expect(page).to_have_url(re.compile(r"part=\d+-\d+"))
    page.reload()
    page.get_by_role("button", name="Whole flight").click()
    expect(page).not_to_have_url(re.compile("part="))
    page.get_by_role("button", name="Play").click()
    played = re.compile(r"Frame (1[4-9]|2\d) ·")
    expect(page.locator("#report [data-ref=source]")).to_contain_text(played)
    expect(page.get_by_role("button", name="Play")).to_be_visible(timeout=SLOW_MS)
    _at_frame(page, FRAMES - 1)


def test_another_run_beside_the_first(open_page: Callable[..., Page], flight_path: str) -> None:
    page = open_page(flight_path)
    page.get_by_role("button", name="Run again …").click()
    dialog = page.get_by_role("dialog")
    expect(dialog.locator("[data-ref=params-note]")).to_have_text("None is changed.")
    dialog.get_by_label("Last frame").fill("11")
    dialog.get_by_label("Every n-th").fill("2")
    dialog.get_by_role("button", name="Run", exact=True).click()
    expect(page).to_have_url(re.compile(r"with="))
    assert flight_path not in page.url
    expect(page.locator("#head [data-ref=state]")).to_have_text("Done", timeout=SLOW_MS)
    expect(page.locator("#settings")).to_contain_text("0 to 11, every 2nd")
    runs = page.locator("#runs li")
    expect(runs.first).to_contain_text("Frames: all / 0 to 11, every 2nd")
    page.keyboard.press("ArrowRight")
    _at_frame(page, 2)
    page.get_by_role("button", name="Compare with").first.click()
    expect(page).not_to_have_url(re.compile("with="))


def test_a_dialog_is_whole_before_it_can_be_clicked(
    open_page: Callable[..., Page], flight_path: str
) -> None:
    page = open_page(flight_path)

    def late(route: Route) -> None:
        page.wait_for_timeout(500)
        route.continue_()

    page.route("**/api/v1/pads?*", late)
    page.route("**/api/v1/pads", late)
    page.get_by_role("button", name="Run again …").click()
    dialog = page.get_by_role("dialog")
    expect(dialog).to_be_visible()
    assert "window 5 × 5" in (dialog.locator("#rerun-pad [data-ref=note]").text_content() or "")


def test_failed_frames_are_run_again_with_what_the_workbench_has(
    open_page: Callable[..., Page], flight_path: str
) -> None:
    page = open_page(f"{flight_path}?frame={min(BLANK)}")
    stage = page.locator(".params-stage[data-stage=edges]")
    # By then the stage that is looked at has opened its parameters.
    expect(page.locator("#workbench .tile").first).to_be_visible(timeout=SLOW_MS)
    if stage.get_attribute("open") is None:
        stage.locator("summary").click()
    number = page.locator(".param[data-name='search.least_step'] [data-ref=number]")
    number.fill("0.4")
    number.press("Enter")
    expect(page.locator("#workbench [data-ref=changed-count]")).to_have_text("1 changed")
    page.get_by_role("button", name="Run again with these").click()
    dialog = page.get_by_role("dialog")
    expect(dialog.get_by_role("radio", name="From the workbench")).to_be_checked()
    expect(dialog.locator("[data-ref=params-note]")).to_have_text("search.least_step = 0.4")
    choose(dialog, "Only failed ones")
    dialog.get_by_role("button", name="Run", exact=True).click()
    expect(page).to_have_url(re.compile(r"with="))
    expect(page.locator("#head [data-ref=state]")).to_have_text("Done", timeout=SLOW_MS)
    expect(page.locator("#settings")).to_contain_text("of these only failed ones")
    expect(page.locator("#settings")).to_contain_text("search.least_step = 0.4")
    expect(page.locator("#summary")).to_contain_text(f"of {len(BLANK)}")
    # The workbench begins with what the run was read with.
    expect(page.locator("#workbench [data-ref=changed-count]")).to_have_text("1 changed")
    other = next(n for n in range(FRAMES) if n not in BLANK)
    page.goto(f"{page.url.split('?')[0]}?frame={other}")
    expect(page.locator(f"#frame canvas[data-frame='{other}']")).to_be_visible()
    expect(page.locator("#report")).to_contain_text("no other frames")


def test_two_runs_are_compared_frame_by_frame(
    open_page: Callable[..., Page], flight_path: str
) -> None:
    page = open_page(flight_path)
    flights = page.url.split("/flights/")[0] + "/api/v1/flights"
    # With so many edges asked for, frames are lost against the first run.
    first = flight_path.split("/")[-1]
    changes = {"params": {"search": {"least_edges": 90_000}}, "end_frame": 20}
    second = page.request.post(f"{flights}/{first}/rerun", data=changes).json()["id"]
    page.goto(f"/flights/{second}?with={first}&frame=0")
    expect(page.locator("#head [data-ref=state]")).to_have_text("Done", timeout=SLOW_MS)
    panel = page.locator("#compared")
    blank = sum(frame < 20 for frame in BLANK)
    expect(panel.locator("[data-ref=words]")).to_contain_text("Of 20 frames that both runs read")
    lost = page.request.get(f"{flights}/{second}/comparison/{first}/frames?kind=lost").json()
    frames = [item["frame"] for item in lost["items"]]
    assert 0 < len(frames) <= 20 - blank
    expect(panel.locator("[data-ref=words]")).to_contain_text(f"loses {len(frames)};")
    expect(panel.locator("[data-ref=strip] .main-svg").first).to_be_attached(timeout=SLOW_MS)
    panel.get_by_label("Frames", exact=True).select_option("lost")
    expect(panel.locator("tbody tr")).to_have_count(len(frames))
    page.locator("h1").click()
    page.keyboard.press("c")
    wanted = next(frame for frame in frames if frame > 0)
    _at_frame(page, wanted)
    expect(panel.locator("[data-ref=pair-words]")).to_contain_text(f"Frame {wanted}, lost")
    expect(panel.locator("[data-ref=other-result]")).to_contain_text("high")
    panel.locator("tbody tr").last.get_by_role("button").click()
    _at_frame(page, frames[-1])
    page.locator("h1").click()
    page.keyboard.press("c")
    expect(panel.get_by_role("alert")).to_have_text("No later frame changed so.")


def test_a_sweep_says_which_value_reads_more(
    open_page: Callable[..., Page], flight_path: str
) -> None:
    page = open_page(flight_path)
    panel = page.locator("#sweep")
    panel.locator("summary").click(timeout=SLOW_MS)
    panel.get_by_label("Parameter").select_option("search.least_edges")
    panel.get_by_label("From").fill("9")
    panel.get_by_role("button", name="Sweep").click()
    expect(panel.get_by_role("alert")).to_contain_text("From 16")
    panel.get_by_label("From").fill("100")
    page.reload()
    panel.locator("summary").click(timeout=SLOW_MS)
    expect(panel.get_by_label("Parameter")).to_have_value("search.least_edges")
    expect(panel.get_by_label("From")).to_have_value("100")
    panel.get_by_label("To", exact=True).fill("99000")
    panel.get_by_label("Values").fill("2")
    panel.get_by_label("Failing frames").fill("2")
    panel.get_by_label("With a pose").fill("3")
    panel.get_by_role("button", name="Sweep").click()
    expect(panel.get_by_role("status")).to_contain_text(
        "No value wins more frames than it loses", timeout=SLOW_MS
    )
    expect(panel.locator("[data-ref=chart] .main-svg").first).to_be_attached(timeout=SLOW_MS)
    rows = panel.locator("tbody tr")
    # Blank frames stay blank; with so many edges asked for, the others may be lost.
    assert [cell.inner_text() for cell in rows.locator("[data-ref=won]").all()] == ["0", "0"]
    rows.last.get_by_role("button", name="Take 99000").click()
    expect(page.locator("#workbench [data-ref=changed-count]")).to_have_text("1 changed")
    expect(page).to_have_url(re.compile(r"set=search.least_edges%3A99000"))
    page.reload()
    expect(rows).to_have_count(2, timeout=SLOW_MS)
    expect(panel.get_by_label("Parameter")).to_have_value("search.least_edges")
    expect(panel.get_by_label("To", exact=True)).to_have_value("99000")


def test_what_is_typed_for_a_new_flight_outlives_a_reload(open_page: Callable[..., Page]) -> None:
    page = open_page("/flights")
    page.get_by_label("Name", exact=True).fill("evening")
    page.get_by_label("First frame").fill("3")
    page.get_by_label("Every n-th").fill("2")
    choose(page, "Smoothed")
    expect(page).to_have_url(re.compile("fusion=smooth.*name=evening"))
    page.reload()
    expect(page.get_by_label("Name", exact=True)).to_have_value("evening")
    expect(page.get_by_label("First frame")).to_have_value("3")
    expect(page.get_by_label("Every n-th")).to_have_value("2")
    expect(page.get_by_role("radio", name="Smoothed")).to_be_checked()


def test_a_second_run_in_the_list_leads_to_the_comparison(
    open_page: Callable[..., Page], flight_path: str
) -> None:
    page = open_page("/flights")
    first = flight_path.split("/")[-1]
    again = page.request.post(f"/api/v1/flights/{first}/rerun", data={"stride": 4}).json()["id"]
    page.reload()
    row = page.locator("#flights li").filter(has=page.locator(f"[href='/flights/{again}']"))
    row.get_by_role("link", name="Compare with the run before").click(timeout=SLOW_MS)
    expect(page.locator("#compared")).to_contain_text("that both runs read", timeout=SLOW_MS)
    expect(page).to_have_url(re.compile(f"/flights/{again}.*with={first}"))
    assert page.request.delete(f"/api/v1/flights/{again}").ok


def test_of_several_pads_one_s_poses_are_exported(
    open_page: Callable[..., Page], flight_path: str
) -> None:
    page = open_page(flight_path)
    expect(page.locator("#downloads")).to_be_visible(timeout=SLOW_MS)
    expect(page.get_by_label("Poses of", exact=True)).to_be_hidden()
    api = page.url.split("/flights/")[0] + "/api/v1"
    request = page.request.get(f"{api}{flight_path}").json()["request"]
    spec = {"name": "beside", "rows": 12, "cols": 12, "cell_mm": 20, "ratio": 1, "seed": 5}
    beside = page.request.post(f"{api}/pads", data=spec).json()["id"]
    order = {"pad": [request["pad_id"], beside], "stride": 4}
    again = page.request.post(f"{api}{flight_path}/rerun", data=order).json()["id"]
    page.goto(f"/flights/{again}")
    chooser = page.get_by_label("Poses of", exact=True)
    chooser.select_option("beside", timeout=SLOW_MS)
    link = page.locator("#downloads").get_by_role("link", name="TUM")
    expect(link).to_have_attribute("href", re.compile(r"/export/tum\?pad_id=[0-9A-Z]{8}$"))
    chooser.select_option("all pads")
    expect(link).to_have_attribute("href", re.compile("/export/tum$"))


# Runs of a flight that keep the workers busy for some seconds.
_BEFORE = 20


def test_a_flight_is_stopped_and_taken_up_again(
    open_page: Callable[..., Page], flight_path: str
) -> None:
    page = open_page(flight_path)
    # Others wait before it, so that it cannot be done before it is stopped.
    flights = page.url.split("/flights/")[0] + "/api/v1/flights"
    begin = f"{flights}/{flight_path.split('/')[-1]}/rerun"
    others = [page.request.post(begin, data={}).json()["id"] for _ in range(_BEFORE)]
    page.get_by_role("button", name="Run again …").click()
    page.get_by_role("dialog").get_by_role("button", name="Run", exact=True).click()
    expect(page).to_have_url(re.compile(r"with="))
    page.get_by_role("button", name="Cancel").click()
    state = page.locator("#head [data-ref=state]")
    expect(state).to_have_text("Cancelled")
    for other in others:
        page.request.post(f"{flights}/{other}/cancel")
        assert page.request.delete(f"{flights}/{other}").ok
    page.get_by_role("button", name="Try again").click()
    expect(state).to_have_text("Done", timeout=SLOW_MS)
    expect(page.locator("#summary")).to_contain_text(f"{FRAMES - len(BLANK)} of {FRAMES}")


def test_a_flight_that_is_not_there(open_page: Callable[..., Page], complaints: Complaints) -> None:
    complaints.expected = {404}
    page = open_page("/flights/0123456789abcdef")
    expect(page.locator("#status")).to_contain_text("no flight of that id")
    expect(page.locator("#charts")).to_be_hidden()
    expect(page.locator("#downloads")).to_be_hidden()


def test_progress_is_asked_for_where_events_do_not_come(
    open_page: Callable[..., Page], complaints: Complaints, flight_path: str
) -> None:
    complaints.expected = {503}
    page = open_page(flight_path)
    page.context.route("**/events", lambda route: route.fulfill(status=503))
    page.get_by_role("button", name="Run again …").click()
    page.get_by_role("dialog").get_by_label("Last frame").fill("3")
    page.get_by_role("dialog").get_by_role("button", name="Run", exact=True).click()
    expect(page).to_have_url(re.compile(r"with="))
    expect(page.locator("#head [data-ref=state]")).to_have_text("Done", timeout=SLOW_MS)
    expect(page.locator("#summary")).to_contain_text("4 of 4")


def test_the_table_of_frames_is_narrowed_and_leads_to_frames(
    open_page: Callable[..., Page], flight_path: str
) -> None:
    page = open_page(flight_path)
    table = page.locator("#frames")
    table.get_by_role("heading", name="Frames").click()
    rows = table.locator("tbody tr")
    expect(rows).to_have_count(FRAMES)
    table.get_by_label("Outcome").select_option("failed")
    expect(rows).to_have_count(len(BLANK))
    expect(page).to_have_url(re.compile("frames=status%3Dfailed"))
    table.get_by_role("button", name="8", exact=True).press("Enter")
    _at_frame(page, 8)
    page.keyboard.press("ArrowDown")
    _at_frame(page, 9)
    expect(table.locator("tr[data-current=true]")).to_have_text(re.compile(r"^\s*9\b"))
    page.reload()
    expect(rows).to_have_count(len(BLANK))
    expect(table.get_by_label("Outcome")).to_have_value("failed")
    table.get_by_label("Time from, s").fill("1.0")
    expect(rows).to_have_count(sum(number >= 10 for number in BLANK))
    table.get_by_label("Time to, s").fill("0.5")
    expect(table.get_by_role("alert")).to_contain_text("must be after")
    table.get_by_role("button", name="All frames").click()
    expect(rows).to_have_count(FRAMES)
    expect(table.get_by_role("button", name="Later")).to_be_disabled()
