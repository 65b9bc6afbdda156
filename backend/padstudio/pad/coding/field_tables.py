"""Read a field of levels from a table or a picture that another program wrote."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from padstudio.errors import PadFormatError
from padstudio.pad.spec import MAX_CELLS, MAX_LEVELS

U8 = NDArray[np.uint8]

# 4000 x 4000 numbers of one or two digits and their commas, with room to spare.
MAX_BYTES = 64_000_000
# Forms without loss; a JPEG would blur levels.
_PICTURES = (".png", ".bmp", ".tif", ".tiff", ".gif", ".pgm", ".pbm")
# A marker-field text marks cells that were never filled by 2, and holes by 3.
_UNFILLED, _HOLE = 2, 3


def load_field(path: str | Path, *, levels: int | None = None) -> U8:
    """Read a field; the form goes by the file's suffix.

    Parameters
    ----------
    path : path
        ``.csv`` (also tab or semicolon), ``.npy``, ``.field`` or ``.txt`` (marker-field text), or
        a picture of one pixel a cell.
    levels : int, optional
        Y for a picture, whose grey values 0 … 255 are spread evenly over Y levels; unless given,
        each grey value that occurs is a level.

    Returns
    -------
    (rows, cols) uint8
        Levels.

    Raises
    ------
    PadFormatError
        If it cannot be read, or is ill-formed, with the place and the reason.
    """
    path = Path(path)
    try:
        if path.stat().st_size > MAX_BYTES:
            raise PadFormatError(f"{path.name} is larger than {MAX_BYTES} bytes; no field is")
        data = path.read_bytes()
    except OSError as error:
        raise PadFormatError(f"cannot read {path.name}: {error.strerror}") from error
    return read_field(data, path.suffix, levels=levels)


def read_field(data: bytes, suffix: str, *, levels: int | None = None) -> U8:
    """Read a field from a file's bytes; as `load_field`."""
    suffix = suffix.lower()
    if suffix in (".csv", ".tsv"):
        return _from_csv(data)
    if suffix == ".npy":
        return _from_npy(data)
    if suffix in (".field", ".txt"):
        return _from_marker_field(data)
    if suffix in _PICTURES:
        return _from_picture(data, levels)
    raise PadFormatError(
        f"no field is read from {suffix or 'a file without a suffix'}; give .csv, .npy, .field or "
        f"a picture of one pixel a cell ({', '.join(_PICTURES)})"
    )


def _from_csv(data: bytes) -> U8:
    text = _text(data, "CSV")
    delimiter = next((d for d in ",;\t" if d in text), ",")
    rows = [row for row in csv.reader(io.StringIO(text), delimiter=delimiter) if row]
    numbers: list[list[int]] = []
    for number, row in enumerate(rows):
        cells = row[:-1] if len(row) > 1 and not row[-1].strip() else row
        if numbers and len(cells) != len(numbers[0]):
            raise PadFormatError(
                f"row {number} has {len(cells)} cells, row 0 has {len(numbers[0])}: all rows must "
                "be of one length"
            )
        try:
            numbers.append([int(cell) for cell in cells])
        except ValueError as error:
            raise PadFormatError(f"row {number}: {error}; cells must be whole numbers") from error
    if not numbers:
        raise PadFormatError("the table is empty")
    return _field(_array(numbers))


def _from_npy(data: bytes) -> U8:
    try:
        array = np.load(io.BytesIO(data), allow_pickle=False)
    except (ValueError, EOFError, OSError, MemoryError) as error:
        raise PadFormatError(f"the file is no NPY array: {error}") from error
    if not isinstance(array, np.ndarray) or array.dtype.kind not in "biu":
        raise PadFormatError("the array must hold whole numbers or booleans")
    return _field(array)


def _from_marker_field(data: bytes) -> U8:
    """Rows, columns, then the cells in reading order; the tag shapes that follow are not needed."""
    words = _text(data, "a marker field").split()
    try:
        rows, cols = int(words[0]), int(words[1])
        if not (1 <= rows <= MAX_CELLS and 1 <= cols <= MAX_CELLS):
            raise PadFormatError(f"{rows} x {cols} cells; the limit is {MAX_CELLS} a side")
        cells = [int(word) for word in words[2 : 2 + rows * cols]]
    except (ValueError, IndexError) as error:
        raise PadFormatError(
            "a marker field begins with its rows and columns, then one number a cell"
        ) from error
    if len(cells) < rows * cols:
        raise PadFormatError(f"{rows} x {cols} cells are announced, {len(cells)} are there")
    field = _array(cells).reshape(rows, cols)
    if _HOLE in field or _UNFILLED in field:
        row, col = np.argwhere((field == _HOLE) | (field == _UNFILLED))[0]
        kind = "a hole" if field[row, col] == _HOLE else "not filled"
        raise PadFormatError(f"row {row}, column {col} is {kind}; a pad needs every cell")
    return _field(field)


def _from_picture(data: bytes, levels: int | None) -> U8:
    from PIL import Image

    try:
        with Image.open(io.BytesIO(data)) as picture:
            if max(picture.size) > MAX_CELLS:
                width, height = picture.size
                raise PadFormatError(
                    f"the picture has {height} x {width} pixels; with one pixel a cell the limit "
                    f"is {MAX_CELLS} a side"
                )
            grey = np.asarray(picture.convert("L"))
    except PadFormatError:
        raise
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError) as error:
        raise PadFormatError(f"the file is no picture: {error}") from error
    if levels is not None:
        return np.round(grey / 255.0 * (levels - 1)).astype(np.uint8)
    values, field = np.unique(grey, return_inverse=True)
    if len(values) > MAX_LEVELS:
        raise PadFormatError(
            f"the picture has {len(values)} grey values; a field has at most {MAX_LEVELS} levels: "
            "save it without smoothing or JPEG, or say how many levels it has"
        )
    return field.reshape(grey.shape).astype(np.uint8)


def _text(data: bytes, kind: str) -> str:
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise PadFormatError(f"the file is no text, so it is not {kind}") from error


def _array(numbers: list[int] | list[list[int]]) -> NDArray[np.int64]:
    try:
        return np.array(numbers, np.int64)
    except OverflowError as error:
        raise PadFormatError("a cell's number is too large to be a level") from error


def _field(array: NDArray[np.generic]) -> U8:
    """The array as a field, checked for shape and range."""
    if array.ndim != 2 or not array.size or max(array.shape) > MAX_CELLS:
        raise PadFormatError(
            f"the table has the shape {array.shape}; a field has rows and columns, at most "
            f"{MAX_CELLS} each"
        )
    wrong = (array < 0) | (array >= MAX_LEVELS)  # type: ignore[operator]
    if wrong.any():
        row, col = np.argwhere(wrong)[0]
        raise PadFormatError(
            f"row {row}, column {col}: {array[row, col]} is no level 0 … {MAX_LEVELS - 1}"
        )
    return array.astype(np.uint8)
