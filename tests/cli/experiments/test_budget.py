"""The budget command: the same budget whatever the number of processes, and what it refuses."""

import csv

import pytest
from command_line import assert_one_line_error, run
from small_budget import NOTHING, small_camera, small_pad

from padstudio.experiments.budget.run import budget_report


@pytest.fixture
def files(tmp_path):
    small_pad().save(tmp_path / "pad.json")
    small_camera().save(tmp_path / "camera.yaml")
    return tmp_path


def test_processes_give_what_one_gives(files):
    order = {
        "pad": (files / "pad.json").read_text(encoding="utf-8"),
        "camera": (files / "camera.yaml").read_text(encoding="utf-8"),
        "height_mm": 450.0,
        "frames": 4,
        "conditions": NOTHING | {"scale_percent": 1.0},
    }
    steps = []
    report = budget_report(order, files, lambda done, all_: steps.append((done, all_)))
    assert steps[-1][0] == steps[-1][1]
    words = [f"--with={name}={size}" for name, size in order["conditions"].items()]
    result = run(
        "budget", "--pad", files / "pad.json", "--camera", files / "camera.yaml", "--height-mm",
        450, "--frames", 4, "--workers", 2, *words, "-o", files / "out",
    )  # fmt: skip
    assert result.exit_code == 0, result.stderr
    assert "measuring the print" in result.stdout
    with (files / "out" / "sources.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    assert rows[1:] == [
        ["" if cell is None else str(cell) for cell in row] for row in report.tables[0].rows
    ]
    html = (files / "out" / "report.html").read_text(encoding="utf-8")
    assert "<script" not in html
    assert "data:image/svg+xml" in html


def test_what_is_there_is_not_written_over(files):
    (files / "out").mkdir()
    command = ("budget", "--pad", files / "pad.json", "--camera", files / "camera.yaml")
    result = run(*command, "--height-mm", 450, "-o", files / "out")
    assert_one_line_error(result, "file_exists")


@pytest.mark.parametrize(
    "words",
    [
        ("--with", "exposure=3"),
        ("--with", "exposure_ms"),
        ("--with", "exposure_ms=nan"),
        ("--with", "waves_mm=1", "--with", "waves_mm=2"),
        ("--frames", "3"),
        ("--height-mm", "5"),
    ],
)
def test_what_cannot_be_is_refused(files, words):
    command = ("budget", "--pad", files / "pad.json", "--camera", files / "camera.yaml")
    assert_one_line_error(run(*command, "--height-mm", "450", *words), "invalid_spec")


def test_quantities_are_listed():
    listed = run("budget", "--list-quantities")
    assert listed.exit_code == 0
    assert all(f"{name} " in listed.stdout for name in NOTHING)
