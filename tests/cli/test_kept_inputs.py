"""What commands read stays as it is, and is never more than a file."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from command_line import assert_one_line_error, run
from places import FOOTAGE, SAMPLES
from web_server import PAD_FILE

STILL, CLIP = SAMPLES / "height_450mm.jpg", FOOTAGE / "flights" / "landing.mp4"


@pytest.fixture
def place(tmp_path: Path) -> Path:
    """A folder with a file of each kind that commands read."""
    for source, name in (
        (SAMPLES / "pad.json", "pad.json"),
        (SAMPLES / "camera.yaml", "camera.yaml"),
        (STILL, "still.jpg"),
        (CLIP, "clip.mp4"),
    ):
        shutil.copy(source, tmp_path / name)
    record = {"source": "a", "frame": 0, "time_s": 0.0, "status": "failed"}
    record |= {"stage": "edges", "reason": "dark", "detail": "", "elapsed_ms": {}}
    (tmp_path / "poses.jsonl").write_text(json.dumps(record) + "\n")
    (tmp_path / "vehicle.csv").write_text("time_s\n0\n")
    (tmp_path / "other.json").write_text(PAD_FILE)
    return tmp_path


GIVEN = ("--pad", "pad.json", "--camera", "camera.yaml")
#: Commands that write a file, and each of the files that they read.
COMMANDS = [
    (("detect", *GIVEN, "still.jpg"), ("pad.json", "camera.yaml", "still.jpg")),
    (("detect", *GIVEN, "."), ("still.jpg", "clip.mp4")),
    (("detect", *GIVEN, "*.jpg"), ("still.jpg",)),
    (("bundle", *GIVEN, "still.jpg"), ("pad.json", "camera.yaml", "still.jpg")),
    (("camera", "camera.yaml"), ("camera.yaml",)),
    (("calibrate", "--pad", "pad.json", "still.jpg"), ("pad.json", "still.jpg")),
    (("calibrate", "--pad", "pad.json", "."), ("still.jpg", "clip.mp4")),
    (("readout", "clip.mp4", *GIVEN), ("pad.json", "camera.yaml", "clip.mp4")),
    (("compare", "poses.jsonl", "poses.jsonl"), ("poses.jsonl",)),
    (
        ("export", "poses.jsonl", "--form", "px4", "--vehicle", "vehicle.csv"),
        ("poses.jsonl", "vehicle.csv"),
    ),
    (("print", "pad.json"), ("pad.json",)),
    (("remote", "--server", "http://127.0.0.1:1", *GIVEN, "."), ("still.jpg", "pad.json")),
]
CASES = [(words, each) for words, inputs in COMMANDS for each in inputs]


def _as_it_is(file: Path) -> Path:
    return file


def _symbolic(file: Path) -> Path:
    link = file.with_name("link")
    link.symlink_to(file.name)
    return link


def _hard(file: Path) -> Path:
    link = file.with_name("link")
    os.link(file, link)
    return link


@pytest.mark.parametrize("name_of", [_as_it_is, _symbolic, _hard])
@pytest.mark.parametrize(("words", "name"), CASES)
def test_no_command_writes_over_what_it_reads(
    words: tuple[str, ...],
    name: str,
    name_of: Callable[[Path], Path],
    place: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(place)
    file = place / name
    before, output = file.read_bytes(), name_of(file)
    for option in (("-o", output), (f"-o{output}",), (f"--output={output}",)):
        result = run(*words, *option, "--force")
        assert_one_line_error(result, "output_is_input")
        assert file.read_bytes() == before
        assert output.read_bytes() == before


def test_a_simulated_flight_is_not_written_where_its_pad_lies(place: Path) -> None:
    before = (place / "pad.json").read_bytes()
    given = ("--pad", place / "pad.json", "--camera", place / "camera.yaml", "--frames", 2)
    result = run("simulate", *given, "-o", place, "--force")
    assert_one_line_error(result, "output_is_input")
    assert (place / "pad.json").read_bytes() == before


@pytest.fixture
def pipe(tmp_path: Path) -> Path:
    path = tmp_path / "pipe"
    os.mkfifo(path)
    return path


@pytest.mark.parametrize("endless", ["/dev/zero", "pipe"])
@pytest.mark.parametrize(
    ("words", "code"),
    [
        (("verify", "FILE"), "invalid_pad_file"),
        (("print", "FILE", "-o", "out.pdf"), "invalid_pad_file"),
        (("detect", "--pad", "FILE", "--camera", "camera.yaml", "still.jpg"), "invalid_pad_file"),
        (("detect", "--pad", "pad.json", "--camera", "FILE", "still.jpg"), "invalid_camera_file"),
        (("detect", *GIVEN, "FILE"), "no_regular_file"),
        (("camera", "FILE"), "invalid_camera_file"),
        (("calibrate", "--pad", "pad.json", "FILE", "-o", "out.yaml"), "no_regular_file"),
        (("bundle", *GIVEN, "FILE", "-o", "out.zip"), "invalid_image"),
        (("replay", "FILE"), "not_found"),
        (("compare", "FILE", "poses.jsonl"), "os_error"),
        (("export", "FILE", "--form", "csv"), "os_error"),
        (
            ("export", "poses.jsonl", "--form", "px4", "--vehicle", "FILE"),
            "os_error",
        ),
        (("remote", "--server", "http://127.0.0.1:1", *GIVEN, "FILE"), "no_regular_file"),
    ],
)
def test_devices_and_pipes_are_no_files(
    words: tuple[str, ...],
    code: str,
    endless: str,
    place: Path,
    pipe: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(place)
    given = str(pipe) if endless == "pipe" else endless
    result = run(*(given if word == "FILE" else word for word in words))
    assert_one_line_error(result, code)


@pytest.mark.parametrize(
    "other",
    [
        ("--camera", FOOTAGE / "camera_drone_2k7.yaml"),
        ("--method", "paper"),
        ("--param", "search.least_step=0.4"),
        ("--no-fuse",),
        ("--at-rest",),
        ("--pad", "other.json"),
    ],
)
def test_a_run_goes_on_with_what_it_began_with_alone(
    other: tuple[Any, ...], place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(place)
    asked = ("detect", *GIVEN, "still.jpg", "-o", "found.jsonl", "-j", 1)
    assert run(*asked).exit_code == 0
    before = Path("found.jsonl").read_bytes()
    assert_one_line_error(run(*asked, "--resume", *other), "another_run")
    # A file that does not say what it was made with is not gone on with either.
    record = json.loads(before)
    del record["run"]
    Path("found.jsonl").write_text(json.dumps(record) + "\n")
    assert_one_line_error(run(*asked, "--resume"), "another_run")
    Path("found.jsonl").write_bytes(before)
    assert run(*asked, "--resume").exit_code == 0
    assert Path("found.jsonl").read_bytes() == before


def test_sigterm_and_a_closed_pipe_end_a_command_quietly(place: Path) -> None:
    code = "from padstudio.cli.program import main; main()"
    command = [sys.executable, "-c", code, "detect", *GIVEN, "still.jpg", "clip.mp4"]
    for ends in ("signal", "pipe"):
        with subprocess.Popen(
            [*command, "-o", "-", "-q", "-j", "1"],
            cwd=place,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        ) as process:
            assert process.stdout is not None
            assert process.stderr is not None
            assert json.loads(process.stdout.readline())["source"] == "still.jpg"
            if ends == "signal":
                process.send_signal(signal.SIGTERM)
                process.stdout.read()
            else:
                process.stdout.close()
            assert process.stderr.read() == b""
            assert process.wait(120) == (143 if ends == "signal" else 1)
