"""Untrusted JSON and YAML as plain values: nothing executes, nothing expands, sizes are bounded."""

from __future__ import annotations

import json
import re
from typing import Any

from padstudio.errors import CameraFormatError

#: Of YAML, XML and tables of text.
MAX_TEXT_BYTES = 2_000_000
#: PhotonVision keeps its snapshots inside its JSON.
MAX_JSON_BYTES = 32_000_000
#: What is left of JSON without its long texts; some twenty times as much when it is parsed.
MAX_JSON_VALUES_BYTES = 8_000_000
# Longer texts are pictures, which are not kept.
_LONGEST_TEXT = 4_000
# One pass, whatever is in it: nothing is tried twice, and a text without an end goes to the last.
_JSON_TEXT = re.compile(r'"[^"\\]*+(?:\\.?[^"\\]*+)*+(?:"|\Z)', re.DOTALL)
_CONTROL = re.compile(r"[\x00-\x08\x0e-\x1a\x1c-\x1f\x7f]")


def decode(data: bytes, limit: int) -> str:
    """Text of a file, UTF-8 or UTF-16; what is neither is taken for Windows-1252.

    Numbers and keys are ASCII in all of these; only a note or a date may come out wrong.

    Raises
    ------
    CameraFormatError
        If it is larger than a limit, or no text.
    """
    if len(data) > limit:
        raise CameraFormatError(
            f"{len(data)} bytes; a camera file has at most {limit}. Give the calibration file, not "
            "its pictures"
        )
    try:
        wide = data.startswith((b"\xff\xfe", b"\xfe\xff"))
        text = data.decode("utf-16" if wide else "utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("cp1252", "replace")
    odd = _CONTROL.search(text)
    if odd:
        raise CameraFormatError(
            f"character {odd.start()} is no text; give a camera file of YAML, JSON, XML or text"
        )
    return text.replace("\r\n", "\n")


def json_values(text: str) -> Any:
    """Plain values of JSON text; texts longer than some kilobytes come out empty.

    Raises
    ------
    CameraFormatError
        If it is ill-formed, says a key twice, or too much is left.
    """
    if len(text) > MAX_JSON_VALUES_BYTES:
        text = _without_pictures(text)
    try:
        return json.loads(text, object_pairs_hook=_unique)
    except (ValueError, RecursionError) as error:
        raise CameraFormatError(f"ill-formed JSON: {error}") from error


def yaml_values(text: str) -> Any:
    """Plain values of YAML text, its first document, with or without OpenCV's ``%YAML:1.0``.

    Raises
    ------
    CameraFormatError
        If it is ill-formed, with the line where that is known.
    """
    # The reader of YAML takes its time to load, and many files are JSON.
    import yaml

    from padstudio.geometry.camera_files.parts import yaml_text

    try:
        return yaml_text.parse(text)
    except yaml.YAMLError as error:
        place = getattr(error, "problem_mark", None)
        problem = getattr(error, "problem", None) or " ".join(str(error).split())
        where = f"line {place.line + 1}: " if place else ""
        raise CameraFormatError(f"ill-formed YAML: {where}{problem}") from error


def _without_pictures(text: str) -> str:
    pieces, start, left_out = [], 0, 0
    for match in _JSON_TEXT.finditer(text):
        if match.start() - left_out > MAX_JSON_VALUES_BYTES:
            break
        if match.end() - match.start() > _LONGEST_TEXT:
            pieces += [text[start : match.start()], '""']
            start = match.end()
            left_out += match.end() - match.start()
    if len(text) - left_out > MAX_JSON_VALUES_BYTES:
        raise CameraFormatError(
            f"more than {MAX_JSON_VALUES_BYTES} characters besides its pictures; give the "
            "calibration alone"
        )
    return "".join([*pieces, text[start:]])


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    values: dict[str, Any] = {}
    for key, value in pairs:
        if key in values:
            raise ValueError(f"{key} stands twice; leave one")
        values[key] = value
    return values
