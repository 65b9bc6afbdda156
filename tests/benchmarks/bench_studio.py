#!/usr/bin/env python3
"""How soon the page of a flight shows what was asked for, in Chromium: median and 95th percentile.

    bench_studio.py [--rounds N] [--json FILE]

A server of its own reads two flights of the footage, one with a single keyframe and a gusty one;
then a browser goes through them: steps, jumps, play, a stage's whole picture, all stages. Times are
taken in the page, from the key to the frame that is painted. Other work on the machine counts.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import numpy as np
from playwright.sync_api import Page, sync_playwright
from studio_server import FOOTAGE, LANDING, OPEN, order, serving

_NAMES = ("chromium", "chromium-browser", "google-chrome")
_FAR = 10
_LOOK_S = 0.2
# From the key until the frame stands: the canvas is painted and its next picture is on the screen.
_PRESS = """([key, shift, frame]) => new Promise(resolve => {
  const canvas = document.querySelector("#frame canvas");
  const start = performance.now();
  const look = () => {
    if (canvas.dataset.frame === String(frame)) resolve(performance.now() - start);
    else requestAnimationFrame(look);
  };
  const pressed = { key, shiftKey: shift, bubbles: true };
  document.body.dispatchEvent(new KeyboardEvent("keydown", pressed));
  requestAnimationFrame(look);
})"""
_JUMP = """frame => new Promise(resolve => {
  const canvas = document.querySelector("#frame canvas");
  const input = document.querySelector("#frame-number");
  const start = performance.now();
  const look = () => {
    if (canvas.dataset.frame === String(frame)) resolve(performance.now() - start);
    else requestAnimationFrame(look);
  };
  input.value = String(frame);
  input.dispatchEvent(new Event("change"));
  requestAnimationFrame(look);
})"""
_PLAY = """seconds => new Promise(resolve => {
  const canvas = document.querySelector("#frame canvas");
  const first = Number(canvas.dataset.frame);
  const seen = [];
  const start = performance.now();
  const look = now => {
    const frame = Number(canvas.dataset.frame);
    if (canvas.dataset.frame && frame !== seen.at(-1)) seen.push(frame);
    if (now - start < 1000 * seconds) requestAnimationFrame(look);
    else resolve([seen.length, Math.max(...seen) - first]);
  };
  document.querySelector("#transport [data-ref=play]").click();
  requestAnimationFrame(look);
})"""
# From the slider's event until the answer with the stage and the pose is on the screen.
_DRAG = """([name, at]) => new Promise(resolve => {
  const slider = document.querySelector(`.param[data-name="${name}"] [data-ref=slider]`);
  const start = performance.now();
  const observer = new PerformanceObserver(list => {
    const isAnswer = entry => entry.name.endsWith("/looks") && entry.startTime >= start;
    if (!list.getEntries().some(isAnswer)) return;
    observer.disconnect();
    requestAnimationFrame(() => requestAnimationFrame(() => resolve(performance.now() - start)));
  });
  observer.observe({ type: "resource" });
  slider.value = String(at);
  slider.dispatchEvent(new Event("input", { bubbles: true }));
})"""
#: Parameter, the stage beside which it stands, and the view that is looked at.
_DRAGGED = {
    "dense": (
        ("search.least_step", "Look at Edges, red"),
        ("search.most_tries", "Look at Lines, red"),
        ("refine.reach_px", "Look at Lines, red"),
    ),
    "paper": (
        ("paper.canny_high", "Look at Edges, blue"),
        ("paper.hough_votes", "Look at Lines, blue"),
    ),
}
# Longer than the page takes for a rest: it has begun to fetch all other views.
_REST_MS = 300
_FETCH = """async address => {
  const start = performance.now();
  const answer = await fetch(address);
  const body = await answer.arrayBuffer();
  if (!answer.ok) throw new Error(`${answer.status} ${address}`);
  return [performance.now() - start, body.byteLength];
}"""


def simulated(folder: Path) -> Path:
    """A gusty flight of 120 frames, H.265, 1920 x 1080."""
    program = Path(sys.executable).with_name("padstudio")
    camera, pad = FOOTAGE / "camera_drone_1080p.yaml", FOOTAGE / "pad_a.json"
    command = [program, "simulate", "--pad", pad, "--camera", camera, "-o", folder]
    command += ["--flight", "gusty", "--frames", "120", "--codec", "h265"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return next(folder.glob("flights/*.mp4"))


def steps(page: Page, rounds: int, last: int) -> dict[str, list[float]]:
    """Milliseconds of single steps and of steps of ten, back and forth."""
    taken: dict[str, list[float]] = {"step of 1": [], "step of 10": []}
    frame = _at(page)
    way = 1
    for count in range(2 * rounds):
        far = count % 2 == 1
        by = _FAR if far else 1
        way = -1 if frame + way * by > last else 1 if frame + way * by < 0 else way
        frame += way * by
        key = "ArrowRight" if way > 0 else "ArrowLeft"
        name = "step of 10" if far else "step of 1"
        taken[name].append(float(page.evaluate(_PRESS, [key, far, frame])))
        page.wait_for_timeout(30)
    return taken


def jumps(page: Page, rounds: int, last: int) -> list[float]:
    """Milliseconds of jumps to frames anywhere."""
    rng = np.random.default_rng(1)
    taken = []
    for frame in rng.integers(0, last + 1, rounds):
        if int(frame) != _at(page):
            taken.append(float(page.evaluate(_JUMP, int(frame))))
    return taken


def traces(page: Page, base: str, rounds: int, last: int) -> dict[str, list[float]]:
    """Milliseconds of all stages of a frame that nobody looked at, and of one whole picture."""
    rng = np.random.default_rng(2)
    taken: dict[str, list[float]] = {"all stages": [], "a stage's whole picture": []}
    for frame in rng.choice(last + 1, rounds, replace=False):
        address = f"{base}/frames/{frame}"
        ms, _ = page.evaluate(_FETCH, f"{address}/stages")
        taken["all stages"].append(float(ms))
        ms, _ = page.evaluate(_FETCH, f"{address}/pictures/choose.webp")
        taken["a stage's whole picture"].append(float(ms))
    return taken


def drags(page: Page, rounds: int, method: str) -> dict[str, list[float]]:
    """Milliseconds of a slider's step until the stage and the pose stand anew, by parameter."""
    taken: dict[str, list[float]] = {}
    for name, view in _DRAGGED[method]:
        page.get_by_role("button", name=view).click()
        # Rows of a closed stage are there, too, and their sliders work.
        middle = int(page.locator(f".param[data-name='{name}'] [data-ref=slider]").input_value())
        page.wait_for_timeout(1000)
        page.evaluate(_DRAG, [name, middle + 1])
        # Without a rest, as a hand drags; then with one before each step.
        for rest_ms, what in ((0, f"dragging {name}"), (_REST_MS, f"{name} after a rest")):
            taken[what] = []
            for step in range(rounds):
                page.wait_for_timeout(rest_ms)
                at = middle + 3 * (step + 1) + (1 if rest_ms else 0)
                taken[what].append(float(page.evaluate(_DRAG, [name, at])))
        page.get_by_role("button", name="Reset all").click()
    return taken


def paper(page: Page, client: httpx.Client, base: str, rounds: int) -> dict[str, Any]:
    """Figures of the same flight by the paper's method."""
    run = client.post(f"{base}/rerun", json={"method": "paper", "stride": 10}).raise_for_status()
    again = run.headers["Location"]
    while client.get(again).json()["state"] in OPEN:
        time.sleep(_LOOK_S)
    page.goto(f"/flights/{again.rsplit('/', 1)[1]}?frame=40")
    page.wait_for_selector("#frame canvas[data-sharp=true]")
    page.wait_for_selector("#workbench .stage-row-blue .tile", timeout=600_000)
    page.wait_for_load_state("networkidle")
    return dict(drags(page, max(4, rounds // 3), "paper"))


def weight(client: httpx.Client, base: str, frame: int) -> int:
    """Bytes of all thumbnails of a frame."""
    stages = client.get(f"{base}/frames/{frame}/stages").raise_for_status().json()["stages"]
    shown = [stage["thumbnail"] for stage in stages if stage["thumbnail"]]
    return sum(len(client.get(address).content) for address in shown)


def measure(page: Page, client: httpx.Client, base: str, rounds: int) -> dict[str, Any]:
    """All figures of one flight that was read."""
    while client.get(base).json()["state"] in OPEN:
        time.sleep(_LOOK_S)
    last = client.get(base).json()["frames_total"] - 1
    page.goto(f"/flights/{base.rsplit('/', 1)[1]}?frame=0")
    page.wait_for_selector("#frame canvas[data-sharp=true]")
    # The frames about it are laid ready by now, and the first stages are there.
    page.wait_for_selector("#workbench .stage-row-blue .tile", timeout=600_000)
    page.wait_for_load_state("networkidle")
    found: dict[str, Any] = dict(steps(page, rounds, last))
    found["jump"] = jumps(page, rounds, last)
    page.evaluate(_JUMP, 0) if _at(page) else None
    page.wait_for_timeout(1000)
    painted, passed = page.evaluate(_PLAY, 3)
    page.keyboard.press(" ")
    found |= {"frames painted in 3 s of play": painted, "frames passed": passed}
    found |= traces(page, base, max(4, rounds // 4), last)
    found |= drags(page, max(4, rounds // 3), "dense")
    found["bytes of a result's thumbnails"] = weight(client, base, last // 2)
    return found


def _at(page: Page) -> int:
    return int(page.locator("#frame-number").input_value())


def _browser_path() -> str:
    found = os.environ.get("PADSTUDIO_CHROMIUM") or next(
        filter(None, map(shutil.which, _NAMES)), ""
    )
    if not found:
        raise SystemExit("error: no Chromium; name one in PADSTUDIO_CHROMIUM")
    return found


def _lines(name: str, figures: dict[str, Any]) -> Iterator[str]:
    yield f"{name}"
    for what, value in figures.items():
        if isinstance(value, list):
            median, high = np.percentile(value, [50, 95])
            yield f"  {what:32} {median:7.0f} ms  {high:7.0f} ms  ({len(value)})"
        else:
            yield f"  {what:32} {value:7d}"


def main() -> None:
    parser = argparse.ArgumentParser(description="The page of a flight, in Chromium.")
    parser.add_argument("--rounds", type=int, default=40)
    parser.add_argument("--landing", type=Path, default=LANDING, help="a video of one keyframe")
    parser.add_argument("--gusty", type=Path, help="a gusty video; simulated if not given")
    parser.add_argument("--json", type=Path, help="write the figures to this file")
    given = parser.parse_args()
    results = {}
    with (
        tempfile.TemporaryDirectory() as folder,
        serving(Path(folder) / "data") as (client, _),
        sync_playwright() as playwright,
    ):
        browser = playwright.chromium.launch(executable_path=_browser_path(), args=["--no-sandbox"])
        page = browser.new_page(
            base_url=str(client.base_url), viewport={"width": 1280, "height": 900}
        )
        page.set_default_timeout(120_000)
        gusty = given.gusty or simulated(Path(folder) / "gusty")
        for video, camera in (
            (given.landing, "camera_drone_2k7.yaml"),
            (gusty, "camera_drone_1080p.yaml"),
        ):
            [base] = order(client, video, camera=camera)
            results[video.stem] = measure(page, client, base, given.rounds)
            results[video.stem] |= paper(page, client, base, given.rounds)
            print("\n".join(_lines(video.stem, results[video.stem])), flush=True)
        browser.close()
    if given.json:
        given.json.write_text(json.dumps(results, indent=1))


if __name__ == "__main__":
    main()
