"""Pad Studio: design, print and detect double-layer coded landing pads.

>>> from padstudio import Camera, Detector, Pad
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from padstudio.geometry.camera import Camera
    from padstudio.geometry.pose import Pose
    from padstudio.pad.spec import Layer, Pad
    from padstudio.vision.detector import Detector
    from padstudio.vision.stage.detection import Detection
    from padstudio.vision.stage.params import DetectorParams

__version__ = "0.1.0"

__all__ = [
    "Camera",
    "Detection",
    "Detector",
    "DetectorParams",
    "Layer",
    "Pad",
    "Pose",
    "__version__",
]

_HOMES = {
    "Camera": "geometry.camera",
    "Detection": "vision.stage.detection",
    "Detector": "vision.detector",
    "DetectorParams": "vision.stage.params",
    "Layer": "pad.spec",
    "Pad": "pad.spec",
    "Pose": "geometry.pose",
}


def __getattr__(name: str) -> Any:
    # Names are fetched when first used, so that the command line answers --help without OpenCV.
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(importlib.import_module(f"{__name__}.{_HOMES[name]}"), name)
    globals()[name] = value
    return value
