"""The simulate, coverage and advise commands."""

import json

import cv2
import numpy as np
import pytest
from typer.testing import CliRunner

from padstudio.cli.program import app
from padstudio.geometry.camera import Camera
from padstudio.pad.coverage.pinhole import View
from padstudio.pad.coverage.spans import METHOD_LIMITS, cells_needed
from padstudio.pad.spec import Layer, Pad


def run(*arguments):
    return CliRunner(env={"COLUMNS": "200", "NO_COLOR": "1", "TERM": "dumb"}).invoke(
        app, [str(a) for a in arguments]
    )


@pytest.fixture
def files(tmp_path):
    rng = np.random.default_rng(3)
    fine = rng.integers(0, 2, (125, 125)).astype(np.uint8)
    coarse = rng.integers(0, 2, (25, 25)).astype(np.uint8)
    Pad((Layer("red", 10.0, fine), Layer("blue", 50.0, coarse))).save(tmp_path / "pad.json")
    matrix = np.array([[1886.0, 0, 1359.5], [0, 1886.0, 764.5], [0, 0, 1]])
    camera = Camera(2720, 1530, matrix)
    camera.save(tmp_path / "camera.yaml")
    camera.for_frame(272, 153).save(tmp_path / "small.yaml")
    return tmp_path


def test_simulate_writes_stills_and_truth(files):
    result = run(
        "simulate", "--pad", files / "pad.json", "--camera", files / "small.yaml",
        "--frames", 2, "--look", "leaves", "-o", files / "out",
    )  # fmt: skip
    assert result.exit_code == 0, result.stderr
    truth = json.loads((files / "out/stills/truth.json").read_text())
    assert [t["position_mm"][2] for t in truth] == pytest.approx([3000, 100])
    assert (files / "out" / truth[1]["file"]).read_bytes().startswith(b"\xff\xd8\xff")


def test_simulate_repeats_itself(files):
    pictures = []
    for name in ("a", "b"):
        arguments = ("--frames", 1, "--seed", 7, "--flight", "landing", "--stills")
        run("simulate", "--camera", files / "small.yaml", *arguments, "-o", files / name)
        pictures.append((files / name / "stills/landing_0.jpg").read_bytes())
    assert pictures[0] == pictures[1]


@pytest.mark.parametrize(
    ("options", "code"),
    [
        (("--frames", 100_000), "too_many_frames"),
        (("--from-mm", -3), "pose_below_ground"),
        (("--flight", "loop"), "invalid_spec"),
        (("--look", "hail"), "invalid_spec"),
        (("--ground", "lava"), "invalid_spec"),
        (("--with", "rain=1"), "invalid_spec"),
        (("--with", "fog=-3"), "invalid_spec"),
        (("--with", "vibration=90:0.1", "--with", "exposure=1000"), "vibration_too_fast"),
        (("--flight", "hover"), "odd_video_size"),
    ],
)
def test_simulate_refuses_in_one_line(files, options, code):
    result = run("simulate", "--camera", files / "small.yaml", "-o", files / "out", *options)
    assert result.exit_code == 2
    assert result.stderr.endswith(f"({code})\n")
    assert result.stderr.count("\n") == 1
    assert not (files / "out").exists()


def test_simulate_puts_disturbances_on(files):
    """What is true of a bent print and of a shaken camera is in the truth file."""
    arguments = ("simulate", "--camera", files / "small.yaml", "--pad", files / "pad.json")
    arguments += ("--frames", 1, "--flight", "landing", "--stills")
    assert run(*arguments, "-o", files / "calm").exit_code == 0
    words = ("--with", "vibration=90:0.2", "--with", "lifted=20:300", "--with", "sensor=mono")
    result = run(*arguments, *words, "-o", files / "shaken")
    assert result.exit_code == 0, result.stderr
    calm, shaken = (
        json.loads((files / name / "stills/truth.json").read_text())[0]
        for name in ("calm", "shaken")
    )
    assert calm["rotation"] != shaken["rotation"]
    assert calm["position_mm"] == shaken["position_mm"]
    assert len(shaken["also_true"]) == 2
    assert "also_true" not in calm
    image = cv2.imread(str(files / "shaken" / shaken["file"])).astype(int)
    assert np.abs(image[..., 0] - image[..., 2]).max() <= 2


def test_disturbances_are_listed():
    result = run("simulate", "--list-disturbances")
    assert result.exit_code == 0
    assert "fog=METRES" in result.stdout


def test_simulate_does_not_write_into_a_folder_that_is_there(files):
    result = run("simulate", "--camera", files / "small.yaml", "-o", files)
    assert result.stderr.endswith("(file_exists)\n")


def test_looks_are_listed():
    result = run("simulate", "--list-looks")
    assert result.exit_code == 0
    assert "drone-shadow" in result.stdout


def test_coverage_shows_spans_and_the_dead_band(files):
    arguments = ("coverage", "--pad", files / "pad.json", "--camera", files / "camera.yaml")
    result = run(*arguments, "--tilts", "0", "--switch-mm", 180)
    view = View(width_px=2720, height_px=1530, focal_px=1886.0)
    pad = Pad.load(files / "pad.json")
    red, blue = (
        cells_needed(5, 2, (layer.rows, layer.cols), view, METHOD_LIMITS["dense"])
        for layer in (pad.layer("red"), pad.layer("blue"))
    )
    # Cells of 10 mm across 1530 px at f = 1886 px.
    assert f"red           0°  {red * 10 * 1886 / 1530:6.0f} " in result.stdout
    assert f"2.9 blue cells across, not {blue:.1f}" in result.stderr
    data = json.loads(run(*arguments, "--tilts", "0,40", "--json").stdout)
    assert [span["layer"] for span in data["spans"]] == ["red", "blue", "outline"] * 2
    assert data["dead_bands"] == []


def test_coverage_simulates_on_request(files):
    arguments = ("coverage", "--pad", files / "pad.json", "--camera", files / "small.yaml")
    result = run(
        *arguments, "--simulate", "--heights", "400", "--trials", 1, "--blurs", "0,3", "--json"
    )
    found = json.loads(result.stdout)["simulated"]
    assert (found["axis"], found["values"], found["trials"]) == ("blur_px", [0.0, 3.0], 1)
    assert np.shape(found["success"]) == (1, 2)


def test_coverage_refuses_what_is_no_number(files):
    arguments = ("coverage", "--pad", files / "pad.json", "--camera", files / "camera.yaml")
    assert run(*arguments, "--tilts", "steep").exit_code == 2
    assert "89" in run(*arguments, "--tilts", "95").stderr


def test_advise_prints_a_command_that_generates_the_pad(files):
    result = run(
        "advise", "--camera", files / "camera.yaml", "--low-mm", 100, "--high-mm", 9000, "--tilt", 0
    )
    command = result.stdout.split()
    assert command[:2] == ["padstudio", "generate"]
    assert float(command[command.index("--cell-mm") + 1]) <= 100 / 1886 * 1530 / 5
    assert "reads from" in result.stderr
