"""PhotonVision's calibration JSON, with its snapshots or without.

References
----------
https://docs.photonvision.org/en/latest/docs/calibration/calibration.html; the coefficients are
OpenCV's, under ``cameraExtrinsics`` in files of before 2024.
"""

from __future__ import annotations

from padstudio.errors import CameraFormatError
from padstudio.geometry.camera_files.parts.fields import (
    Asked,
    CameraFields,
    Data,
    camera_fields,
    refuse_choice,
)
from padstudio.geometry.camera_files.parts.keys import gather
from padstudio.geometry.camera_files.parts.lenses import Said, lens_of, one_vector
from padstudio.geometry.camera_files.parts.values import matrix_3x3, word

KEYS = {
    "resolution": "size",
    "cameraintrinsics": "matrix",
    "distcoeffs": "distortion",
    "cameraextrinsics": "distortion",
    "lensmodel": "model",
    "readoutms": "readout",
}
_UNDERSTOOD = "resolution, cameraIntrinsics, distCoeffs and lensmodel"
_MODELS = {f"LENSMODEL_OPENCV{count}" for count in ("", 4, 5, 8)}


def read(values: Data, stem: str, asked: Asked) -> CameraFields:
    """Fields of its camera."""
    refuse_choice(asked)
    found = gather(values, KEYS, _UNDERSTOOD)
    one = {word: entries[0][1] for word, entries in found.items() if entries}
    model = word(one.get("model", "LENSMODEL_OPENCV"), "lensmodel")
    if model not in _MODELS:
        raise CameraFormatError(
            f"lensmodel is {model[:60]!r}, a lens model that is not read; calibrate with "
            "LENSMODEL_OPENCV"
        )
    coefficients = one_vector(found["distortion"])
    count = model.removeprefix("LENSMODEL_OPENCV")
    if count and coefficients is not None and len(coefficients) != int(count):
        raise CameraFormatError(f"lensmodel {model} has {len(coefficients)} distCoeffs")
    return camera_fields(
        one.get("size"),
        matrix_3x3(one.get("matrix"), "cameraIntrinsics"),
        lens_of(Said([("lensmodel", "opencv")], coefficients), asked),
        stem,
        readout=one.get("readout"),
    )
