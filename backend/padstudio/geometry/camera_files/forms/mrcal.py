"""mrcal's ``.cameramodel``: a Python dictionary with comments, read without Python.

References
----------
https://mrcal.secretsauce.net/cameramodels.html, https://mrcal.secretsauce.net/lensmodels.html: the
models LENSMODEL_PINHOLE and LENSMODEL_OPENCV4 … 12 are OpenCV's, as are its pixels.
"""

from __future__ import annotations

import json
import re
from typing import Any

import numpy as np

from padstudio.errors import CameraFormatError
from padstudio.geometry.camera_files.parts.fields import (
    Asked,
    CameraFields,
    LensFields,
    camera_fields,
    refuse_choice,
)
from padstudio.geometry.camera_files.parts.lenses import Said, lens_of
from padstudio.geometry.camera_files.parts.plain_text import json_values
from padstudio.geometry.camera_files.parts.values import numbers, pinhole, word

MODELS = {f"LENSMODEL_OPENCV{count}": count for count in (4, 5, 8, 12)} | {"LENSMODEL_PINHOLE": 0}
_KNOWN = {
    "lensmodel",
    "intrinsics",
    "imagersize",
    # Where the camera sits, and how the calibration was made.
    "extrinsics",
    "rt_cam_ref",
    "rt_ref_cam",
    "valid_intrinsics_region",
    "icam_intrinsics",
    "optimization_inputs",
}
_TOKEN = re.compile(r"""#[^\n]*|b?'[^'\\\n]*'|b?"[^"\\\n]*"|None|True|False""")
_WORDS = {"None": "null", "True": "true", "False": "false"}
_HEAD = 20_000


def is_mrcal(text: str) -> bool:
    """True for a dictionary that names a lens and the imager's size as mrcal does."""
    head = re.sub(r"^(\s|#[^\n]*)*", "", text[:_HEAD])
    quoted = r"""['"]{}['"]\s*:"""
    return head.startswith("{") and all(
        re.search(quoted.format(key), text) for key in ("lensmodel", "imagersize")
    )


def read(text: str, stem: str, asked: Asked) -> CameraFields:
    """Fields of its camera."""
    refuse_choice(asked)
    values = _plain(text)
    for key in values:
        if key not in _KNOWN:
            raise CameraFormatError(
                f"the key {key[:80]!r} is not known; understood are lensmodel, intrinsics and "
                "imagersize. Remove it if it says nothing of the lens"
            )
    model = word(values.get("lensmodel"), "lensmodel")
    if model not in MODELS:
        raise CameraFormatError(
            f"lensmodel is {model[:80]!r}, a lens model that is not read; fit "
            "LENSMODEL_OPENCV8 with mrcal-convert-lensmodel"
        )
    intrinsics = numbers(values.get("intrinsics"), "intrinsics")
    if len(intrinsics) != 4 + MODELS[model]:
        raise CameraFormatError(
            f"{model} has {4 + MODELS[model]} intrinsics, and it holds {len(intrinsics)}"
        )
    size = values.get("imagersize")
    return camera_fields(size, pinhole(*intrinsics[:4]), _lens(intrinsics[4:], asked), stem)


def _lens(coefficients: Any, asked: Asked) -> LensFields:
    if not len(coefficients):
        return LensFields("radtan", np.zeros(0))
    return lens_of(Said([("lensmodel", "opencv")], coefficients), asked)


def _plain(text: str) -> dict[str, Any]:
    """The dictionary, by way of JSON: comments, quotes and last commas are what differs."""
    plain = _TOKEN.sub(_json_token, text)
    plain = re.sub(r",(\s*[\]}])", r"\1", plain).replace("(", "[").replace(")", "]")
    values = json_values(plain)
    if not isinstance(values, dict):
        raise CameraFormatError("holds no keys and values; give a camera calibration")
    return values


def _json_token(match: re.Match[str]) -> str:
    token = match[0]
    if token.startswith("#"):
        return ""
    return _WORDS.get(token) or json.dumps(token.removeprefix("b")[1:-1])
