"""Borders of a pad as a pose shows them, by a camera or of a print that is not as it should be."""

import numpy as np
from reason_causes import CAMERAS, PADS

from padstudio.geometry.pose import look_at_pad
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.vision.pose.edge_points import EdgePoints, measurable_borders
from padstudio.vision.reasons.distortions import CHANGES

POSE = MovingPose(look_at_pad(900.0, tilt_deg=28.0, heading_deg=33.0, tilt_towards_deg=70.0))
PAD, CAMERA = PADS["small"], CAMERAS["vga"]


def measured(change=None, amount=0.0, *, pose=POSE):
    """Borders of the coarse layer where a changed camera or print shows them, with noise."""
    layer = max(PAD.layers, key=lambda item: item.cell_mm)
    borders, _ = measurable_borders(PAD, layer, CAMERA, pose, 2000, 5.0)
    points, camera = borders.points_mm, CAMERA
    if change is not None:
        camera, points = CHANGES[change](camera, points, amount)
    noise = np.random.default_rng(1).normal(0, 0.1, (len(points), 2))
    xy = pose.project(camera, points) + noise
    return EdgePoints(borders, xy, np.ones(len(xy)), np.zeros(len(xy)))
