"""Bringing an expectation to where the frame shows the pad."""

from functools import cache

import cv2
import numpy as np
import pytest
from dense_frames import frame_of, sample_pad, small_camera
from hypothesis import given, settings
from hypothesis import strategies as st

from padstudio.arrays import YuvFrame
from padstudio.geometry.pose import look_at_pad
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render
from padstudio.vision.dense.relocate import relocate
from padstudio.vision.dense.tracker import picture_miss
from padstudio.vision.frame.pyramid import Pyramid
from padstudio.vision.frame.yuv import YuvPyramid
from padstudio.vision.refine.refiner import Refiner
from padstudio.vision.stage.params import DetectorParams

POSES = {
    "far": look_at_pad(3200.0),
    "whole": look_at_pad(1400.0, tilt_deg=20.0),
    "coarse": look_at_pad(700.0, target_mm=(-80.0, 40.0), heading_deg=130.0),
    "fine": look_at_pad(180.0, target_mm=(200.0, -100.0), tilt_deg=25.0, heading_deg=60.0),
}


@cache
def frame(name):
    return frame_of(POSES[name], camera=small_camera())


def refiner(pyramid):
    return Refiner(pyramid, small_camera(), sample_pad(), DetectorParams(), 0)


def yuv(bgr):
    planes = cv2.cvtColor(bgr, cv2.COLOR_BGR2YUV_I420)
    height, width = bgr.shape[:2]
    quarter = planes[height:].reshape(2, height // 2, width // 2)
    return YuvFrame(planes[:height], *quarter, width, "bt601", False, lambda: bgr)


@settings(max_examples=25)
@given(
    name=st.sampled_from(sorted(POSES)),
    turn=st.tuples(*[st.floats(-0.12, 0.12)] * 2),
    roll=st.floats(-0.03, 0.03),
    climb=st.floats(0.97, 1.03),
)
def test_the_picture_is_found_where_it_went(name, turn, roll, climb):
    truth = POSES[name]
    expected = MovingPose(truth).moved(np.array([0, 0, 0, *turn, roll]))
    step = np.array([0, 0, (climb - 1) * truth.position_mm[2], 0, 0, 0])
    found = relocate(refiner(Pyramid(frame(name))), expected.moved(step))
    assert found is not None
    # Height and roll are taken as they were expected.
    left = abs(climb - 1) + abs(roll)
    assert picture_miss(found.pose, truth) < 4 / small_camera().focal_px + 0.6 * left
    np.testing.assert_allclose(found.pose.position_mm, expected.pose.position_mm + step[:3])


@pytest.mark.parametrize("name", POSES)
def test_planes_of_a_video_show_the_same(name):
    expected = MovingPose(POSES[name]).moved(np.array([0, 0, 0, 0.03, -0.05, 0.01]))
    of_bgr = relocate(refiner(Pyramid(frame(name))), expected)
    of_yuv = relocate(refiner(YuvPyramid(yuv(frame(name)))), expected)
    assert picture_miss(of_bgr.pose, of_yuv.pose) < 1.0 / small_camera().focal_px


@pytest.mark.parametrize("ground", ["gravel", "grass", "bricks"])
def test_ground_shows_no_pad(ground):
    bare = render(Scene(pad=None, ground=ground), small_camera(), POSES["whole"]).image
    for pose in POSES.values():
        assert relocate(refiner(Pyramid(bare)), MovingPose(pose)) is None


def test_a_pose_that_looks_past_the_pad_predicts_nothing():
    past = MovingPose(POSES["whole"]).moved(np.array([0, 0, 0, 2.5, 0, 0]))
    assert relocate(refiner(Pyramid(frame("whole"))), past) is None
