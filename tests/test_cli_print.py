from __future__ import annotations

from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

from measure_print import make_pad, pdf_info
from padstudio import cli_print
from padstudio.cli_support import StudioGroup
from padstudio.pad.spec import Pad


@pytest.fixture
def app() -> typer.Typer:
    app = typer.Typer(cls=StudioGroup)
    cli_print.register(app)
    return app


@pytest.fixture
def pad_file(tmp_path: Path) -> Path:
    make_pad(40, 40, name="shed").save(tmp_path / "pad.json")
    return tmp_path / "pad.json"


def test_sheets_are_written_and_told(app: typer.Typer, pad_file: Path, tmp_path: Path) -> None:
    out = tmp_path / "a4.pdf"
    done = CliRunner().invoke(app, ["print", str(pad_file), "--paper", "A4", "-o", str(out)])
    assert done.exit_code == 0, done.output
    assert "6 sheets A4 portrait, 2 rows x 3 columns, 0.37 m² of paper" in done.output
    assert "Pages:           7" in pdf_info(out.read_bytes(), tmp_path)


@pytest.mark.parametrize(
    ("name", "magic"),
    [
        ("pad.pdf", b"%PDF"),
        ("pad.svg", b"<?xml"),
        ("pad.png", b"\x89PNG"),
        ("pad.dxf", b"0\nSECTION"),
        ("pad.zip", b"PK"),
    ],
)
def test_suffix_names_the_form(
    app: typer.Typer, pad_file: Path, tmp_path: Path, name: str, magic: bytes
) -> None:
    out = tmp_path / name
    done = CliRunner().invoke(app, ["print", str(pad_file), "-o", str(out), "--dpi", "20"])
    assert done.exit_code == 0, done.output
    assert out.read_bytes().startswith(magic)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--paper", "B7"], "is no paper"),
        (["--paper", "A4", "--margin-mm", "200"], "smaller margins"),
        (["--header", "x"], "quiet margin"),
        (["--form", "bmp"], "no form of a pad"),
        (["--read", "abc"], "two readings"),
        (["--read", "20,200"], "factor of two"),
    ],
)
def test_bad_options_are_told_in_a_line(
    app: typer.Typer, pad_file: Path, tmp_path: Path, options: list[str], message: str
) -> None:
    out = tmp_path / "pad.pdf"
    done = CliRunner().invoke(app, ["print", str(pad_file), "-o", str(out), *options])
    assert done.exit_code == 2
    assert message in " ".join(done.output.split())
    assert not out.exists()


def test_measured_size_goes_into_the_pad_file(app: typer.Typer, pad_file: Path) -> None:
    done = CliRunner().invoke(app, ["measure", str(pad_file), "199", "201"])
    assert done.exit_code == 0, done.output
    assert Pad.load(pad_file).scale == (0.995, 1.005)
