"""The last centimetres: fewer cells in view than a single frame needs."""

from __future__ import annotations

import numpy as np
import pytest
from dense_frames import errors, frame_of, random_pad, sample_pad, small_camera

from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import look_at_pad
from padstudio.pad.spec import Pad
from padstudio.vision.detector import Detector

HEIGHTS_MM = [*np.geomspace(110.0, 45.0, 14), 45.0]


def narrow_camera() -> Camera:
    """It sees some 30 whole cells of 10 mm from 45 mm."""
    camera = small_camera()
    matrix = camera.matrix.copy()
    matrix[0, 0] = matrix[1, 1] = 500.0
    return Camera(camera.width, camera.height, matrix, camera.distortion)


@pytest.mark.parametrize("pad", [sample_pad(), random_pad(11)], ids=["copied layer", "own codes"])
@pytest.mark.parametrize("spot", [(137.0, -88.0), (-214.0, 305.0)])
def test_a_pad_is_followed_down_to_its_last_cells(pad: Pad, spot: tuple[float, float]) -> None:
    camera = narrow_camera()
    poses = [
        look_at_pad(float(h), tilt_deg=4, heading_deg=25, tilt_towards_deg=60, target_mm=spot)
        for h in HEIGHTS_MM
    ]
    frames = (frame_of(pose, pad=pad, camera=camera, seed=k) for k, pose in enumerate(poses))
    for pose, found in zip(poses, Detector(pad, camera).track(frames), strict=True):
        assert found.ok, (pose.position_mm, found.failure)
        position, attitude = errors(found.pose, pose)
        assert position < 2
        assert attitude < 2


def test_another_pad_below_is_not_followed() -> None:
    camera, spot = narrow_camera(), (137.0, -88.0)
    poses = [look_at_pad(h, tilt_deg=4, heading_deg=25, target_mm=spot) for h in (60.0, 58.0, 56.0)]
    frames = [frame_of(pose, pad=random_pad(11), camera=camera) for pose in poses]
    frames += [frame_of(pose, pad=random_pad(12), camera=camera) for pose in poses]
    found = list(Detector(random_pad(11), camera).track(frames))
    assert [item.ok for item in found] == [True] * 3 + [False] * 3
