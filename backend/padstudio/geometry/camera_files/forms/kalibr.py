"""Kalibr's camchain YAML.

References
----------
https://github.com/ethz-asl/kalibr/wiki/yaml-formats
"""

from __future__ import annotations

import re
from typing import Any

from padstudio.errors import CameraFormatError
from padstudio.geometry.camera_files.parts.fields import (
    Asked,
    CameraFields,
    Data,
    camera_fields,
    choose,
)
from padstudio.geometry.camera_files.parts.keys import gather
from padstudio.geometry.camera_files.parts.lenses import NOT_SAID, SAY_SO, Said, lens_of, one_vector
from padstudio.geometry.camera_files.parts.values import numbers, pinhole, word

KEYS = {
    "cameramodel": "projection",
    "intrinsics": "intrinsics",
    "distortionmodel": "model",
    "distortioncoeffs": "distortion",
    "resolution": "size",
    "rostopic": "topic",
    "readoutms": "readout",
    "camoverlaps": "other",
    "timeshiftcamimu": "other",
}
_UNDERSTOOD = "camera_model, intrinsics, distortion_model, distortion_coeffs and resolution"
_MODELS = {"radtan": 4, "equidistant": 4, "none": 0}


def cameras_in(values: Data) -> list[str]:
    """Names of its cameras: cam0, cam1, …"""
    return [key for key in values if re.fullmatch(r"cam\d+", key)]


def read(values: Data, stem: str, asked: Asked) -> CameraFields:
    """Fields of the camera that is meant."""
    chain = cameras_in(values)
    gather({k: v for k, v in values.items() if k not in chain}, {}, "cam0, cam1, …")
    name, camera = choose({key: values[key] for key in chain}, asked)
    if not isinstance(camera, dict):
        raise CameraFormatError(f"{name} holds no keys and values")
    found = gather(camera, KEYS, _UNDERSTOOD)
    one: dict[str, Any] = {word: entries[0][1] for word, entries in found.items() if entries}
    projection = one.get("projection")
    if projection != "pinhole":
        raise CameraFormatError(
            f"camera_model is {str(projection)[:60]!r}; calibrate with pinhole-radtan or "
            "pinhole-equi"
            if projection
            else "it has no camera_model; Kalibr writes it (pinhole)"
        )
    intrinsics = numbers(one.get("intrinsics"), "intrinsics")
    if len(intrinsics) != 4:
        raise CameraFormatError(f"intrinsics has {len(intrinsics)} numbers, not fx, fy, cx, cy")
    said = Said(found["model"], one_vector(found["distortion"]))
    _check(one.get("model"), said, asked)
    return camera_fields(
        one.get("size"),
        pinhole(*intrinsics),
        lens_of(said, asked),
        str(one.get("topic", name)),
        readout=one.get("readout"),
    )


def _check(model: Any, said: Said, asked: Asked) -> None:
    """Refuse a lens that Kalibr does not write: its four coefficients may be of two models."""
    count = 0 if said.coefficients is None else len(said.coefficients)
    if model is None:
        if count or not asked.no_distortion:
            raise CameraFormatError(
                "it has no distortion_model, so its coefficients may be radtan's or "
                f"equidistant's; name it, or {SAY_SO}",
                code=NOT_SAID,
            )
    elif word(model, "distortion_model") not in _MODELS:
        raise CameraFormatError(
            f"distortion_model is {model[:60]!r}, a lens model that is not read; calibrate "
            "with pinhole-radtan or pinhole-equi"
        )
    elif count != _MODELS[model]:
        raise CameraFormatError(
            f"distortion_model {model} has {count} distortion_coeffs, not {_MODELS[model]}"
        )
