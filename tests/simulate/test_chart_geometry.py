"""The chart's cells across the picture and pixels a cell, counted in rendered frames."""

import math

import numpy as np
import pytest

from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import look_at_pad
from padstudio.pad.spec import Layer, Pad
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render
from padstudio.simulate.sensor import Imaging
from padstudio.simulate.success_map import view_of

CELL_MM, HEIGHT_MM = 25.0, 800.0
CAMERA = Camera(680, 382, np.array([[471.5, 0, 339.5], [0, 471.5, 190.5], [0, 0, 1]]))


@pytest.fixture(scope="module")
def scene():
    """A checkerboard that fills every picture."""
    field = (np.indices((200, 200)).sum(axis=0) % 2).astype(np.uint8)
    return Scene(pad=Pad(layers=(Layer("red", CELL_MM, field),)), ground="plain")


def edges_along(image, axis):
    """Positions of cell edges, px, along the picture's middle column (axis 0) or row (1)."""
    plane = image[..., 2].astype(float)
    middle = plane.shape[1 - axis] // 2
    # Where a line of pixels runs along cell edges, one beside it does not.
    profiles = [np.take(plane, middle + step, 1 - axis) for step in range(-8, 9)]
    profile = max(profiles, key=np.std)
    above = profile > (profile.max() + profile.min()) / 2
    return np.flatnonzero(np.diff(above.astype(int))) + 0.5


@pytest.mark.parametrize("tilt_deg", [0.0, 15.0, 30.0, 45.0, 55.0])
def test_rendered_frames_hold_the_charts_cells(scene, tilt_deg):
    view = view_of(CAMERA)
    across, cell_px = [], []
    # The camera leans along the picture's height or its width: the pad's axes are the picture's.
    for heading in (0.0, 90.0):
        pose = look_at_pad(HEIGHT_MM, tilt_deg=tilt_deg, heading_deg=heading, tilt_towards_deg=0.0)
        image = render(scene, CAMERA, pose, Imaging.ideal()).image
        for axis, middle in ((0, 190.5), (1, 339.5)):
            edges = edges_along(image, axis)
            across.append(len(edges) - 1)
            near = np.argsort(np.abs(edges - middle))[:6]
            cell_px.append(np.ptp(edges[near]) / 5)
    # Parts of a cell at both ends are not counted.
    expected = view.cells_across(CELL_MM, HEIGHT_MM, tilt_deg)
    assert expected - 2 <= min(across) <= expected
    # The chart's width of a cell is the geometric mean of its two sides.
    width = math.sqrt(min(cell_px) * max(cell_px))
    assert width == pytest.approx(view.cell_px(CELL_MM, HEIGHT_MM, tilt_deg), rel=0.05)
