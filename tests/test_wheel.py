"""The wheel, installed away from the repository, serves the studio."""

import os
import re
import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path

import httpx
import pytest
from places import ROOT


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    folder = tmp_path_factory.mktemp("dist")
    subprocess.run(
        [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", folder],
        cwd=ROOT,
        check=True,
        capture_output=True,
    )
    (path,) = folder.glob("*.whl")
    return path


@pytest.fixture(scope="module")
def installed(wheel, tmp_path_factory):
    """The ``bin`` folder of an environment that has the wheel, and its dependencies from here.

    A path file makes this environment's packages importable there without a network. Path files
    within a folder so added do not count, so that the repository itself stays out of reach.
    """
    home = tmp_path_factory.mktemp("clean") / "venv"
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", home], check=True)
    python = home / "bin" / "python"
    pip = [sys.executable, "-m", "pip", "--python", python, "install", "--quiet"]
    subprocess.run([*pip, "--no-index", "--no-deps", wheel], check=True, env=environment())
    where = "import sysconfig; print(sysconfig.get_path('purelib'))"
    done = subprocess.run([python, "-c", where], check=True, capture_output=True, text=True)
    packages = Path(done.stdout.strip())
    (packages / "dependencies.pth").write_text(sysconfig.get_path("purelib") + "\n")
    return home / "bin"


def environment():
    """This process's environment without what would lead back to the repository."""
    ours = ("PYTHON", "PADSTUDIO_", "VIRTUAL_ENV", "PIP_REQUIRE_VIRTUALENV")
    return {key: value for key, value in os.environ.items() if not key.startswith(ours)}


def test_the_wheel_holds_the_pages_and_the_sample_but_no_tests(wheel):
    names = zipfile.ZipFile(wheel).namelist()
    held = {
        "padstudio/py.typed",
        "padstudio/_web/templates/base.html",
        "padstudio/_web/samples/pad.json",
        "padstudio/_web/samples/camera.yaml",
    }
    assert held - set(names) == set()
    for folder in ("frontend", "templates", "samples"):
        here = {
            path.relative_to(ROOT).as_posix()
            for path in (ROOT / folder).rglob("*")
            if path.is_file()
        }
        there = {
            name.removeprefix("padstudio/_web/") for name in names if f"_web/{folder}/" in name
        }
        assert there == here
    assert not [name for name in names if {"tests", "backend"} & set(name.split("/"))]
    assert not [name for name in names if Path(name).name.startswith(("test_", "conftest"))]


def test_the_program_is_the_wheels_own(installed, tmp_path):
    code = (
        "import padstudio, padstudio.resources as r; print(padstudio.__file__, r.sample_folder())"
    )
    done = subprocess.run(
        [installed / "python", "-c", code],
        cwd=tmp_path,
        env=environment(),
        check=True,
        capture_output=True,
        text=True,
    )
    assert str(installed.parent) in done.stdout
    assert str(ROOT) not in done.stdout


@pytest.fixture(scope="module")
def address(installed, tmp_path_factory):
    folder = tmp_path_factory.mktemp("elsewhere")
    with subprocess.Popen(
        [installed / "padstudio", "serve", "--port", "0", "--data", folder / "data"],
        cwd=folder,
        env=environment(),
        stderr=subprocess.PIPE,
        text=True,
    ) as server:
        try:
            line = server.stderr.readline()
            assert line.startswith("Pad Studio: http://127.0.0.1:"), line + server.stderr.read()
            yield line.split()[2]
        finally:
            server.terminate()


@pytest.mark.parametrize("page", ["/", "/diagnose"])
def test_it_serves_pages_with_all_that_they_name(address, page):
    answer = httpx.get(address + page, follow_redirects=True, timeout=60)
    assert answer.status_code == 200
    assert answer.headers["content-type"].startswith("text/html")
    names = set(re.findall(r'(?:src|href)="(/static/[^"?#]+)', answer.text))
    assert any(name.endswith(".js") for name in names)
    assert any(name.endswith(".css") for name in names)
    for name in names:
        assert httpx.get(address + name, timeout=60).status_code == 200, name


def test_it_answers_rest_calls(address):
    assert httpx.get(f"{address}/api/v1/health", timeout=60).json()["status"] == "ok"
    presets = httpx.get(f"{address}/api/v1/cameras/presets", timeout=60).json()
    assert len(presets["items"]) > 10
    samples = httpx.get(f"{address}/api/v1/samples", timeout=60)
    assert "height_1300mm.jpg" in samples.text
    assert (
        httpx.get(f"{address}/api/v1/samples/pad.json", timeout=60).json()["format"]
        == "padstudio.pad"
    )
