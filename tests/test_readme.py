"""The commands of the README do what it says."""

import json
import re
import shutil
from pathlib import Path

import pytest
from document_blocks import ROOT, block, run_python, run_shell, serving


@pytest.fixture
def folder(tmp_path):
    shutil.copytree(ROOT / "samples", tmp_path / "samples")
    return tmp_path


def errors_to_truth(records):
    truth = json.loads((ROOT / "samples" / "truth.json").read_text(encoding="utf-8"))
    truths = {item["file"]: item for item in truth}
    for record in records:
        item = truths[Path(record["source"]).name]
        assert (record["status"] == "ok") == ("position_mm" in item), item["file"]
        if "position_mm" in item:
            position, true = record["position_mm"], item["position_mm"]
            distance = sum((a - b) ** 2 for a, b in zip(position, true, strict=True)) ** 0.5
            yield distance / true[2]


def test_the_tour_on_the_command_line(folder):
    run_shell(block("README.md", "sh", "-o pad.pdf"), folder)
    assert (folder / "pad.pdf").read_bytes().startswith(b"%PDF")
    lines = (folder / "poses.jsonl").read_text(encoding="utf-8").splitlines()
    assert len(lines) == 5
    assert max(errors_to_truth(map(json.loads, lines))) < 0.01


def test_the_tour_in_python(folder):
    said = run_python(block("README.md", "python", "import cv2"), folder)
    height_mm = float(re.search(r"\[.*?(\S+)\s*\]", said)[1])
    assert height_mm == pytest.approx(1300, rel=0.01)


def test_the_tour_over_rest(folder):
    with serving(folder / "data") as address:
        said = run_shell(block("README.md", "sh", "api="), folder, address)
    record = json.loads(said)["result"] | {"source": "height_450mm.jpg"}
    assert max(errors_to_truth([record])) < 0.01


def test_make_has_the_targets_that_the_readme_names():
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    targets = re.findall(r"^make (\w+)", block("README.md", "sh", "make run"), re.MULTILINE)
    assert targets == ["run", "test"]
    for target in targets:
        assert re.search(rf"^{target}:", makefile, re.MULTILINE)
