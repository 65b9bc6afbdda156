"""ROS ``camera_info`` files and messages, and OpenCV's ``FileStorage`` as YAML, JSON and XML.

They differ in the spelling of keys alone, as do the files of many scripts and of calibdb, so case
and signs do not count and several names of one thing are read.

References
----------
https://wiki.ros.org/camera_calibration_parsers, OpenCV's ``samples/cpp/calibration.cpp`` and
``camera_calibration.cpp``.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from padstudio.arrays import Array
from padstudio.errors import CameraFormatError
from padstudio.geometry.camera_files.forms.window import apply_window, read_window, window_note
from padstudio.geometry.camera_files.parts.fields import (
    Asked,
    CameraFields,
    Data,
    camera_fields,
    refuse_choice,
)
from padstudio.geometry.camera_files.parts.keys import gather, plain
from padstudio.geometry.camera_files.parts.lenses import (
    FISHEYE_NAMES,
    FOREIGN_NAMES,
    NONE_NAMES,
    RADTAN_NAMES,
    Said,
    lens_of,
    one_vector,
)
from padstudio.geometry.camera_files.parts.values import (
    flag,
    matrix_3x3,
    one_number,
    pinhole,
    whole_size,
)

Found = dict[str, list[tuple[str, Any]]]

#: What each key is, without case and signs.
KEYS = {
    key: word
    for word, keys in {
        "matrix": "cameramatrix cameramat cammatrix cameramtx mtx intrinsicmatrix intrinsicsmatrix "
        "intrinsics intrinsic k kmatrix",
        "distortion": "distortioncoefficients distortioncoefficient distortioncoeffs "
        "distortioncoeff distortioncoefs distcoefficients distcoeffs distcoeff distcoefs distcoef "
        "distortion dist d",
        "model": "distortionmodel distortiontype distmodel model modeltype cameramodel "
        "cameramodeltype cameratype lensmodel lenstype projectionmodel",
        "fisheye": "fisheyemodel fisheye isfisheye usefisheye",
        "size": "imagesize imgsize framesize resolution imageresolution dim size",
        "width": "imagewidth imgwidth framewidth width w",
        "height": "imageheight imgheight frameheight height h",
        **{word: word for word in ("fx", "fy", "cx", "cy", "skew", "roi", "nominal")},
        "name": "cameraname",
        "readout": "readoutms",
        "bin_x": "binningx",
        "bin_y": "binningy",
    }.items()
    for key in keys.split()
}
# How many coefficients a model has whose number ROS's camera_calibration did not write.
_COUNTS = dict.fromkeys(FISHEYE_NAMES, 4) | {"rationalpolynomial": 8}
_UNDERSTOOD = (
    "camera_matrix (K), distortion_coefficients (dist_coeffs, D), distortion_model, image_width "
    "and image_height (resolution)"
)
_NAMES = RADTAN_NAMES | FISHEYE_NAMES | NONE_NAMES | FOREIGN_NAMES


def read(values: Data, stem: str, asked: Asked) -> CameraFields:
    """Fields of a camera of one of these forms."""
    refuse_choice(asked)
    if not any(KEYS.get(plain(key)) in ("matrix", "fx") for key in values):
        raise CameraFormatError(
            "has neither camera_matrix (ROS, OpenCV) nor cam0 (Kalibr) nor cameraIntrinsics "
            "(PhotonVision), nor is it another program's form that is read; docs/camera-files.md "
            "lists all"
        )
    found = gather(values, KEYS, _UNDERSTOOD, names=_NAMES)
    matrix = _matrix(found)
    size = _size(found)
    lens = lens_of(_said(found), asked)
    name, nominal = _one(found["name"]), _one(found["nominal"])
    full = camera_fields(
        list(size),
        matrix,
        lens,
        stem if name is None else str(name),
        nominal=nominal is not None and flag(nominal, "nominal"),
        readout=_one(found["readout"]),
    )
    window = read_window(_one(found["roi"]), (_one(found["bin_x"]), _one(found["bin_y"])), size)
    note = window_note(window, size)
    if note is None:
        return full
    matrix, (width, height) = apply_window(matrix, window)
    if not (-0.5 <= matrix[0, 2] < width and -0.5 <= matrix[1, 2] < height):
        raise CameraFormatError(
            "its region of interest leaves out the lens's centre, and such frames are not read"
        )
    return full._replace(width=width, height=height, matrix=matrix, notes=(note,))


def _said(found: Found) -> Said:
    flags = [(key, flag(value, key)) for key, value in found["fisheye"]]
    switched_on = [(key, "fisheye") for key, is_on in flags if is_on]
    names = [*found["model"], *switched_on]
    counts = {_COUNTS[word] for _, value in names if (word := plain(str(value))) in _COUNTS}
    vectors = [(key, _as_ros_counts(value, counts)) for key, value in found["distortion"]]
    return Said(names, one_vector(vectors), not_fisheye=len(switched_on) < len(flags))


def _as_ros_counts(value: Any, counts: set[int]) -> Any:
    """Coefficients of which old ROS says that they are five where its model has four or eight."""
    if isinstance(value, dict) and value.get("rows") == 1 and value.get("cols") == 5:
        data = value.get("data")
        if isinstance(data, list) and len(data) in counts:
            return data
    return value


def _matrix(found: Found) -> Array:
    single = {key: found[key] for key in ("fx", "fy", "cx", "cy") if found[key]}
    matrices = [(key, matrix_3x3(value, key)) for key, value in found["matrix"]]
    if len(single) == 4:
        values = [one_number(_one(entries), key) for key, entries in single.items()]
        matrices.append(("fx, fy, cx, cy", pinhole(*values)))
    elif single:
        raise CameraFormatError(f"has {', '.join(single)} alone; give fx, fy, cx and cy")
    if not matrices:
        raise CameraFormatError("its camera matrix is empty; give nine numbers")
    for key, matrix in matrices[1:]:
        if not np.array_equal(matrix, matrices[0][1]):
            raise CameraFormatError(f"{matrices[0][0]} and {key} contradict each other")
    for key, skew in found["skew"]:
        if one_number(skew, key):
            raise CameraFormatError("the camera matrix has skew; calibrate without it")
    return matrices[0][1]


def _size(found: Found) -> tuple[int, int]:
    sizes = [whole_size(value, key) for key, value in found["size"]]
    widths, heights = ([value for _, value in found[side]] for side in ("width", "height"))
    sizes += [whole_size([w, h], "image size") for w, h in zip(widths, heights, strict=False)]
    if not sizes or len(widths) != len(heights):
        raise CameraFormatError(
            "has no image_width and image_height; add the size of the calibrated pictures, pixels"
        )
    if len(set(sizes)) > 1:
        raise CameraFormatError("its sizes of the picture contradict each other; leave the right")
    return sizes[0]


def _one(entries: Sequence[tuple[str, Any]]) -> Any:
    if len(entries) > 1:
        raise CameraFormatError(f"{entries[0][0]} and {entries[1][0]} say one thing; leave one")
    return entries[0][1] if entries else None
