"""What is left of a frame behind a veil of light."""

import numpy as np
from dense_frames import frame_of, sample_pad, small_camera

from padstudio import Detector
from padstudio.geometry.pose import look_at_pad
from padstudio.simulate.radiance.fog import Fog
from padstudio.vision.frame.prepare import find_stretch
from padstudio.vision.frame.pyramid import Pyramid
from padstudio.vision.frame.veil import is_veiled, unveiled

POSE = look_at_pad(1300.0, tilt_deg=14, heading_deg=25)


def foggy(contrast, pose=POSE):
    visibility = pose.position_mm[2] / 1000 * np.log(20) / -np.log(contrast)
    return frame_of(pose, camera=small_camera(), fog=Fog(visibility_m=visibility))


def test_fog_is_a_veil_and_darkness_is_none():
    plain = frame_of(POSE, camera=small_camera())
    assert is_veiled(find_stretch(Pyramid(foggy(0.06))))
    assert not is_veiled(find_stretch(Pyramid(plain)))
    assert not is_veiled(find_stretch(Pyramid(plain // 8)))


def test_colours_and_contrast_come_back():
    plain = frame_of(POSE, camera=small_camera()).astype(float)
    clear = unveiled(foggy(0.1)).astype(float)
    stretch = find_stretch(Pyramid(clear.astype(np.uint8)))
    assert max(np.subtract(stretch.high, stretch.low)) > 120
    for channel in (0, 2):
        blocks = [
            picture[:480, :640, channel].reshape(60, 8, 80, 8).mean((1, 3))
            for picture in (plain, clear)
        ]
        assert np.corrcoef(blocks[0].ravel(), blocks[1].ravel())[0, 1] > 0.6


def test_a_pad_in_thick_fog_is_read():
    pose = look_at_pad(500.0, tilt_deg=14, heading_deg=25)
    found = Detector(sample_pad(), small_camera()).detect(foggy(0.06, pose))
    assert found.pose is not None
    away = np.linalg.norm(found.pose.position_mm - pose.position_mm)
    assert away < 10.0
