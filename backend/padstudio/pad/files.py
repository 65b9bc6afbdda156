"""The pad file: JSON with ``format`` "padstudio.pad", ``version`` 1 (docs/conventions.md).

Reads into plain fields and writes from them; `padstudio.pad.spec` makes pads of these.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from padstudio.bounded_files import read_whole
from padstudio.errors import PadFormatError, shown

FORMAT = "padstudio.pad"
VERSION = 1
# 4000 x 4000 digits and their punctuation, twice.
MAX_BYTES = 64_000_000
# Levels 0 … 35; `padstudio.pad.spec.MAX_LEVELS` goes as far as they do.
_DIGITS = "0123456789abcdefghijklmnopqrstuvwxyz"
# Left out of the file where nobody knows them.
_OPTIONAL = ("seed", "method", "unique", "distance", "layer_fields")
_CHOICES = {"unique": ("rotation", "plain"), "layer_fields": ("independent", "paper")}


class LayerFields(NamedTuple):
    """A layer as a pad file holds it: `padstudio.pad.spec.Layer`, unchecked."""

    channel: str
    cell_mm: float
    field: NDArray[np.uint8]


class PadFields(NamedTuple):
    """A pad as a pad file holds it: `padstudio.pad.spec.Pad`, unchecked."""

    layers: tuple[LayerFields, ...]
    window: int
    levels: int
    quiet_mm: float
    name: str
    seed: int | None
    method: str | None
    unique: str | None
    distance: int | None
    visible_lines: bool
    layer_fields: str | None
    scale: tuple[float, float]
    crosstalk: Any


def read(path: Path) -> bytes:
    """The bytes of a pad file.

    Raises
    ------
    PadFormatError
        If it cannot be read, or is larger than any pad.
    """
    try:
        data = read_whole(path, MAX_BYTES)
    except OSError as error:
        raise PadFormatError(f"cannot read {path.name}: {error.strerror}") from error
    if len(data) > MAX_BYTES:
        raise PadFormatError(f"{path.name}: larger than {MAX_BYTES} bytes; no pad is")
    return data


def parse(text: str | bytes) -> Any:
    """The JSON of a pad file's text; raises `PadFormatError` where it is none."""
    if len(text) > MAX_BYTES:
        raise PadFormatError(f"the pad file is larger than {MAX_BYTES} bytes; no pad is")
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        raise PadFormatError(f"the pad file is not JSON: {error}") from error


def to_text(pad: PadFields) -> str:
    """The text of a pad file; equal pads give equal texts."""
    return json.dumps(to_dict(pad), indent=1, ensure_ascii=False) + "\n"


def to_dict(pad: PadFields) -> dict[str, Any]:
    """The JSON object of a pad file."""
    data: dict[str, Any] = {
        "format": FORMAT,
        "version": VERSION,
        "name": pad.name,
        "window": pad.window,
        "levels": pad.levels,
        "quiet_mm": pad.quiet_mm,
    }
    data |= {key: getattr(pad, key) for key in _OPTIONAL if getattr(pad, key) is not None}
    if pad.visible_lines:
        data["visible_lines"] = True
    if pad.scale != (1.0, 1.0):
        data["scale"] = list(pad.scale)
    if pad.crosstalk is not None:
        data["crosstalk"] = [list(row) for row in pad.crosstalk]
    data["layers"] = [
        {"channel": layer.channel, "cell_mm": layer.cell_mm, "codes": to_codes(layer.field)}
        for layer in pad.layers
    ]
    return data


def from_dict(data: Any) -> PadFields:
    """The fields of a pad file's JSON object.

    Raises
    ------
    PadFormatError
        If it is ill-formed, with the place and the reason.
    """
    if not isinstance(data, dict):
        raise PadFormatError("the pad file must hold a JSON object")
    if data.get("format") != FORMAT:
        raise PadFormatError(
            f"format is {shown(data.get('format'))}, not {FORMAT!r}: this is no pad file"
        )
    if data.get("version") != VERSION:
        raise PadFormatError(
            f"version is {shown(data.get('version'))}; this program reads version {VERSION}"
        )
    layers = data.get("layers")
    if not isinstance(layers, list):
        raise PadFormatError("layers is missing or no list")
    return PadFields(
        layers=tuple(_layer(item, place) for place, item in enumerate(layers)),
        window=_integer(data, "window"),
        levels=_integer(data, "levels"),
        quiet_mm=_number(data, "quiet_mm", default=0.0),
        name=_text(data, "name", default="pad", limit=200),
        seed=_optional_integer(data, "seed"),
        method=_optional_text(data, "method"),
        unique=_choice(data, "unique"),
        distance=_optional_integer(data, "distance"),
        visible_lines=_truth(data, "visible_lines"),
        layer_fields=_choice(data, "layer_fields"),
        scale=_scale(data),
        crosstalk=data.get("crosstalk"),
    )


def to_codes(field: NDArray[np.uint8]) -> list[str]:
    """Rows of base-36 digits of a field (rows, cols) of levels 0 … 35."""
    table = np.frombuffer(_DIGITS.encode(), np.uint8)
    return [row.tobytes().decode() for row in table[field]]


def from_codes(codes: Any, place: str) -> NDArray[np.uint8]:
    """The field (rows, cols) uint8 from rows of digits.

    Raises
    ------
    PadFormatError
        If a row is no text, has another length than the first, or holds no digit, naming it.
    """
    if not isinstance(codes, list) or not codes:
        raise PadFormatError(f"{place}.codes is missing or no list of rows")
    values = np.full(256, 255, np.uint8)
    for level, digit in enumerate(_DIGITS):
        values[ord(digit)] = values[ord(digit.upper())] = level
    rows = []
    for number, row in enumerate(codes):
        if not isinstance(row, str) or not row.isascii():
            raise PadFormatError(f"{place}.codes[{number}] is no row of digits")
        if len(row) != len(codes[0]):
            raise PadFormatError(
                f"{place}.codes[{number}] has {len(row)} cells, row 0 has {len(codes[0])}: all "
                "rows must be of one length"
            )
        levels = values[np.frombuffer(row.encode(), np.uint8)]
        if (levels == 255).any():
            column = int(np.argmax(levels == 255))
            raise PadFormatError(
                f"{place}.codes[{number}], column {column}: {row[column]!r} is no base-36 digit"
            )
        rows.append(levels)
    return np.stack(rows)


def _layer(item: Any, number: int) -> LayerFields:
    place = f"layers[{number}]"
    if not isinstance(item, dict):
        raise PadFormatError(f"{place} is no object")
    return LayerFields(
        channel=_text(item, "channel", place=place),
        cell_mm=_number(item, "cell_mm", place=place),
        field=from_codes(item.get("codes"), place),
    )


def _at(place: str, key: str) -> str:
    return f"{place}.{key}" if place else key


def _number(data: dict[str, Any], key: str, *, place: str = "", default: Any = None) -> float:
    value = data.get(key, default)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise PadFormatError(f"{_at(place, key)} is {shown(value)}; it must be a number")
    try:
        return float(value)
    except OverflowError as error:
        raise PadFormatError(f"{_at(place, key)} is too large") from error


def _integer(data: dict[str, Any], key: str) -> int:
    value = data.get(key)
    if isinstance(value, bool) or not isinstance(value, int):
        raise PadFormatError(f"{key} is {shown(value)}; it must be a whole number")
    return value


def _truth(data: dict[str, Any], key: str) -> bool:
    value = data.get(key, False)
    if not isinstance(value, bool):
        raise PadFormatError(f"{key} is {shown(value)}; it must be true or false")
    return value


def _optional_integer(data: dict[str, Any], key: str) -> int | None:
    return None if data.get(key) is None else _integer(data, key)


def _text(
    data: dict[str, Any], key: str, *, place: str = "", default: Any = None, limit: int = 100
) -> str:
    value = data.get(key, default)
    if not isinstance(value, str) or len(value) > limit:
        raise PadFormatError(f"{_at(place, key)} must be a text of at most {limit} characters")
    return value


def _optional_text(data: dict[str, Any], key: str) -> str | None:
    return None if data.get(key) is None else _text(data, key)


def _choice(data: dict[str, Any], key: str) -> Any:
    value, choices = data.get(key), _CHOICES[key]
    if value not in (None, *choices):
        raise PadFormatError(f"{key} is {shown(value)}; it must be {' or '.join(choices)}")
    return value


def _scale(data: dict[str, Any]) -> tuple[float, float]:
    value = data.get("scale", 1.0)
    pair = value if isinstance(value, list) else [value, value]
    if len(pair) != 2 or any(isinstance(v, bool) or not isinstance(v, int | float) for v in pair):
        raise PadFormatError("scale must be a number, or two: x and y")
    try:
        return float(pair[0]), float(pair[1])
    except OverflowError as error:
        raise PadFormatError("scale is too large; it must lie within 0.5 … 2") from error
