"""Holds the documents to the code."""

import re

import pytest
from places import ROOT

from padstudio.cli import program
from padstudio.geometry.pose import look_at_pad
from padstudio.pad.spec import Layer, Pad
from padstudio.vision.stage.detection import Detection
from padstudio.vision.stage.trace import STAGES, Reason, StageFailure

CONVENTIONS = (ROOT / "docs" / "conventions.md").read_text(encoding="utf-8")
COMMAND_LINE = (ROOT / "docs" / "command-line.md").read_text(encoding="utf-8")
ARCHITECTURE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
COMMANDS = {name: program.load(name) for name in program.COMMANDS}
OPTIONS = [
    (name, option)
    for name, command in COMMANDS.items()
    for parameter in command.params
    for option in (*parameter.opts, *parameter.secondary_opts)
    if option.startswith("-") and "--help" not in parameter.opts
]
DOCUMENTS = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]


def section(text, heading):
    """The text below a heading, to the next of its rank."""
    marks = heading.split()[0]
    start = text.index(f"\n{heading}\n") + len(heading) + 2
    end = text.find(f"\n{marks} ", start)
    return text[start : end if end > 0 else len(text)]


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_is_documented(command):
    assert f"\n## padstudio {command}\n" in COMMAND_LINE


@pytest.mark.parametrize(("command", "option"), OPTIONS)
def test_every_option_is_documented(command, option):
    assert f"`{option}`" in section(COMMAND_LINE, f"## padstudio {command}")


def test_no_option_is_documented_that_is_not_there():
    for command in COMMANDS:
        named = re.findall(r"`(--?[a-z][a-z-]*)`", section(COMMAND_LINE, f"## padstudio {command}"))
        there = {option for name, option in OPTIONS if name == command}
        # Text may point to what another command writes or takes.
        there |= {"--camera", "--help"}
        assert set(named) - there == set()


@pytest.mark.parametrize("reason", Reason)
def test_every_reason_is_documented(reason):
    assert f"`{reason}`" in section(CONVENTIONS, "### Poses file")


@pytest.mark.parametrize("stage", STAGES)
def test_every_stage_is_documented(stage):
    assert f"| `{stage}` |" in ARCHITECTURE


def test_every_key_of_a_poses_file_is_documented():
    failure = StageFailure("lines", Reason.NO_LATTICE, "figures", "advice")
    answers = [Detection(None, failure), Detection(look_at_pad(500), layer="red")]
    keys = {key for answer in answers for key in answer.to_record("frame.jpg")}
    text = section(CONVENTIONS, "### Poses file")
    assert [key for key in sorted(keys) if f"`{key}`" not in text] == []


def test_every_key_of_a_pad_file_is_documented():
    layer = Layer("red", 10, [[0, 1], [1, 1]])
    pad = Pad((layer,), 2, seed=1, method="growth", unique="plain", distance=1, scale=(1.1, 1))
    data = pad.to_dict()
    text = section(CONVENTIONS, "### Pad file")
    assert [key for key in (*data, *data["layers"][0]) if f"`{key}`" not in text] == []


def test_the_pad_in_the_conventions_is_one():
    (example,) = re.findall(r"```json\n(.*?)```", CONVENTIONS, re.DOTALL)
    pad = Pad.loads(example)
    field = pad.layers[0].field
    windows = {field[r : r + 2, c : c + 2].tobytes() for r in range(2) for c in range(3)}
    assert len(windows) == 6


def test_modules_that_the_architecture_names_are_there():
    named = set(re.findall(r"`((?:[a-z_]+/)+[a-z_]+\.py)`", ARCHITECTURE))
    assert len(named) > 30
    places = (ROOT / "backend" / "padstudio", ROOT)
    assert [name for name in sorted(named) if not any((p / name).is_file() for p in places)] == []


def test_folders_that_the_architecture_names_are_there():
    table = section(ARCHITECTURE, "## The tree")
    named = set(re.findall(r"`((?:[a-z_]+/)+)`", table))
    places = (ROOT / "backend" / "padstudio", ROOT / "frontend" / "js", ROOT)
    assert [name for name in sorted(named) if not any((p / name).is_dir() for p in places)] == []


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.name)
def test_links_between_documents_lead_somewhere(path):
    for target in re.findall(r"\]\(([^)]+)\)", path.read_text(encoding="utf-8")):
        if "://" in target:
            continue
        name, _, anchor = target.partition("#")
        file = (path.parent / name) if name else path
        assert file.exists(), target
        if anchor:
            headings = re.findall(r"^#+ (.+)$", file.read_text(encoding="utf-8"), re.MULTILINE)
            assert anchor in {h.lower().replace(" ", "-") for h in headings}, target
