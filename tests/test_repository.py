"""What must hold of the repository's files as a whole."""

import re
import shutil
import subprocess

import pytest
from places import ROOT

TEXT = {"", ".cfg", ".css", ".html", ".js", ".json", ".md", ".mako", ".py", ".sh", ".svg"}
TEXT |= {".toml", ".txt", ".yaml", ".yml", ".lock"}


def tracked_files():
    if not (ROOT / ".git").exists() or shutil.which("git") is None:
        folders = ("backend", "docs", "frontend", "samples", "templates", "tests")
        return [p for folder in folders for p in (ROOT / folder).rglob("*") if p.is_file()]
    names = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True
    ).stdout.split("\0")
    return [ROOT / name for name in names if name and (ROOT / name).is_file()]


FILES = tracked_files()
PYTHON = [path for path in FILES if path.suffix == ".py"]


LOCKS = ("requirements.lock", "requirements-run.lock")


@pytest.mark.parametrize("name", LOCKS)
def test_every_locked_package_has_hashes(name):
    text = (ROOT / name).read_text(encoding="utf-8")
    blocks = re.split(r"\n(?=\S)", text.strip())
    assert len(blocks) > 30
    for block in blocks:
        assert re.match(r"[a-z0-9-]+==[\w.+!]+", block), block
        assert "--hash=sha256:" in block, block.splitlines()[0]


@pytest.mark.parametrize("name", [*LOCKS, "requirements-shootout.lock"])
def test_the_lock_names_no_address(name):
    text = (ROOT / name).read_text(encoding="utf-8")
    assert "://" not in text
    assert "index" not in text


def test_the_lock_holds_every_dependency():
    import tomllib

    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    asked = project["dependencies"] + project["optional-dependencies"]["dev"]
    lock = (ROOT / "requirements.lock").read_text(encoding="utf-8")
    locked = set(re.findall(r"^([a-z0-9-]+)==", lock, re.MULTILINE))
    names = {re.match(r"[\w-]+", line)[0].lower().replace("_", "-") for line in asked}
    assert names - locked == set()


def test_the_readers_of_other_boards_are_locked():
    import tomllib

    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    lock = (ROOT / "requirements-shootout.lock").read_text(encoding="utf-8")
    asked = {line.partition(">")[0] for line in project["optional-dependencies"]["shootout"]}
    assert set(re.findall(r"^([a-z0-9-]+)==", lock, re.MULTILINE)) == asked
    assert lock.count("--hash=sha256:") >= len(asked)


def test_the_container_has_the_same_versions_and_nothing_of_developers():
    import tomllib

    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    whole, run = (
        dict(
            re.findall(r"^([a-z0-9-]+)==([\w.+!]+)", (ROOT / name).read_text("utf-8"), re.MULTILINE)
        )
        for name in LOCKS
    )
    assert run.items() <= whole.items()
    extras = project["optional-dependencies"]
    used = project["dependencies"] + extras["s3"] + extras["postgresql"]
    needed, developers = (
        {re.match(r"[\w-]+", line)[0].lower().replace("_", "-") for line in lines}
        for lines in (used, extras["dev"])
    )
    assert needed <= run.keys()
    assert not (developers - needed) & run.keys()


def test_the_container_is_built_on_one_image_that_its_digest_names():
    text = (ROOT / "Dockerfile").read_text(encoding="utf-8")
    assert re.search(
        r"^ARG PYTHON=python:3\.\d+\.\d+-slim-\w+@sha256:[0-9a-f]{64}$", text, re.MULTILINE
    )
    bases = re.findall(r"^FROM (\S+)", text, re.MULTILINE)
    assert bases == ["${PYTHON}"] * 2


def test_no_file_names_a_place_on_one_machine():
    # Written in parts, so that this file does not find itself.
    places = [rf"/{name}/" for name in ("work", "root", "home/\\w+", "Users/\\w+")]
    pattern = re.compile("|".join(rf"(?<![\w.~/*-]){place}" for place in places))
    found = []
    for path in FILES:
        if path.suffix in TEXT:
            for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
                if pattern.search(line):
                    found.append(f"{path.relative_to(ROOT)}:{number}: {line.strip()[:80]}")
    assert not found


@pytest.mark.parametrize(
    ("folder", "limit_bytes"), [("tests/footage", 8_000_000), ("samples", 3_000_000)]
)
def test_pictures_stay_small(folder, limit_bytes):
    assert sum(p.stat().st_size for p in (ROOT / folder).rglob("*") if p.is_file()) <= limit_bytes


def test_ci_runs_the_tests_and_nothing_else():
    script = ROOT / ".ci" / "run"
    assert script.stat().st_mode & 0o111
    commands = [
        line
        for line in script.read_text(encoding="utf-8").splitlines()
        if line and not line.startswith(("#", "set ", "cd "))
    ]
    assert commands == ["exec make test"]


@pytest.mark.parametrize("target", ["install", "run", "test", "check", "bench"])
def test_make_knows_the_targets_of_the_readme(target):
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert re.search(rf"^{target}:", makefile, re.MULTILINE)


_CLOCKS = re.compile(r"""setattr\(\s*(["']time\.|time\s*,)""")


def test_no_test_stops_the_clock_of_the_whole_process():
    """Servers of other tests run in it: what their loops wait for would come in days."""
    assert _CLOCKS.search('patch.setattr("time.monotonic", clock)')
    tests = [path for path in PYTHON if (ROOT / "tests") in path.parents]
    guilty = [path for path in tests if _CLOCKS.search(path.read_text(encoding="utf-8"))]
    assert [path for path in guilty if path.name != "test_repository.py"] == []
