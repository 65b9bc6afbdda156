"""Cameras of OpenSfM and OpenDroneMap, ``cameras.json``: lengths over the picture's longer side.

Their pixels: the centre of the picture is (width - 1) / 2, as in OpenCV's.

References
----------
https://opensfm.org/docs/geometry.html; ``opensfm/features.py`` (normalized_image_coordinates) and
``opensfm/io.py`` (camera_from_object) of https://github.com/mapillary/OpenSfM. OpenDroneMap writes
the same file.
"""

from __future__ import annotations

import numpy as np

from padstudio.arrays import Array
from padstudio.errors import CameraFormatError
from padstudio.geometry.camera_files.parts.fields import (
    Asked,
    CameraFields,
    Data,
    LensFields,
    camera_fields,
    choose,
)
from padstudio.geometry.camera_files.parts.values import one_number, pinhole, whole_size, word

#: OpenSfM's models that are the same thing as one of ours, and their parameters.
MODELS = {
    "perspective": "focal k1 k2",
    "simple_radial": "focal_x focal_y c_x c_y k1",
    "radial": "focal_x focal_y c_x c_y k1 k2",
    "brown": "focal_x focal_y c_x c_y k1 k2 p1 p2 k3",
    "fisheye": "focal k1 k2",
    "fisheye_opencv": "focal_x focal_y c_x c_y k1 k2 k3 k4",
}
_COEFFICIENTS = {"radtan": ("k1", "k2", "p1", "p2", "k3"), "fisheye": ("k1", "k2", "k3", "k4")}


def is_opensfm(values: Data) -> bool:
    """True where every value is such a camera."""
    cameras = values.values()
    return bool(values) and all(isinstance(v, dict) and "projection_type" in v for v in cameras)


def read(values: Data, stem: str, asked: Asked) -> CameraFields:
    """Fields of the camera that is meant."""
    name, camera = choose(values, asked)
    model = word(camera["projection_type"], "projection_type")
    if model not in MODELS:
        raise CameraFormatError(
            f"projection_type is {model[:60]!r}, a lens model that is not read; "
            f"{', '.join(MODELS)} are"
        )
    names = MODELS[model].split()
    known = {*names, "projection_type", "width", "height"}
    for key in camera:
        # What was known before the reconstruction stands beside what came of it.
        if key not in known and not key.endswith("_prior"):
            raise CameraFormatError(
                f"the key {key[:80]!r} is none of a {model} camera, which has {', '.join(names)}; "
                "remove it if it says nothing of the lens"
            )
    missing = [key for key in (*names, "width", "height") if camera.get(key) is None]
    if missing:
        raise CameraFormatError(f"has no {missing[0]}, which a {model} camera has")
    size = whole_size([camera["width"], camera["height"]], "image size")
    given = {key: one_number(camera[key], key) for key in names}
    return camera_fields(list(size), _matrix(given, size), _lens(model, given), name)


def _matrix(given: dict[str, float], size: tuple[int, int]) -> Array:
    width, height = size
    longer = max(size)
    return pinhole(
        longer * (given["focal"] if "focal" in given else given["focal_x"]),
        longer * (given["focal"] if "focal" in given else given["focal_y"]),
        longer * given.get("c_x", 0.0) + (width - 1) / 2,
        longer * given.get("c_y", 0.0) + (height - 1) / 2,
    )


def _lens(model: str, given: dict[str, float]) -> LensFields:
    kind = "fisheye" if model.startswith("fisheye") else "radtan"
    coefficients = np.array([given.get(key, 0.0) for key in _COEFFICIENTS[kind]])
    return LensFields("fisheye" if kind == "fisheye" else "radtan", coefficients)
