"""The shootout command."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from places import ROOT
from typer.testing import CliRunner, Result

from padstudio.cli.program import app
from padstudio.geometry.camera import Camera

PAD = ROOT / "samples" / "pad.json"


def run(*arguments: Any) -> Result:
    return CliRunner(env={"COLUMNS": "200", "NO_COLOR": "1", "TERM": "dumb"}).invoke(
        app, ["shootout", *map(str, arguments)]
    )


@pytest.fixture
def camera(tmp_path: Path) -> Path:
    matrix = np.array([[222.0, 0, 159.5], [0, 222.0, 89.5], [0, 0, 1]])
    Camera(320, 180, matrix).save(tmp_path / "camera.yaml")
    return tmp_path / "camera.yaml"


def test_it_writes_a_report_and_says_what_was_read(tmp_path: Path, camera: Path) -> None:
    out = tmp_path / "out"
    given = ("--pad", PAD, "--camera", camera, "-o", out, "--from-mm", 2500, "--frames", 1)
    result = run(*given, "--board", "aruco-single")
    assert result.exit_code == 0, result.output
    assert "ArUco single, fast               1 of 1 read" in result.stderr
    assert "Pad, single" in result.stderr
    assert {"report.md", "report.html", "boards.csv", "strips.svg"} <= {
        p.name for p in out.iterdir()
    }
    before = (out / "report.md").read_text(encoding="utf-8")
    again = run(*given, "--board", "aruco-single")
    assert again.exit_code == 2
    assert "(file_exists)" in again.stderr
    assert (out / "report.md").read_text(encoding="utf-8") == before


def test_a_wrong_order_leaves_nothing(tmp_path: Path, camera: Path) -> None:
    out = tmp_path / "out"
    result = run("--pad", PAD, "--camera", camera, "-o", out, "--board", "qr")
    assert result.exit_code == 2
    assert "no board 'qr'; choose of aruco-board" in result.stderr
    assert not out.exists()


def test_boards_are_listed_with_their_readers() -> None:
    result = run("--list-boards")
    assert result.exit_code == 0
    lines = dict(line.split(maxsplit=1) for line in result.stdout.splitlines())
    assert lines["charuco"].endswith("OpenCV")
    assert "pupil-apriltags" in lines["apriltag-nested"]
