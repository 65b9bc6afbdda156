"""Patches lie where the picture shows them."""

from __future__ import annotations

import numpy as np
from calibration_shots import LENSES, poses_about, shots
from dense_frames import random_pad

from padstudio.calibration.patches import measure
from padstudio.calibration.planes import PadPlanes
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.vision.frame.pyramid import Pyramid

PAD = random_pad(3, cells=(60, 12), cell_mm=(20.0, 100.0))
CAMERA = LENSES["bent"]
POSE = poses_about(max(PAD.size_mm), CAMERA, 1, seed=2)[0]
(PICTURE,) = shots(PAD, CAMERA, [POSE])


def errors_px(patches) -> np.ndarray:
    away = patches.pixels - CAMERA.project(POSE.to_camera(patches.points_mm))
    return np.hypot(*away.T)


def test_patches_of_a_true_pose_are_right_to_a_tenth_of_a_pixel() -> None:
    found = measure(Pyramid(PICTURE), PAD, PAD.layers[0], CAMERA, POSE, settled=True)
    assert found is not None
    assert len(found) > 40
    assert np.median(errors_px(found)) < 0.1
    assert np.median(found.sigma_px) < 0.1


def test_patches_are_where_the_picture_is_not_where_the_pose_puts_them() -> None:
    layer = PAD.layers[0]
    off = MovingPose(POSE).moved(np.array([1.2, -0.9, 2.0, 0, 0, 2e-3])).pose
    found = measure(Pyramid(PICTURE), PAD, layer, CAMERA, off, settled=True)
    assert found is not None
    predicted = CAMERA.project(off.to_camera(found.points_mm))
    assert np.median(np.hypot(*(found.pixels - predicted).T)) > 0.3
    assert np.median(errors_px(found)) < 0.15


def test_far_from_the_picture_nothing_holds_together() -> None:
    layer = PAD.layers[0]
    shift = np.array([7.3 * layer.cell_mm, 0, 0, 0, 0, 0])
    off = MovingPose(POSE).moved(shift).pose
    found = measure(Pyramid(PICTURE), PAD, layer, CAMERA, off, settled=False)
    true = measure(Pyramid(PICTURE), PAD, layer, CAMERA, POSE, settled=False)
    assert true is not None
    assert found is None or len(found) < 0.1 * len(true)


def test_planes_of_the_pad_alone_give_the_same_patches() -> None:
    planes, whole = PadPlanes(PICTURE, PAD), Pyramid(PICTURE)
    assert (planes.width, planes.height) == (whole.width, whole.height)
    for layer in PAD.layers:
        for settled in (False, True):
            alone, all_ = (
                measure(each, PAD, layer, CAMERA, POSE, settled=settled) for each in (planes, whole)
            )
            assert alone is not None
            assert all_ is not None
            assert np.allclose(alone.pixels, all_.pixels, atol=1e-6)
