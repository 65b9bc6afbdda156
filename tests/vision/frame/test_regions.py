"""Where the pad can be."""

import numpy as np
import pytest
from dense_frames import frame_of, random_pad, random_pose, sample_pad, small_camera

from padstudio.geometry.pose import look_at_pad
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.layout import outline_mm
from padstudio.vision.frame.pyramid import Pyramid
from padstudio.vision.frame.regions import find_regions, sharper


def outline_of(pose, camera):
    return MovingPose(pose).project(camera, outline_mm(sample_pad()))


@pytest.mark.parametrize("ground", ["grass", "asphalt", "sand", "bricks"])
@pytest.mark.parametrize("height_mm", [2500.0, 9000.0])
def test_the_likeliest_region_holds_the_pad(ground, height_mm):
    camera = small_camera()
    pose = random_pose(np.random.default_rng(int(height_mm)), height_mm)
    pyramid = Pyramid(frame_of(pose, camera=camera, ground=ground))
    regions = find_regions(pyramid, sample_pad())
    corners, box = outline_of(pose, camera), regions[0].box
    assert (corners >= [box.x0 - 2, box.y0 - 2]).all()
    assert (corners <= [box.x1 + 2, box.y1 + 2]).all()
    assert box.side < 2 * np.ptp(corners, axis=0).max() + 40
    inside = corners.mean(axis=0) + 0.8 * (corners - corners.mean(axis=0))
    assert regions[0].holds(inside).all()
    away = corners.mean(axis=0) + 3 * (corners - corners.mean(axis=0))
    assert not regions[0].holds(away).all()


def test_the_whole_frame_comes_last_and_holds_everything():
    pose = look_at_pad(2500.0)
    pyramid = Pyramid(frame_of(pose, camera=small_camera()))
    last = find_regions(pyramid, sample_pad())[-1]
    assert last.mask is None
    assert last.box == pyramid.box
    assert last.holds(np.array([[0.0, 0.0], [639.0, 479.0]])).all()


@pytest.mark.parametrize("value", [0, 90, 255])
def test_a_picture_of_one_colour_has_no_region_of_its_own(value):
    pyramid = Pyramid(np.full((480, 640, 3), value, np.uint8))
    assert len(find_regions(pyramid, sample_pad())) == 1


def test_a_pad_of_three_channels_has_no_mark():
    pad = random_pad(1, cells=(20, 20, 20), cell_mm=(20.0,) * 3, channels=("red", "green", "blue"))
    pyramid = Pyramid(frame_of(look_at_pad(900.0), pad=pad, camera=small_camera()))
    assert len(find_regions(pyramid, pad)) == 1


def test_the_middle_of_a_region_lies_within_it():
    pose = look_at_pad(2000.0, target_mm=(200, -150))
    region = find_regions(Pyramid(frame_of(pose, camera=small_camera())), sample_pad())[0]
    cut = region.middle(100)
    assert cut.box.side == 100
    middle = np.array([[(cut.box.x0 + cut.box.x1) / 2, (cut.box.y0 + cut.box.y1) / 2]])
    assert region.holds(middle).all()


def test_a_far_pads_shape_is_seen_at_a_finer_scale():
    camera, pose = small_camera(), look_at_pad(14_000.0, heading_deg=30)
    pyramid = Pyramid(frame_of(pose, camera=camera))
    region = find_regions(pyramid, sample_pad())[0]
    fine = sharper(pyramid, sample_pad(), region)
    assert fine.level < region.level
    assert fine.mask is not None
    shown = np.argwhere(fine.mask)[:, ::-1].mean(axis=0) * (1 << fine.level)
    np.testing.assert_allclose(shown, outline_of(pose, camera).mean(axis=0), atol=2.0)
