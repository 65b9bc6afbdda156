"""Cameras like the one that was given, with another focal length or another lens."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from padstudio.geometry.camera import Camera
from padstudio.vision.stage.trace import Finding, Reason

# Lenses by the first coefficient of their bend, and focal lengths, relative to the camera's: far
# enough apart to read frames that it does not, near enough for one of them to be near the truth.
_BENDS = (-0.2, 0.15)
_RATIOS = (1.35, 0.7)


@dataclass(frozen=True, eq=False)
class OtherCamera:
    """A camera to be tried, and how it differs, in words."""

    camera: Camera
    words: str


def other_cameras(camera: Camera) -> Iterator[OtherCamera]:
    """Cameras to be tried in turn."""
    for bend in _BENDS:
        bends = np.zeros(max(4, len(camera.distortion)))
        bends[: len(camera.distortion)] = camera.distortion
        bends[0] += bend
        words = f"with a lens whose first coefficient differs by {bend:+.2f}"
        yield OtherCamera(replace(camera, distortion=bends), words)
    for ratio in _RATIOS:
        matrix = camera.matrix.copy()
        matrix[[0, 1], [0, 1]] *= ratio
        words = f"with {ratio:g} times the focal length"
        yield OtherCamera(replace(camera, matrix=matrix), words)


def wrong_camera(detail: str) -> Finding:
    """The camera file is not that of the camera."""
    return Finding(
        Reason.WRONG_CAMERA,
        f"wrong camera file: {detail}",
        "choose the file of this camera, at this zoom and picture mode, or calibrate it",
    )
