from __future__ import annotations

import io
import zipfile
from pathlib import Path

import numpy as np
import pytest
from measure_print import make_pad, pdf_info

from padstudio.errors import LimitError, SpecError
from padstudio.pad.sheets.tiling import SheetOptions
from padstudio.render import documents
from padstudio.render.painters.options import PrintOptions


@pytest.mark.parametrize(
    ("form", "media_type", "name", "magic"),
    [
        ("pdf", "application/pdf", "Hof-3.pdf", b"%PDF"),
        ("svg", "image/svg+xml", "Hof-3.svg", b"<?xml"),
        ("png", "image/png", "Hof-3.png", b"\x89PNG"),
        ("dxf", "image/vnd.dxf", "Hof-3.dxf", b"0\nSECTION"),
        ("csv", "application/zip", "Hof-3.zip", b"PK"),
        ("npy", "application/zip", "Hof-3.zip", b"PK"),
        ("strip", "application/pdf", "Hof-3-strip.pdf", b"%PDF"),
    ],
)
def test_every_form_is_made(form: documents.Form, media_type: str, name: str, magic: bytes) -> None:
    pieces, made_type, made_name = documents.make(make_pad(name="Hof 3 🚁"), form)
    content = b"".join(pieces)
    assert (made_type, made_name) == (media_type, name)
    assert content.startswith(magic)
    again = b"".join(documents.make(make_pad(name="Hof 3 🚁"), form)[0])
    assert again == content


def test_tables_hold_the_fields() -> None:
    pad = make_pad(levels=4)
    with zipfile.ZipFile(io.BytesIO(b"".join(documents.make(pad, "npy")[0]))) as archive:
        for layer in pad.layers:
            field = np.load(io.BytesIO(archive.read(f"{layer.channel}.npy")))
            np.testing.assert_array_equal(field, layer.field)
    pieces, media_type, name = documents.make(pad, "csv", channel="blue")
    assert (media_type, name) == ("text/csv", "pad.csv")
    table = np.loadtxt(io.BytesIO(b"".join(pieces)), delimiter=",", dtype=int)
    np.testing.assert_array_equal(table, pad.layers[1].field)


def test_default_pdf_is_one_page_of_the_pads_size(tmp_path: Path) -> None:
    info = pdf_info(b"".join(documents.make(make_pad(), "pdf")[0]), tmp_path)
    assert "Pages:           1" in info
    width = float(info.split("Page size:")[1].split()[0])
    assert width == pytest.approx(250 / 25.4 * 72, abs=0.01)


def test_bad_requests_are_found_before_the_first_byte() -> None:
    pad = make_pad()
    with pytest.raises(SpecError, match="no form of a pad"):
        documents.make(pad, "bmp")  # type: ignore[arg-type]
    with pytest.raises(SpecError, match="has no green layer"):
        documents.make(pad, "csv", channel="green")
    with pytest.raises(SpecError, match="quiet margin"):
        documents.make(pad, "pdf", PrintOptions(header="x"))
    with pytest.raises(LimitError, match="lower the resolution"):
        documents.make(pad, "png", PrintOptions(dpi=50_000))
    with pytest.raises(SpecError, match="too small"):
        documents.make(pad, "strip", PrintOptions(sheets=SheetOptions(paper="150x150")))


@pytest.mark.parametrize(
    ("name", "stem"),
    [("Hof 3", "Hof-3"), ("שלום", "pad"), ("../../etc/x", "etc-x"), ("Größe", "Groe"), ("", "pad")],
)
def test_file_names_are_plain(name: str, stem: str) -> None:
    assert documents.file_stem(name) == stem


@pytest.mark.parametrize(
    "options",
    [
        {"ink": "gold"},
        {"outline_mm": -1.0},
        {"header": "x" * 201},
        {"measured": (0.5, 1.0)},
        {"measured": (float("nan"), 1.0)},
    ],
)
def test_bad_print_options_are_refused(options: dict[str, object]) -> None:
    with pytest.raises(SpecError):
        PrintOptions(**options)  # type: ignore[arg-type]
