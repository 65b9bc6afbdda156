"""Frames of inks that are much alike, read with and without un-mixing."""

import numpy as np

from padstudio import Camera, Detector, DetectorParams
from padstudio.geometry.pose import look_at_pad
from padstudio.pad.coding import generate_pad
from padstudio.simulate.camera import render
from padstudio.simulate.scene import Scene
from padstudio.vision.crosstalk import Crosstalk
from padstudio.vision.params import PrepareParams

MIXTURE = np.array([[0.6, 0.02, 0.38], [0.02, 0.9, 0.08], [0.36, 0.04, 0.6]])


def mixed(bgr):
    """The frame as a camera whose red and blue filters let much of the other through sees it."""
    light = (bgr[:, :, ::-1] / 255.0) ** 2.2
    return np.ascontiguousarray(
        (np.clip(light @ MIXTURE.T, 0, 1) ** (1 / 2.2) * 255).astype(np.uint8)[:, :, ::-1]
    )


def test_unmixing_clears_misread_cells_and_keeps_the_pose():
    pad = generate_pad(rows=60, cols=60, ratio=5, cell_mm=10.0, seed=4)
    camera = Camera(1360, 765, np.array([[943.0, 0, 679.5], [0, 943.0, 382.0], [0, 0, 1]]))
    pose = look_at_pad(900.0, tilt_deg=10.0)
    frame = mixed(render(Scene(pad=pad, ground="asphalt"), camera, pose, seed=3).image)
    plain = Detector(pad, camera).detect(frame)
    crosstalk = Crosstalk(MIXTURE, np.zeros(3), 0.0, 0.2, 0.2, ())
    params = DetectorParams(prepare=PrepareParams(crosstalk=crosstalk))
    unmixed = Detector(pad, camera, params=params).detect(frame)
    assert unmixed.ok
    assert unmixed.cells_wrong == 0
    assert plain.cells_wrong > 10
    assert np.linalg.norm(unmixed.pose.position_mm - pose.position_mm) < 0.002 * 900
