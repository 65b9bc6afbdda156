"""Pads whose layers share no code: exchanged channels and grey pictures show no other height."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from dense_frames import errors, frame_of, small_camera
from grey_frames import GREY

from padstudio.arrays import Image
from padstudio.geometry.pose import Pose, look_at_pad
from padstudio.pad.coding.generate import PadSpec, generate_pad
from padstudio.vision.detector import Detector
from padstudio.vision.stage.trace import Reason

SPECS = {
    "default": PadSpec(),
    "three levels": PadSpec(rows=100, cols=80, levels=3, ratio=4, seed=3),
}
# Heights over the pad's width, and places in shares of it: over the corner where the paper's
# layers share their code, and elsewhere.
VIEWS = [
    (0.12, (-0.4, 0.4)),
    (0.3, (-0.35, 0.35)),
    (0.3, (0.2, -0.1)),
    (0.8, (-0.2, 0.2)),
    (1.4, (0, 0)),
]


@cache
def detector(name: str) -> Detector:
    return Detector(generate_pad(SPECS[name]), small_camera())


@cache
def view(name: str, number: int) -> tuple[Image, Pose]:
    pad = detector(name).pad
    width, height = pad.size_mm
    share, (x, y) = VIEWS[number]
    pose = look_at_pad(
        share * width,
        tilt_deg=3.0 + 4 * number,
        heading_deg=80.0 * number,
        tilt_towards_deg=130.0 * number,
        target_mm=(x * width, y * height),
    )
    return frame_of(pose, pad=pad, camera=small_camera()), pose


@pytest.mark.parametrize("number", range(len(VIEWS)))
@pytest.mark.parametrize("name", SPECS)
def test_frames_are_read_as_they_are(name: str, number: int) -> None:
    bgr, pose = view(name, number)
    found = detector(name).detect(bgr)
    assert found.pose is not None, found.failure
    assert errors(found.pose, pose)[0] < 0.5


@pytest.mark.parametrize("number", range(len(VIEWS)))
@pytest.mark.parametrize("name", SPECS)
def test_exchanged_channels_give_no_pose_and_a_name(name: str, number: int) -> None:
    bgr, _ = view(name, number)
    found = detector(name).detect(np.ascontiguousarray(bgr[:, :, ::-1]))
    assert found.failure is not None
    assert found.failure.reason is Reason.CHANNELS_SWAPPED


@pytest.mark.parametrize("number", range(len(VIEWS)))
@pytest.mark.parametrize("change", GREY.values(), ids=GREY)
def test_grey_pictures_give_the_right_pose_or_none(change, number: int) -> None:
    bgr, pose = view("default", number)
    found = detector("default").detect(change(bgr))
    assert found.pose is None or errors(found.pose, pose)[0] < 2.0
