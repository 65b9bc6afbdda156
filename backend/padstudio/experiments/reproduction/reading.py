"""One frame: taken, read by both methods, and compared with its truth."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np

from padstudio.arrays import Image
from padstudio.experiments.reproduction.plan import (
    Shot,
    imaging_of,
    noise_of,
    paper_camera,
    paper_pad,
    pose_of,
    scene_of,
)
from padstudio.geometry.pose import Pose, rotation_angle_deg
from padstudio.pad.spec import Pad
from padstudio.simulate.render import render
from padstudio.vision.detector import Detector
from padstudio.vision.stage.detection import Method

METHODS: tuple[Method, ...] = ("dense", "paper")
#: Layers by the paper's words for them.
LAYERS = {"fine": "red", "coarse": "blue"}
# From here on a pose is false: worse than none (share of the height; degrees).
_FALSE_SHARE, _FALSE_MM, _FALSE_DEG = 0.10, 5.0, 10.0


@dataclass(frozen=True)
class Reading:
    """What one method made of a frame.

    Attributes
    ----------
    layer : str
        What the pose rests on: ``red``, ``blue`` or ``outline``; empty where there is no pose.
    reason : str
        Why there is none, stage and reason.
    position_mm : tuple of float
        Of the camera in the pad frame; empty where there is no pose.
    axis : tuple of float
        The optical axis, a unit vector in the pad frame; likewise.
    tilt_deg : float
        As measured; NaN where there is no pose.
    error_mm, error_deg : float
        Of position and attitude, against the frame's own truth; NaN where there is no pose.
    false : bool
        The pose is off by a tenth of the height and 5 mm, or by 10 degrees.
    """

    layer: str
    reason: str
    position_mm: tuple[float, ...]
    axis: tuple[float, ...]
    tilt_deg: float
    error_mm: float
    error_deg: float
    false: bool

    @property
    def ok(self) -> bool:
        """True where there is a pose that is not false."""
        return bool(self.layer) and not self.false


@dataclass(frozen=True)
class FrameRead:
    """A frame with its truth.

    Attributes
    ----------
    shot : Shot
    position_mm : tuple of float
        The true camera's centre in the pad frame.
    axis : tuple of float
        The true optical axis, a unit vector in the pad frame.
    tilt_deg : float
    readings : mapping
        By method; by method and layer, as ``paper coarse``, where layers were read alone.
    """

    shot: Shot
    position_mm: tuple[float, ...]
    axis: tuple[float, ...]
    tilt_deg: float
    readings: Mapping[str, Reading]


def read_shot(shot: Shot) -> FrameRead:
    """Take a frame and read it; the same shot gives the same result."""
    pose = pose_of(shot)
    image = render(scene_of(shot), paper_camera(), pose, imaging_of(shot), noise_of(shot)).image
    readings: dict[str, Reading] = {method: _read(image, pose, method, None) for method in METHODS}
    if shot.by_layer:
        for method in METHODS:
            for word, channel in LAYERS.items():
                readings[f"{method} {word}"] = _read(image, pose, method, channel)
    return FrameRead(shot, *_placed(pose), pose.tilt_deg, readings)


@cache
def detector(method: Method, channel: str | None = None) -> Detector:
    """A detector of the paper's pad, or of one layer of it."""
    pad = paper_pad()
    if channel is not None:
        layers = tuple(layer for layer in pad.layers if layer.channel == channel)
        pad = Pad(layers, pad.window, levels=pad.levels)
    return Detector(pad, paper_camera(), method=method)


def _read(image: Image, true: Pose, method: Method, channel: str | None) -> Reading:
    found = detector(method, channel).detect(image)
    if found.pose is None:
        failure = found.failure
        reason = f"{failure.stage}: {failure.reason}" if failure else ""
        return Reading("", reason, (), (), np.nan, np.nan, np.nan, False)
    off_mm = float(np.linalg.norm(found.pose.position_mm - true.position_mm))
    off_deg = rotation_angle_deg(found.pose.rotation, true.rotation)
    most_mm = max(_FALSE_MM, _FALSE_SHARE * float(true.position_mm[2]))
    position_mm, axis = _placed(found.pose)
    return Reading(
        layer=found.layer or "",
        reason="",
        position_mm=position_mm,
        axis=axis,
        tilt_deg=found.pose.tilt_deg,
        error_mm=off_mm,
        error_deg=off_deg,
        false=off_mm > most_mm or off_deg > _FALSE_DEG,
    )


def _placed(pose: Pose) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """The camera's centre and its optical axis."""
    return tuple(pose.position_mm.tolist()), tuple(pose.rotation[:, 2].tolist())
