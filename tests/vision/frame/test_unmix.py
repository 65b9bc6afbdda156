"""Frames of inks that are much alike, read with and without un-mixing."""

from dataclasses import replace

import numpy as np
import pytest

from padstudio import Camera, Detector, DetectorParams
from padstudio.geometry.pose import look_at_pad
from padstudio.pad.coding.generate import PadSpec, generate_pad
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render
from padstudio.vision.overlays import stages
from padstudio.vision.stage.params import PrepareParams

MIXTURE = np.array([[0.6, 0.02, 0.38], [0.02, 0.9, 0.08], [0.36, 0.04, 0.6]])


def mixed(bgr):
    """The frame as a camera whose red and blue filters let much of the other through sees it."""
    light = (bgr[:, :, ::-1] / 255.0) ** 2.2
    return np.ascontiguousarray(
        (np.clip(light @ MIXTURE.T, 0, 1) ** (1 / 2.2) * 255).astype(np.uint8)[:, :, ::-1]
    )


MATRIX = np.array([[943.0, 0, 679.5], [0, 943.0, 382.0], [0, 0, 1]])
CAMERA = Camera(1360, 765, MATRIX, readout_ms=0.0)


@pytest.fixture(scope="module")
def pad():
    """A pad that knows the mixture."""
    pad = generate_pad(PadSpec(rows=60, cols=60, ratio=5, cell_mm=10.0, seed=4))
    return replace(pad, crosstalk=MIXTURE.tolist())


def frame_from(pad, pose):
    return mixed(render(Scene(pad=pad, ground="asphalt"), CAMERA, pose, seed=3).image)


def test_unmixing_clears_misread_cells_and_keeps_the_pose(pad):
    pose = look_at_pad(900.0, tilt_deg=10.0)
    frame = frame_from(pad, pose)
    params = DetectorParams(prepare=PrepareParams(unmix=False))
    plain = Detector(pad, CAMERA, params=params).detect(frame)
    unmixed = Detector(pad, CAMERA).detect(frame)
    assert unmixed.ok
    assert unmixed.cells_wrong == 0
    assert plain.cells_wrong > 10
    assert np.linalg.norm(unmixed.pose.position_mm - pose.position_mm) < 0.002 * 900


@pytest.mark.parametrize("method", ["dense", "paper"])
def test_the_trace_shows_the_colours_taken_apart(pad, method):
    frame = frame_from(pad, look_at_pad(220.0))
    trace = Detector(pad, CAMERA, method=method).detect(frame, trace=True).trace
    apart = stages.stage_picture(trace, "unmix").astype(int)
    # Where red is full, blue is clearly either dark or full.
    before = np.abs(frame[..., 0].astype(int) - frame[..., 2]).max()
    assert np.abs(apart[..., 0] - apart[..., 2]).max() > before + 50
    params = DetectorParams(prepare=PrepareParams(unmix=False))
    as_is = Detector(pad, CAMERA, method=method, params=params).detect(frame, trace=True).trace
    assert as_is.get("unmix") is None
