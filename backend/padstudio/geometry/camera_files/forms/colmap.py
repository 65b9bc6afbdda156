"""COLMAP's ``cameras.txt``: a line for each camera, its number, model, size and parameters.

COLMAP's pixels: (0.5, 0.5) is the centre of the top-left one, so the principal point is half a
pixel less in OpenCV's.

References
----------
https://colmap.github.io/format.html, https://colmap.github.io/cameras.html and
``src/colmap/sensor/models.h``, which has the models' formulas.
"""

from __future__ import annotations

import re

import numpy as np

from padstudio.errors import CameraFormatError
from padstudio.geometry.camera_files.parts.fields import (
    Asked,
    CameraFields,
    LensFields,
    camera_fields,
    choose,
)
from padstudio.geometry.camera_files.parts.values import numbers, pinhole

#: COLMAP's models that are the same thing as one of ours: how many parameters there are, and which
#: are the coefficients; models of one focal length begin with f.
MODELS = {
    "SIMPLE_PINHOLE": "f cx cy",
    "PINHOLE": "fx fy cx cy",
    "SIMPLE_RADIAL": "f cx cy k1",
    "RADIAL": "f cx cy k1 k2",
    "OPENCV": "fx fy cx cy k1 k2 p1 p2",
    "FULL_OPENCV": "fx fy cx cy k1 k2 p1 p2 k3 k4 k5 k6",
    "SIMPLE_RADIAL_FISHEYE": "f cx cy k1",
    "RADIAL_FISHEYE": "f cx cy k1 k2",
    "OPENCV_FISHEYE": "fx fy cx cy k1 k2 k3 k4",
}
_LINE = re.compile(r"\s*(\d+)\s+([A-Z][A-Z0-9_]+)\s+(.*)")
_MOST_CAMERAS = 100_000


def is_colmap(text: str) -> bool:
    """True where the first line that is no comment is one of such a file."""
    first = next((each for each in text.splitlines() if each.strip() and each[0] != "#"), "")
    return re.match(r"\s*\d+\s+[A-Z][A-Z0-9_]+\s+\d+\s+\d+\s", first) is not None


def read(text: str, stem: str, asked: Asked) -> CameraFields:
    """Fields of the camera that is meant, by its number."""
    lines: dict[str, str] = {}
    for line in text.splitlines():
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        parts = _LINE.fullmatch(line)
        if parts is None or len(lines) > _MOST_CAMERAS:
            raise CameraFormatError(f"{line[:60]!r} is no line of a COLMAP cameras.txt")
        if parts[1] in lines:
            raise CameraFormatError(f"camera {parts[1]} stands twice; leave one")
        lines[parts[1]] = f"{parts[2]} {parts[3]}"
    number, line = choose(lines, asked)
    model, *words = line.split()
    if model not in MODELS:
        raise CameraFormatError(
            f"camera {number} has the model {model}, which is not read; undistort with OPENCV, "
            "FULL_OPENCV or OPENCV_FISHEYE"
        )
    names = MODELS[model].split()
    values = numbers(words, f"camera {number}")
    if len(values) != 2 + len(names):
        raise CameraFormatError(
            f"camera {number} has {len(values)} numbers; {model} takes width, height and "
            f"{', '.join(names)}"
        )
    given = dict(zip(names, values[2:].tolist(), strict=True))
    matrix = pinhole(
        given["f"] if "f" in given else given["fx"],
        given["f"] if "f" in given else given["fy"],
        given["cx"] - 0.5,
        given["cy"] - 0.5,
    )
    name = stem if len(lines) == 1 else f"{stem} {number}"
    return camera_fields(values[:2].tolist(), matrix, _lens(model, given), name)


def _lens(model: str, given: dict[str, float]) -> LensFields:
    if model.endswith("FISHEYE"):
        angles = ("k1", "k2", "k3", "k4")
        return LensFields("fisheye", np.array([given.get(key, 0.0) for key in angles]))
    if model.endswith("PINHOLE"):
        return LensFields("radtan", np.zeros(0))
    keys = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")
    count = 8 if model == "FULL_OPENCV" else 4
    return LensFields("radtan", np.array([given.get(key, 0.0) for key in keys[:count]]))
