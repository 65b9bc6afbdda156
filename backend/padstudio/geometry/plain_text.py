"""Reads untrusted YAML and JSON as plain values: nothing executes, nothing expands.

YAML is read with PyYAML's safe loader, without aliases (a few hundred bytes of them can stand for
gigabytes) and with the tags of OpenCV's matrices.
"""

from __future__ import annotations

import json
from typing import Any

import yaml

from padstudio.errors import CameraFormatError

#: A YAML calibration is some kilobytes; the loader reads about 100 kB a second.
MAX_YAML_BYTES = 100_000
#: PhotonVision keeps its snapshots inside its JSON.
MAX_JSON_BYTES = 32_000_000


class _Loader(yaml.SafeLoader):
    """The safe loader, which in addition knows OpenCV's matrices and refuses aliases."""

    def compose_node(self, parent: Any, index: Any) -> Any:
        if self.check_event(yaml.AliasEvent):
            mark = self.get_mark()
            raise yaml.MarkedYAMLError(problem="aliases are not read", problem_mark=mark)
        return super().compose_node(parent, index)


def _opencv_matrix(loader: yaml.SafeLoader, node: yaml.MappingNode) -> dict[Any, Any]:
    return loader.construct_mapping(node, deep=True)


for _tag in ("opencv-matrix", "opencv-nd-matrix"):
    _Loader.add_constructor(f"tag:yaml.org,2002:{_tag}", _opencv_matrix)


def parse(data: bytes, name: str) -> Any:
    """Plain values (dict, list, str, number, bool, None) from YAML or JSON text.

    Parameters
    ----------
    data : bytes
        UTF-8 text; it is JSON if it starts with ``{`` or ``[``, else YAML with or without
        OpenCV's ``%YAML:1.0`` line.
    name : str
        What messages call the file.

    Raises
    ------
    CameraFormatError
        If it is too large, no text, or ill-formed, with the line where that is known.
    """
    is_json = data.lstrip(b"\xef\xbb\xbf \t\r\n")[:1] in (b"{", b"[")
    limit = MAX_JSON_BYTES if is_json else MAX_YAML_BYTES
    if len(data) > limit:
        raise CameraFormatError(
            f"{name}: {len(data)} bytes; a camera file has at most {limit}. Give the calibration "
            "file, not its pictures"
        )
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise CameraFormatError(
            f"{name}: byte {error.start} is no UTF-8 text; give a YAML or JSON camera file"
        ) from error
    return _json(text, name) if is_json else _yaml(text, name)


def _json(text: str, name: str) -> Any:
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        raise CameraFormatError(f"{name}: ill-formed JSON: {error}") from error


def _yaml(text: str, name: str) -> Any:
    # OpenCV 4's first line, "%YAML:1.0", is no directive that YAML knows; blank it, so that the
    # line numbers of messages stay true.
    if text.startswith("%YAML"):
        text = text[text.find("\n") :] if "\n" in text else ""
    try:
        return yaml.load(text, _Loader)
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise CameraFormatError(f"{name}: ill-formed YAML: {_reason(error)}") from error


def _reason(error: Exception) -> str:
    if isinstance(error, yaml.MarkedYAMLError) and error.problem_mark is not None:
        return f"line {error.problem_mark.line + 1}: {error.problem}"
    return " ".join(str(error).split())
