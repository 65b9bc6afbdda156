"""Reads camera files of many programs to plain fields, of which `Camera` is built.

`padstudio.geometry.camera_files.forms` has a module for each form. In every form that is YAML or
JSON by keys, ``readout_ms`` may stand besides where its module knows it: how long a rolling shutter
takes from the first row to the last, 0 for a global shutter.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

from padstudio.bounded_files import read_whole
from padstudio.errors import CameraFormatError
from padstudio.geometry.camera_files.forms import (
    agisoft,
    colmap,
    kalibr,
    mrcal,
    opencv,
    opensfm,
    orbslam,
    photonvision,
)
from padstudio.geometry.camera_files.parts import plain_text, xml_text
from padstudio.geometry.camera_files.parts.fields import Asked, CameraFields, Data, naming

# What `padstudio.pad.files` writes: the file that is given by mistake most often.
_PAD_FORMAT = "padstudio.pad"

# Keys at the top of files of programs whose lenses are other than ours, or whose files say more
# than a camera.
_FOREIGN = {
    "value0": "a calibration of Basalt",
    "fisheye_params": "a lens profile of Gyroflow",
    "calib_dimension": "a lens profile of Gyroflow",
    "intrinsic_type": "a calibration of OpenImuCameraCalibrator",
    "projection_parameters": "a calibration of camodocal",
    "mirror_parameters": "a calibration of camodocal",
    "fl_x": "a transforms.json of a NeRF",
    "ros__parameters": "a file of ROS parameters",
    "/**": "a file of ROS parameters",
    "sfm_data_version": "a scene of OpenMVG",
}


def read(path: Path) -> bytes:
    """A camera file's content, no more of it than can be one.

    Raises
    ------
    CameraFormatError
        If it cannot be read.
    """
    try:
        return read_whole(path, plain_text.MAX_JSON_BYTES)
    except OSError as error:
        raise CameraFormatError(f"cannot read {path.name}: {error.strerror}") from error


def parse(data: bytes | str, name: str, asked: Asked | None = None) -> CameraFields:
    """Fields of a camera file of any form that is read.

    Parameters
    ----------
    data : bytes or str
    name : str
        The file's name; messages start with it, and a camera without a name takes its stem.
    asked : Asked, optional

    Raises
    ------
    CameraFormatError
        If it is of no such form, or says anything of the lens that is not understood, naming what
        is wrong and where.
    """
    content = data.encode() if isinstance(data, str) else data
    with naming(name):
        return _parse(content, Path(name).stem, asked or Asked())


def _parse(data: bytes, stem: str, asked: Asked) -> CameraFields:
    start = data.lstrip(b"\xef\xbb\xbf \t\r\n")[:1]
    if start == b"<":
        return _from_xml(data, stem, asked)
    is_brace = start in (b"{", b"[", b"#")
    limit = plain_text.MAX_JSON_BYTES if is_brace else plain_text.MAX_TEXT_BYTES
    text = plain_text.decode(data, limit)
    if re.match(r"\s*(# oST|\[image\])", text):
        raise CameraFormatError("ROS's INI form is not read; take the YAML that is written with it")
    if is_brace and mrcal.is_mrcal(text):
        return mrcal.read(text, stem, asked)
    if start == b"#" and len(data) > plain_text.MAX_TEXT_BYTES:
        raise CameraFormatError(f"{len(data)} bytes; at most {plain_text.MAX_TEXT_BYTES} are read")
    if colmap.is_colmap(text):
        return colmap.read(text, stem, asked)
    is_json = start in (b"{", b"[")
    return _from_values(
        plain_text.json_values(text) if is_json else plain_text.yaml_values(text), stem, asked
    )


def _from_xml(data: bytes, stem: str, asked: Asked) -> CameraFields:
    if len(data) > plain_text.MAX_TEXT_BYTES:
        raise CameraFormatError(f"{len(data)} bytes; at most {plain_text.MAX_TEXT_BYTES} are read")
    root, values = xml_text.parse(data)
    if root == "opencv_storage":
        return opencv.read(values, stem, asked)
    if root == "calibration":
        return agisoft.read(values, stem, asked)
    raise CameraFormatError(
        f"is XML of {root[:60]!r}; of XML, OpenCV's opencv_storage and Agisoft's calibration are "
        "read"
    )


def _from_values(values: Any, stem: str, asked: Asked) -> CameraFields:
    if not isinstance(values, dict):
        raise CameraFormatError("holds no keys and values; give a camera calibration")
    if values.get("format") == _PAD_FORMAT:
        raise CameraFormatError("is a pad file; give it as the pad, and a camera calibration here")
    for key, what in _FOREIGN.items():
        if key in values:
            raise CameraFormatError(f"is {what}, which is not read; docs/camera-files.md lists all")
    return _reader(values)(values, stem, asked)


def _reader(values: Data) -> Callable[[Data, str, Asked], CameraFields]:
    if kalibr.cameras_in(values):
        return kalibr.read
    if "cameraIntrinsics" in values:
        return photonvision.read
    if orbslam.is_orbslam(values):
        return orbslam.read
    if opensfm.is_opensfm(values):
        return opensfm.read
    return opencv.read
