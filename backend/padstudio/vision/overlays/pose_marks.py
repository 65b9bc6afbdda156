"""Where a pose puts the pad in a frame, as marks: its rim, a layer's lattice, its axes.

Drawn over the frame they show at a glance whether the pose is right. No trace is needed, so that
frames that come thirty times a second can have them.
"""

from __future__ import annotations

import numpy as np

from padstudio.arrays import Array
from padstudio.geometry.camera import Camera
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.layout import lattice_mm, lattice_of, outline_mm
from padstudio.pad.spec import Layer, Pad
from padstudio.vision.cells.visible import visible_range
from padstudio.vision.overlays.marks import Line, Marks
from padstudio.vision.stage.detection import Detection

# Lines of a family that are drawn at most, and points of each: lines of a lens are bent.
_MOST_LINES, _POINTS = 26, 9


def pose_marks(detection: Detection, pad: Pad, camera: Camera) -> Marks:
    """The pad as a detection's pose puts it in the frame.

    Parameters
    ----------
    detection : Detection
        Without a pose there are no marks.
    pad : Pad
        The one that was found.
    camera : Camera
        At the frame's size.
    """
    marks = Marks()
    if detection.pose is None:
        return marks
    pose = MovingPose(detection.pose)
    corners = outline_mm(pad)
    sides = [
        corner + np.linspace(0, 1, _POINTS)[:-1, None] * (after - corner)
        for corner, after in zip(corners, np.roll(corners, -1, axis=0), strict=True)
    ]
    rim = pose.project(camera, np.concatenate(sides))
    if np.isfinite(rim).all():
        marks.outlines.append(rim)
    own = [item for item in pad.layers if item.channel == detection.layer]
    # The sign's own shape stands for all of its layers.
    layer = own[0] if own else max(pad.layers, key=lambda item: item.cell_mm)
    rows, cols = visible_range(pad, layer, camera, detection.pose)
    if rows[0] >= rows[1] or cols[0] >= cols[1]:
        return marks
    marks.lines += _lattice(pad, layer, pose, camera, (cols, rows))
    seen = np.array([[cols[0], rows[0]], [cols[1], rows[1]]], float)
    marks.add_axes(detection.pose, camera, _about(pad, layer, seen))
    return marks


def _lattice(
    pad: Pad,
    layer: Layer,
    pose: MovingPose,
    camera: Camera,
    spans: tuple[tuple[int, int], tuple[int, int]],
) -> list[Line]:
    """Lines of constant column (family 0) and of constant row (1), where they are in view."""
    lines = []
    for axis in (0, 1):
        first, last = spans[axis]
        along = np.linspace(*spans[1 - axis], _POINTS)
        for k in range(first, last + 1, max(1, -(-(last - first) // _MOST_LINES))):
            fixed = np.full_like(along, k)
            at = np.stack((fixed, along) if axis == 0 else (along, fixed), axis=1)
            xy = pose.project(camera, lattice_mm(pad, layer, at))
            if np.isfinite(xy).all():
                lines.append(Line(xy, axis, "found", k))
    return lines


def _about(pad: Pad, layer: Layer, seen: Array) -> Array:
    """Points about which axes are drawn: the pad's own centre, or amid what is in view of it."""
    centre = lattice_of(pad, layer, np.zeros(3))
    if (seen[0] < centre).all() and (centre < seen[1]).all():
        return np.vstack([outline_mm(pad), np.zeros((1, 3))]) * [0.5, 0.5, 1.0]
    return lattice_mm(pad, layer, seen)
