"""The commands of the README do what it says."""

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```(\w+)\n(.*?)```", README, re.DOTALL)
PROGRAM = Path(sys.executable).with_name("padstudio")


def block(language, beginning):
    """The one fenced block of a language whose text has this beginning."""
    (text,) = (text for name, text in BLOCKS if name == language and text.startswith(beginning))
    return text


def run_shell(text, folder):
    return subprocess.run(
        ["sh", "-eu", "-c", text],
        cwd=folder,
        env={"PATH": f"{PROGRAM.parent}:/usr/local/bin:/usr/bin:/bin:/opt/homebrew/bin"},
        check=False,
        capture_output=True,
        text=True,
    )


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
    done = run_shell(block("sh", "padstudio generate"), folder)
    assert done.returncode == 0, done.stderr
    assert (folder / "pad.pdf").read_bytes().startswith(b"%PDF")
    lines = (folder / "poses.jsonl").read_text(encoding="utf-8").splitlines()
    assert len(lines) == 5
    assert max(errors_to_truth(map(json.loads, lines))) < 0.01


def test_the_tour_in_python(folder):
    done = subprocess.run(
        [sys.executable, "-c", block("python", "import cv2")],
        cwd=folder,
        check=False,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    height_mm = float(re.search(r"\[.*?(\S+)\s*\]", done.stdout)[1])
    assert height_mm == pytest.approx(1300, rel=0.01)


def test_the_tour_over_rest(folder):
    with subprocess.Popen(
        [PROGRAM, "serve", "--port", "0", "--data", folder / "data"],
        stderr=subprocess.PIPE,
        text=True,
    ) as server:
        try:
            address = server.stderr.readline().split()[2]
            text = block("sh", "api=").replace("http://127.0.0.1:8000", address)
            done = run_shell(text, folder)
        finally:
            server.terminate()
    assert done.returncode == 0, done.stderr
    answer = json.loads(done.stdout)
    record = answer["result"] | {"source": "height_450mm.jpg"}
    assert max(errors_to_truth([record])) < 0.01


def test_make_has_the_targets_that_the_readme_names():
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    targets = re.findall(r"^make (\w+)", block("sh", "make run"), re.MULTILINE)
    assert targets == ["run", "test"]
    for target in targets:
        assert re.search(rf"^{target}:", makefile, re.MULTILINE)
