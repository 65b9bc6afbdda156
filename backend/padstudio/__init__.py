"""Pad Studio: design, print and detect double-layer coded landing pads."""

from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.pad.spec import Layer, Pad
from padstudio.vision.params import DetectorParams
from padstudio.vision.pipeline import Detector
from padstudio.vision.types import Detection

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
