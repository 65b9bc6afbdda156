"""The README's debugging session: a failing flight, the setting that reads it, step by step."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from document_blocks import block, run_shell
from document_pictures import keep_or_compare
from places import ROOT
from playwright.sync_api import Locator, Page, expect
from web_server import running, settings_for

SLOW_MS = 120_000
# Ten pictures of 4K are read seven times each.
SWEEP_MS = 600_000
_README = " ".join((ROOT / "README.md").read_text("utf-8").split())


@pytest.fixture(scope="module")
def studio_url(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Of a server that takes pictures of 4K, as one with the usual limits does."""
    limits = {"max_image_pixels": 20_000_000, "max_upload_bytes": 50_000_000, "max_cells": 300}
    with running(settings_for(tmp_path_factory.mktemp("studio"), **limits)) as client:
        yield str(client.base_url).rstrip("/")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the README's commands were run, up to the studio."""
    folder = tmp_path_factory.mktemp("session")
    run_shell(block("README.md", "sh", "-o fine.json"), folder)
    return folder


def _poses(path: Path) -> dict[str, list[float] | None]:
    records = map(json.loads, path.read_text("utf-8").splitlines())
    return {Path(each["source"]).name: each.get("position_mm") for each in records}


def _says(words: str) -> str:
    """Words, which have to stand in the README."""
    assert words in _README
    return words


def test_the_commands_before_and_after(folder: Path) -> None:
    before = _poses(folder / "before.jsonl")
    found = sum(pose is not None for pose in before.values())
    _says(f"Only {found} of the {len(before)} frames have a pose")
    said = run_shell(block("README.md", "sh", "-o after.jsonl"), folder)
    won, lost = (re.search(rf"^{word} +(\d+)$", said, re.MULTILINE) for word in ("won", "lost"))
    assert won
    assert lost
    _says(f"this one wins {won[1]} and loses {lost[1]}")
    after = _poses(folder / "after.jsonl")
    truth = json.loads((folder / "fine/stills/truth.json").read_text("utf-8"))
    off = [np.subtract(after[Path(each["file"]).name], each["position_mm"]) for each in truth]
    assert len(off) == len(before) == found + int(won[1])
    assert max(map(np.linalg.norm, off)) < 0.5
    _says("within 0.5 mm of the truth")


def _sweep(panel: Locator, parameter: str) -> None:
    panel.get_by_label("Parameter").select_option(parameter)
    panel.get_by_role("button", name="Sweep", exact=True).click()
    expect(panel.locator("[data-ref=words]")).to_contain_text("most of these", timeout=SWEEP_MS)


def test_the_steps_in_the_studio(open_page: Callable[..., Page], folder: Path) -> None:
    page = open_page("/flights")
    page.get_by_label("Choose a folder").set_input_files(folder / "fine" / "stills")
    for kind, name in (("pad", "pad.json"), ("camera", "camera.yaml")):
        page.get_by_label(f"Upload a {kind} file").set_input_files(folder / "fine" / name)
        expect(page.locator(f"#{kind}-choice-select")).not_to_have_value("")
    page.get_by_role("button", name="Analyse").click()
    head = page.locator("#head")
    expect(head).to_contain_text("10 frames, 40 % with a pose", timeout=SLOW_MS)

    page.keyboard.press("n")
    report = page.locator("#report")
    edges = _says("15668 edge points in red show no two directions at right angles")
    expect(report).to_contain_text(edges, timeout=SLOW_MS)
    expect(page.locator("#frame canvas[data-sharp=true]")).to_be_visible(timeout=SLOW_MS)
    expect(page.locator("#workbench .tile").first).to_be_visible(timeout=SLOW_MS)
    page.evaluate("() => scrollTo(0, 0)")
    keep_or_compare("failing", page.screenshot())

    panel = page.locator("#sweep")
    panel.locator("summary").click()
    words = panel.locator("[data-ref=words]")
    _sweep(panel, "search.most_edges")
    expect(words).to_contain_text("64000 wins 2 and loses none", timeout=SWEEP_MS)
    _says("64000 wins 2 frames and loses none")
    _sweep(panel, "search.finest_px")
    expect(words).to_contain_text("225 wins 6 and loses none", timeout=SWEEP_MS)
    _says("225 wins 6 frames and loses none")
    expect(panel.locator(".main-svg").first).to_be_attached()
    page.evaluate("() => { document.querySelector('.site-header').style.position = 'static'; }")
    keep_or_compare("sweep", panel.screenshot())

    row = panel.get_by_role("row", name=re.compile("^225 "))
    row.get_by_role("button", name="Take").click()
    expect(page.locator("#verdict")).to_contain_text("Pose found", timeout=SLOW_MS)
    page.get_by_role("button", name="Run again with these …").click()
    page.get_by_role("dialog").get_by_role("button", name="Run", exact=True).click()
    expect(head).to_contain_text("10 frames, 100 % with a pose", timeout=SLOW_MS)
    compared = page.locator("#compared")
    expect(compared).to_contain_text("this one wins 6 and loses 0", timeout=SLOW_MS)
