"""Fields from tables and pictures: what went in comes out, what is wrong is named."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from padstudio.errors import PadFormatError
from padstudio.pad.coding.field_tables import load_field, read_field

FIELD = np.random.default_rng(5).integers(0, 3, (7, 11)).astype(np.uint8)


def npy(array: NDArray[np.generic]) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, array)
    return buffer.getvalue()


def png(grey: NDArray[np.uint8], mode: str = "L") -> bytes:
    buffer = io.BytesIO()
    Image.fromarray(grey).convert(mode).save(buffer, "PNG")
    return buffer.getvalue()


def marker_field(field: NDArray[np.uint8]) -> bytes:
    cells = " ".join(map(str, field.ravel()))
    shape = " ".join(["1"] * 9)
    return f"{field.shape[0]} {field.shape[1]}\n{cells} \n1\n3 3\n{shape} \n".encode()


@pytest.mark.parametrize("delimiter", [",", ";", "\t", ", "])
def test_csv(delimiter: str) -> None:
    text = "\n".join(delimiter.join(map(str, row)) for row in FIELD)
    np.testing.assert_array_equal(read_field(text.encode(), ".csv"), FIELD)
    np.testing.assert_array_equal(read_field(("\ufeff" + text).encode(), ".CSV"), FIELD)


@pytest.mark.parametrize("dtype", [np.uint8, np.int64, np.uint16])
def test_npy(dtype: type) -> None:
    np.testing.assert_array_equal(read_field(npy(FIELD.astype(dtype)), ".npy"), FIELD)


def test_npy_of_booleans() -> None:
    np.testing.assert_array_equal(read_field(npy(FIELD > 0), ".npy"), FIELD > 0)


def test_marker_field_text() -> None:
    binary = (FIELD > 0).astype(np.uint8)
    np.testing.assert_array_equal(read_field(marker_field(binary), ".field"), binary)


def test_picture_of_one_pixel_a_cell() -> None:
    np.testing.assert_array_equal(read_field(png(FIELD * 100), ".png"), FIELD)
    binary = (FIELD > 0).astype(np.uint8)
    np.testing.assert_array_equal(read_field(png(binary * 255, "1"), ".png"), binary)


def test_picture_of_a_known_number_of_levels() -> None:
    grey = np.round(np.array([[0, 2, 3], [1, 1, 2]]) / 3 * 255).astype(np.uint8)
    np.testing.assert_array_equal(read_field(png(grey), ".png", levels=4), [[0, 2, 3], [1, 1, 2]])


def test_load_goes_by_the_suffix(tmp_path: Path) -> None:
    path = tmp_path / "field.npy"
    path.write_bytes(npy(FIELD))
    np.testing.assert_array_equal(load_field(path), FIELD)
    with pytest.raises(PadFormatError, match="cannot read"):
        load_field(tmp_path / "none.npy")


@pytest.mark.parametrize(
    ("data", "suffix", "words"),
    [
        (b"0,1\n1\n", ".csv", "row 1 has 1 cells, row 0 has 2"),
        (b"0,1\n1,x\n", ".csv", "row 1"),
        (b"0,1\n1,36\n", ".csv", "row 1, column 1: 36 is no level"),
        (b"0,1\n1,-1\n", ".csv", "row 1, column 1: -1 is no level"),
        (b"9" * 30, ".csv", "too large"),
        (b"", ".csv", "empty"),
        (b"\xff\xfe\x00", ".csv", "no text"),
        (b"junk", ".npy", "no NPY array"),
        (npy(np.zeros((2, 2))), ".npy", "whole numbers"),
        (npy(np.zeros(4, np.uint8)), ".npy", "shape"),
        (npy(np.zeros((1, 4001), np.uint8)), ".npy", "at most 4000"),
        (b"2 2\n0 1 1", ".field", "4 cells|2 x 2 cells are announced, 3 are there"),
        (b"2 2\n0 1 2 1\n", ".field", "row 1, column 0 is not filled"),
        (b"2 2\n0 1 3 1\n", ".field", "row 1, column 0 is a hole"),
        (b"hello", ".field", "begins with its rows and columns"),
        (b"9999999 9999999 0", ".field", "the limit is 4000"),
        (b"junk", ".png", "no picture"),
        (png(np.arange(100, dtype=np.uint8).reshape(10, 10)), ".png", "100 grey values"),
        (b"", ".xlsx", "no field is read from .xlsx"),
    ],
)
def test_what_is_wrong_is_named(data: bytes, suffix: str, words: str) -> None:
    with pytest.raises(PadFormatError, match=words):
        read_field(data, suffix)
