"""Settings of ORB-SLAM2 and 3: ``Camera.fx`` or ``Camera1.fx``, …, with their distortion by name.

References
----------
https://github.com/UZ-SLAMLab/ORB_SLAM3, ``src/Settings.cc`` and ``Calibration_Tutorial.pdf``:
OpenCV's pixels and models; PinHole takes k1 k2 p1 p2 and k3 or not, KannalaBrandt8 k1 k2 k3 k4.
"""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from padstudio.errors import CameraFormatError
from padstudio.geometry.camera_files.parts.fields import (
    Asked,
    CameraFields,
    Data,
    LensFields,
    camera_fields,
    choose,
)
from padstudio.geometry.camera_files.parts.lenses import Said, lens_of
from padstudio.geometry.camera_files.parts.values import one_number, pinhole, word

_MODELS = {"PinHole": "radtan", "KannalaBrandt8": "fisheye", "Rectified": "none"}
_SHARED = {"type", "width", "height"}
_INTRINSICS = ("fx", "fy", "cx", "cy")
_LENS = {"k1", "k2", "k3", "k4", "p1", "p2"}
# Of the program, not of the lens; newWidth is the size to which it scales pictures for itself.
_HARMLESS = re.compile(
    r"Camera\d?\.(fps|RGB|bf|newWidth|newHeight|(overl|l)appingBegin|(overl|l)appingEnd)"
    r"|(ORBextractor|Viewer|IMU|Stereo|System|File|RGBD|Tracking|LoopClosing)\..*"
    r"|ThDepth|DepthMapFactor|loopClosing|Tbc|Camera\.Delay|LoadMap|SaveMap"
)


def is_orbslam(values: Data) -> bool:
    """True for keys as these programs have them."""
    return any(re.fullmatch(r"Camera1?\.fx", key) for key in values)


def read(values: Data, stem: str, asked: Asked) -> CameraFields:
    """Fields of the camera that is meant."""
    cameras: dict[str, dict[str, Any]] = {}
    shared: dict[str, Any] = {}
    for key, value in values.items():
        part = re.fullmatch(r"(Camera\d?)\.(\w+)", key)
        if part and part[2] in _LENS.union(_INTRINSICS):
            cameras.setdefault(part[1], {})[part[2]] = value
        elif part and part[1] == "Camera" and part[2] in _SHARED:
            shared[part[2]] = value
        elif not _HARMLESS.fullmatch(key):
            raise CameraFormatError(
                f"the key {key[:80]!r} is not known and could hold a part of the lens; understood "
                "are Camera.type, Camera.width, Camera.height and Camera1.fx, fy, cx, cy, k1 … k4, "
                "p1, p2. Remove it if it says nothing of the lens"
            )
    name, camera = choose(cameras, asked)
    missing = [key for key in _INTRINSICS if key not in camera]
    if missing:
        raise CameraFormatError(f"has no {name}.{missing[0]}")
    if {"width", "height"} - set(shared):
        raise CameraFormatError(
            "has no Camera.width and Camera.height; add the size of the calibrated pictures, pixels"
        )
    lens = _lens(name, camera, shared.get("type"), asked)
    matrix = pinhole(*(one_number(camera[key], f"{name}.{key}") for key in _INTRINSICS))
    title = stem if len(cameras) == 1 else f"{stem} {name}"
    return camera_fields([shared["width"], shared["height"]], matrix, lens, title)


def _lens(name: str, camera: dict[str, Any], kind: Any, asked: Asked) -> LensFields:
    if kind is not None and word(kind, "Camera.type") not in _MODELS:
        raise CameraFormatError(
            f"Camera.type is {kind[:60]!r}, a lens model that is not read; PinHole, "
            "KannalaBrandt8 and Rectified are"
        )
    given = {key: one_number(camera[key], f"{name}.{key}") for key in sorted(_LENS & set(camera))}
    model = _MODELS.get(kind, "radtan" if "p1" in given else "")
    if not given:
        return lens_of(Said([("Camera.type", model if model == "none" else "")], None), asked)
    if model == "none":
        if any(given.values()):
            raise CameraFormatError("Camera.type is Rectified, and it holds distortion")
        return lens_of(Said([("Camera.type", "none")], np.zeros(0)), asked)
    if not model:
        raise CameraFormatError("has no Camera.type; add PinHole or KannalaBrandt8")
    order = ["k1", "k2", "k3", "k4"] if model == "fisheye" else ["k1", "k2", "p1", "p2"]
    if model == "radtan" and "k3" in given:
        order.append("k3")
    if set(order) != set(given):
        odd = sorted(set(order) ^ set(given))
        raise CameraFormatError(
            f"its distortion is {', '.join(given)}; {kind or 'PinHole'} takes {', '.join(order)}. "
            f"Add or remove {', '.join(odd)}"
        )
    return lens_of(Said([("Camera.type", model)], np.array([given[key] for key in order])), asked)
