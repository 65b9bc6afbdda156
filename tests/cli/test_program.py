import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from command_line import ENVIRONMENT, assert_one_line_error, run
from places import SAMPLES
from typer.testing import CliRunner

import padstudio
from padstudio import Pad
from padstudio.cli import program
from padstudio.errors import StudioError
from padstudio.geometry import presets

PAD, CAMERA, PICTURE = (SAMPLES / n for n in ("pad.json", "camera.yaml", "height_1300mm.jpg"))


def test_version():
    result = run("--version")
    assert (result.exit_code, result.stdout) == (0, f"padstudio {padstudio.__version__}\n")


@pytest.mark.parametrize("command", ["generate", "detect", "serve"])
def test_help_shows_examples(command):
    result = run(command, "--help")
    assert result.exit_code == 0
    assert f"Examples: padstudio {command}" in result.stdout


def test_help_lists_the_commands():
    result = run("-h")
    for command in ("generate", "detect", "cameras", "serve"):
        assert f" {command} " in result.stdout


def test_without_arguments_the_help_is_shown():
    result = run()
    assert result.exit_code == 2
    assert result.output.count("Usage:") == 1
    assert "error" not in result.stderr


@pytest.mark.parametrize(
    "arguments",
    [
        ["fly"],
        ["generate"],
        ["generate", "-o", "x.json", "--window", "many"],
        ["generate", "-o", "x.json", "--unique", "maybe"],
        ["generate", "-o", "x.json", "--cells", "1x2x3"],
        ["generate", "-o", "x.json", "--cells", "-4"],
        ["generate", "-o", "x.json", "--cells", "9" * 5000],
        ["serve", "--port", "70000"],
    ],
)
def test_a_wrong_command_line_is_one_line(arguments):
    assert_one_line_error(run(*arguments), "usage")


def test_generate_writes_a_pad(tmp_path):
    path = tmp_path / "pad.json"
    result = run(
        *("generate", "-o", path, "--cells", "20x30", "--ratio", "2", "--cell-mm", "8"),
        *("--quiet-mm", "12", "--distance", "1", "--name", "garden"),
    )
    assert result.exit_code == 0, result.stderr
    pad = Pad.load(path)
    assert [(la.channel, la.rows, la.cols, la.cell_mm) for la in pad.layers] == [
        ("red", 20, 30, 8),
        ("blue", 10, 15, 16),
    ]
    assert (pad.name, pad.quiet_mm, pad.seed) == ("garden", 12, 1)
    assert result.stderr == f"{path}: 240 mm x 160 mm, red 20 x 30, blue 10 x 15\n"


def test_generate_gives_the_same_pad_for_the_same_seed(tmp_path):
    texts = []
    for name, seed in (("a", 5), ("b", 5), ("c", 6)):
        options = ("--cells", "15", "--ratio", "1", "--distance", "1", "--seed", seed)
        assert run("generate", "-o", tmp_path / name, *options).exit_code == 0
        texts.append((tmp_path / name).read_text(encoding="utf-8"))
    assert texts[0] == texts[1]
    assert json.loads(texts[0])["layers"] != json.loads(texts[2])["layers"]


def test_layers_share_a_code_only_where_asked_for(tmp_path):
    path = tmp_path / "pad.json"
    size = ("generate", "-o", path, "--cells", "30", "--ratio", "3", "--force")
    assert run(*size).exit_code == 0
    assert Pad.load(path).layer_fields == "independent"
    result = run(*size, "--layers", "paper")
    assert "reads as another height" in result.stderr
    red, blue = (layer.field for layer in Pad.load(path).layers)
    assert (red[:10, :10] == blue).all()


def test_verify_says_what_holds(tmp_path):
    path = tmp_path / "pad.json"
    run("generate", "-o", path, "--cells", "30", "--ratio", "3")
    result = run("verify", path)
    assert (result.exit_code, result.stderr) == (0, "")
    red, blue, both = result.stdout.splitlines()
    assert red.startswith("red: 30 x 30 cells, each window once in all four turns, windows differ")
    assert blue.startswith("blue: 10 x 10 cells")
    assert both.startswith("red and blue: independent: windows differ in at least 3 cells")
    assert json.loads(run("verify", path, "--json").stdout)["layers"] == "independent"


def test_verify_warns_of_shared_codes_and_ends_with_one_where_a_promise_is_broken(tmp_path):
    result = run("verify", PAD)
    assert result.exit_code == 0
    assert "shared, a copy of the red layer's corner: 441 windows occur in both" in result.stdout
    assert "reads as another height" in result.stderr
    path = tmp_path / "pad.json"
    replace(Pad.load(PAD), layer_fields="independent").save(path)
    result = run("verify", path)
    assert result.exit_code == 1
    assert "layers are not independent, but shared" in result.stderr


def test_generate_refuses_what_cannot_be(tmp_path):
    path = tmp_path / "pad.json"
    assert_one_line_error(run("generate", "-o", path, "--window", "40"), "invalid_spec")
    assert not path.exists()


def test_generate_does_not_write_over_a_file(tmp_path):
    path = tmp_path / "pad.json"
    path.write_text("precious")
    options = ("generate", "-o", path, "--cells", "10", "--ratio", "1", "--distance", "1")
    assert_one_line_error(run(*options), "file_exists")
    assert path.read_text() == "precious"
    assert run(*options, "--force").exit_code == 0
    assert Pad.load(path).layers[0].rows == 10


def test_generate_into_a_folder_that_is_not_there(tmp_path):
    result = run("generate", "-o", tmp_path / "gone" / "pad.json")
    assert_one_line_error(result, "not_found")


def test_cameras_shows_the_whole_ids():
    result = CliRunner(env=ENVIRONMENT | {"COLUMNS": "60"}).invoke(program.app, ["cameras"])
    assert result.exit_code == 0
    assert "preset-dji-phantom-4-pro-still" in result.stdout
    assert "nominal" in result.stdout


@pytest.mark.parametrize(
    ("error", "exit_code", "line"),
    [
        (StudioError("it\nbroke", code="broken"), 2, "error: it broke (broken)\n"),
        (PermissionError(13, "Permission denied", "pad.json"), 2, None),
        (
            ZeroDivisionError("division by zero"),
            70,
            "error: a defect of the program: ZeroDivisionError: division by zero; set "
            "PADSTUDIO_DEBUG=1 to see where (internal_error)\n",
        ),
        (KeyboardInterrupt(), 130, None),
    ],
)
def test_any_error_is_one_line(monkeypatch, tmp_path, error, exit_code, line):
    def fail(*_arguments, **_options):
        raise error

    monkeypatch.setattr("padstudio.pad.coding.generate.generate_pad", fail)
    result = run("generate", "-o", tmp_path / "pad.json")
    assert result.exit_code == exit_code
    assert "Traceback" not in result.stderr
    if line:
        assert result.stderr == line
    else:
        assert result.stderr.strip().count("\n") == 0


def test_a_defect_shows_its_place_on_request(monkeypatch, tmp_path):
    monkeypatch.setenv("PADSTUDIO_DEBUG", "1")
    monkeypatch.setattr("padstudio.pad.coding.generate.generate_pad", lambda *_, **__: 1 / 0)
    result = run("generate", "-o", tmp_path / "pad.json")
    assert "Traceback" in result.stderr
    assert result.exit_code == 70


def test_a_camera_file_wins_over_a_presets_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    preset = presets.load_camera("preset-webcam-c270")
    assert preset.nominal
    presets.load_camera("preset-webcam-c920").save("preset-webcam-c270")
    assert presets.load_camera("preset-webcam-c270").width == 1920


SILENT_CAMERA = """\
image_width: 640
image_height: 480
camera_matrix: [500, 0, 320, 0, 500, 240, 0, 0, 1]
"""


def test_a_camera_is_shown_and_written_in_another_form(tmp_path):
    file = tmp_path / "camera.yaml"
    file.write_text(SILENT_CAMERA + "dist: [-0.9, 0, 0.001, 0.002, 0]\n")
    shown = run("camera", file)
    assert "distortion" in shown.stdout
    assert "-0.9 0 0.001 0.002 0" in shown.stdout
    assert "camera camera: the lens folds back within" in shown.stderr
    chain = tmp_path / "chain.yaml"
    assert run("camera", file, "--form", "kalibr", "-o", chain).exit_code == 0
    again = run("camera", f"{chain}#cam0", "--form", "colmap", "-o", "-")
    assert again.stdout.endswith("1 OPENCV 640 480 500.0 500.0 320.5 240.5 -0.9 0.0 0.001 0.002\n")
    assert run("camera", f"{chain}#cam1").stderr.startswith("error: chain.yaml: holds no camera")
    assert "(file_exists)" in run("camera", file, "-o", chain).stderr


def test_a_lens_without_distortion_needs_to_be_told(tmp_path):
    file = tmp_path / "camera.yaml"
    file.write_text(SILENT_CAMERA)
    envelope = ("--low-mm", 80, "--high-mm", 5000)
    refused = run("advise", "--camera", file, *envelope)
    assert refused.exit_code == 2
    assert "--no-distortion on the command line" in refused.stderr
    assert refused.stderr.endswith("(distortion_not_said)\n")
    assert run("advise", "--camera", file, *envelope, "--no-distortion").exit_code == 0


def test_the_installed_program():
    program = Path(sys.executable).with_name("padstudio")
    environment = os.environ | ENVIRONMENT
    done = subprocess.run([program, "--version"], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (0, f"padstudio {padstudio.__version__}\n")
    done = subprocess.run(
        [program, "fly"], capture_output=True, text=True, check=False, env=environment
    )
    assert done.returncode == 2
    assert done.stderr == "error: No such command 'fly'; see padstudio --help (usage)\n"


@pytest.mark.parametrize("command", program.COMMANDS)
def test_the_list_of_commands_says_what_each_says_itself(command):
    assert (
        program.load(command)
        .help.split("\n\n")[0]
        .replace("\n", " ")
        .startswith(program.COMMANDS[command].rstrip("."))
    )


def test_help_needs_no_opencv():
    code = (
        "import sys, padstudio.cli.program; "
        "heavy = {'cv2', 'numpy', 'numba', 'fastapi', 'rich.table', 'reportlab'}; "
        "print(sorted(heavy & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


LOADED = """
import sys
from padstudio.cli.program import main
try:
    main()
finally:
    print(*sorted({name.partition(".")[0] for name in sys.modules}), file=sys.stderr)
"""
#: What no short command needs.
SPARE = {"alembic", "asyncio", "av", "dask", "distributed", "fastapi", "fsspec", "jinja2"}
SPARE |= {"multiprocessing", "plotly", "pymavlink", "reportlab", "rich", "sqlalchemy", "ssl"}


def libraries_of(*arguments):
    """Top-level names of all that is imported while a command runs in a process of its own."""
    done = subprocess.run(
        [sys.executable, "-c", LOADED, *map(str, arguments)],
        capture_output=True,
        text=True,
        check=True,
    )
    return set(done.stderr.splitlines()[-1].split())


@pytest.mark.parametrize(
    ("arguments", "may"),
    [
        (["--version"], set()),
        (["--help"], {"rich"}),
        (["detect", "-q", "--pad", PAD, "--camera", CAMERA, PICTURE], {"cv2", "numba", "PIL"}),
        (["generate", "--cells", "30", "-o", "pad.json"], {"cv2", "numba"}),
        (["verify", PAD], {"cv2", "numba"}),
    ],
)
def test_a_command_imports_only_what_it_uses(arguments, may, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    heavy = SPARE | {"cv2", "numba", "PIL"}
    assert libraries_of(*arguments) & heavy <= may
