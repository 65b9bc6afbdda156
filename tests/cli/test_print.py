from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import typer
from measure_print import make_pad, pdf_info
from strip_photo import strip_photo
from typer.testing import CliRunner

from padstudio.cli import program
from padstudio.pad.spec import Pad


@pytest.fixture
def app() -> typer.Typer:
    return program.app


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


def test_a_photo_of_the_strip_goes_into_the_pad_file(
    app: typer.Typer, pad_file: Path, tmp_path: Path
) -> None:
    photo = tmp_path / "strip.png"
    photo.write_bytes(strip_photo([[0.55, 0, 0.45], [0, 1, 0], [0.45, 0, 0.55]]))
    done = CliRunner().invoke(app, ["crosstalk", str(pad_file), str(photo)])
    assert done.exit_code == 0, done.output
    assert "red stands out by 10%" in done.output
    assert done.output.count("too close") == 1
    kept = Pad.load(pad_file).crosstalk
    assert kept is not None
    np.testing.assert_allclose(kept[0], [0.55, 0, 0.45], atol=0.01)
    CliRunner().invoke(app, ["crosstalk", str(pad_file), "--forget"])
    assert Pad.load(pad_file).crosstalk is None


def test_a_strip_that_is_of_no_use_leaves_the_pad_as_it_was(
    app: typer.Typer, pad_file: Path, tmp_path: Path
) -> None:
    photo = tmp_path / "strip.png"
    photo.write_bytes(strip_photo(light=255))
    done = CliRunner().invoke(app, ["crosstalk", str(pad_file), str(photo)])
    assert (done.exit_code, "overexposed" in done.output) == (2, True)
    assert CliRunner().invoke(app, ["crosstalk", str(pad_file)]).exit_code == 2
    assert Pad.load(pad_file).crosstalk is None
