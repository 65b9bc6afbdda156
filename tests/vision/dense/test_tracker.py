"""What the next frame should show, and the shutter's share of the time between two."""

from dataclasses import replace

import numpy as np
import pytest
from dense_frames import errors, frame_of, sample_pad, small_camera

from padstudio.geometry.pose import look_at_pad
from padstudio.simulate.paths import motion_along
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render
from padstudio.simulate.sensor import Imaging
from padstudio.vision.dense.tracker import Tracker
from padstudio.vision.detector import Detector
from padstudio.vision.stage.detection import Detection
from padstudio.vision.stage.trace import Reason, StageFailure

LOST = Detection(None, StageFailure("decode", Reason.UNKNOWN_CODE, ""))
FPS = 30.0


def path(time_s):
    """A steady descent with drift and turn."""
    return look_at_pad(
        900 - 300 * time_s,
        tilt_deg=3 + 4 * time_s,
        heading_deg=40 + 12 * time_s,
        target_mm=(90 * time_s, -140 * time_s),
    )


def seen(frame, share):
    """A detection of a frame of the path, as a shutter of this share would show it."""
    here, after = path(frame / FPS), path((frame + 1) / FPS)
    motion = motion_along(path, frame / FPS)
    return Detection(
        here,
        shift_mm=share * (after.position_mm - here.position_mm),
        turn_rad=share * np.radians(motion.angular_deg_s) / FPS,
    )


@pytest.mark.parametrize("share", [0.0, 0.3, 0.6, 0.95])
def test_the_shutters_share_is_learnt(share):
    tracker = Tracker()
    for frame in range(8):
        tracker.learn(seen(frame, share))
    expected = tracker.expect()
    assert expected is not None
    assert expected.motion is not None
    step = path(7 / FPS).position_mm - path(6 / FPS).position_mm
    np.testing.assert_allclose(expected.motion.shift_mm, share * step, atol=0.03 * abs(step[2]))
    np.testing.assert_array_equal(expected.pose.shift_mm, expected.motion.shift_mm)
    assert 0 < expected.motion.climb_sigma_mm < 0.1 * abs(step[2])


def test_the_camera_is_expected_to_move_on():
    tracker = Tracker()
    assert tracker.expect() is None
    tracker.learn(Detection(path(0.0)))
    first = tracker.expect()
    assert first is not None
    assert errors(first.pose.pose, path(0.0))[0] < 1e-9
    assert first.motion is None
    tracker.learn(Detection(path(1 / FPS)))
    second = tracker.expect()
    assert second is not None
    assert errors(second.pose.pose, path(2 / FPS))[0] < 0.01


def test_a_lost_frame_is_forgotten_and_the_share_is_not():
    tracker = Tracker()
    for frame in range(8):
        tracker.learn(seen(frame, 0.5))
    tracker.learn(LOST)
    assert tracker.expect() is None
    tracker.learn(seen(9, 0.5))
    tracker.learn(seen(10, 0.5))
    expected = tracker.expect()
    assert expected is not None
    assert expected.motion is not None


def test_a_motion_that_contradicts_itself_is_not_known():
    tracker = Tracker()
    for frame in range(8):
        tracker.learn(seen(frame, 0.9 if frame % 2 else -0.9))
    expected = tracker.expect()
    assert expected is not None
    assert expected.motion is None


def test_a_shaking_tells_nothing_of_the_shutter():
    tracker = Tracker()
    for frame in range(8):
        tracker.learn(replace(seen(frame, 0.05), shaking=20.0))
    assert tracker.expect().motion is None
    for frame in range(8, 16):
        tracker.learn(seen(frame, 0.6))
    step = path(15 / FPS).position_mm - path(14 / FPS).position_mm
    known = tracker.expect().motion
    np.testing.assert_allclose(known.shift_mm, 0.6 * step, atol=0.03 * abs(step[2]))
    # What was learnt before is no use for a frame that shakes.
    tracker.learn(replace(seen(16, 0.6), shaking=20.0))
    assert tracker.expect().motion is None


def flight_frames(count):
    imaging = Imaging(exposure_ms=2.0, readout_ms=20.0)
    for frame in range(count):
        time_s = frame / FPS
        scene, motion = Scene(pad=sample_pad()), motion_along(path, time_s)
        yield render(scene, small_camera(), path(time_s), imaging, frame, motion=motion).image


def test_a_rolling_shutters_climb_is_told_from_tilt_while_tracking():
    detector = Detector(sample_pad(), small_camera())
    frames = list(flight_frames(12))
    tracked = list(detector.track(frames))
    assert all(found.ok for found in tracked)
    last = range(8, 12)
    single = [errors(detector.detect(frames[k]).pose, path(k / FPS))[0] for k in last]
    told = [errors(tracked[k].pose, path(k / FPS))[0] for k in last]
    assert np.median(told) < 0.5 * np.median(single)
    assert np.median(told) < 0.3


def test_a_pad_that_jumps_is_found_again_and_one_that_goes_is_lost():
    camera = small_camera()
    here, there = look_at_pad(700.0), look_at_pad(500.0, heading_deg=90, target_mm=(150, 0))
    gone = render(Scene(pad=None), camera, here).image
    frames = [frame_of(here, camera=camera)] * 2 + [frame_of(there, camera=camera), gone]
    found = list(Detector(sample_pad(), camera).track(frames))
    assert [item.ok for item in found] == [True, True, True, False]
    assert errors(found[2].pose, there)[0] < 0.3
