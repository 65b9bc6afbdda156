"""Pad Studio: design, print and detect double-layer coded landing pads."""

from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.pad.spec import Layer, Pad

__version__ = "0.1.0"

__all__ = ["Camera", "Layer", "Pad", "Pose", "__version__"]
