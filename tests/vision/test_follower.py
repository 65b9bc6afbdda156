"""Following a pad through frames of which some are dropped."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from dense_frames import errors, frame_of, sample_pad, small_camera
from hypothesis import given, settings
from hypothesis import strategies as st
from wandering import normalized_error

from padstudio.geometry.pose import look_at_pad
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render
from padstudio.simulate.sensor import Imaging
from padstudio.simulate.trajectories import FlightSpec, Setup, plan
from padstudio.vision.detector import Detector
from padstudio.vision.follower import Follower

FPS = 30.0
COUNT = 60


@cache
def landing():
    """Frames of two seconds of a gusty landing by a rolling shutter, and the true poses."""
    spec = FlightSpec(
        kind="gusty", frames=COUNT, from_mm=1200.0, to_mm=500.0, fps=FPS, seed=4, sway=0.5
    )
    scene = Scene(pad=sample_pad(), ground="gravel")
    imaging = Imaging(exposure_ms=2.0, readout_ms=15.0)
    setup = Setup(scene=scene, camera=small_camera(), imaging=imaging, seed=4)
    frames = list(plan(spec).frames(setup))
    return [frame.image for frame in frames], [frame.truth.pose for frame in frames]


@cache
def detector():
    return Detector(sample_pad(), small_camera())


def bare():
    return render(Scene(pad=None), small_camera(), look_at_pad(700.0)).image


steps = st.lists(
    st.one_of(st.just(1), st.integers(1, 4), st.integers(5, 30)), min_size=4, max_size=14
)


@settings(max_examples=12)
@given(steps)
def test_whatever_is_dropped_poses_agree_with_the_truth(steps):
    images, truths = landing()
    follower = Follower(detector())
    nees, poses = [], 0
    kept = [place for place in np.cumsum([0, *steps]) if place < COUNT]
    for place in kept:
        found = follower.take(images[place], place / FPS)
        if found.ok:
            poses += 1
            assert errors(found.pose, truths[place])[0] < 1.5
            nees.append(normalized_error(truths[place], found.pose, found.uncertainty.covariance))
    assert poses == len(kept)
    assert np.median(nees) < 1.5
    assert np.mean(nees) < 3
    assert max(nees) < 12


def test_frames_after_a_gap_are_followed_where_the_pad_is_near_its_expected_place():
    camera, pad = small_camera(), sample_pad()
    poses = [look_at_pad(900 - 4 * k, target_mm=(2.0 * k, 0)) for k in range(40)]
    follower = Follower(Detector(pad, camera))
    kept = [0, 1, 2, 3, 4, 8, 9, 10, 14, 20]
    found = {k: follower.take(frame_of(poses[k], camera=camera), k / FPS) for k in kept}
    assert all(item.ok for item in found.values())
    followed = [k for k in kept if "lines" not in found[k].elapsed_ms]
    # A steady camera is expected rightly after half of a second, too.
    assert {3, 4, 8, 9, 10, 14, 20} <= set(followed)
    assert errors(found[20].pose, poses[20])[0] < 0.3


def test_a_frame_without_the_pad_never_gives_a_pose_however_well_one_was_expected():
    images, _ = landing()
    follower = Follower(detector())
    for place in range(6):
        assert follower.take(images[place], place / FPS).ok
    for place in range(6, 40):
        assert not follower.take(bare(), place / FPS).ok
    assert follower.take(images[40], 40 / FPS).ok


@pytest.mark.parametrize("times", [[0.0, 0.0], [1.0, 0.5], [0.0, 1e6], [0.0, 1e-9]])
def test_times_that_make_no_sense_cost_no_pose(times):
    images, truths = landing()
    follower = Follower(detector())
    for place, time_s in enumerate([*times, times[-1] + 1 / FPS]):
        found = follower.take(images[place], time_s)
        assert found.ok
        assert errors(found.pose, truths[place])[0] < 1.0


def test_a_pad_that_jumps_is_given_at_once_where_it_is_found_all_over_the_frame():
    camera, pad = small_camera(), sample_pad()
    here, there = look_at_pad(700.0), look_at_pad(500.0, heading_deg=90, target_mm=(150, 0))
    follower = Follower(Detector(pad, camera))
    for place in range(8):
        assert follower.take(frame_of(here, camera=camera), place / FPS).ok
    jumped = [follower.take(frame_of(there, camera=camera), (8 + k) / FPS) for k in range(3)]
    for found in jumped:
        assert errors(found.pose, there)[0] < 0.3


def test_a_followed_pose_that_contradicts_those_before_it_is_not_given(monkeypatch):
    camera, pad = small_camera(), sample_pad()
    here = [look_at_pad(700.0 - k) for k in range(12)]
    follower = Follower(Detector(pad, camera))
    for place in range(10):
        assert follower.take(frame_of(here[place], camera=camera), place / FPS).ok
    own = follower._detector.look_near

    def slipped(frame, expected, **options):
        # As far away, and toward the same place, but from aside.
        return replace(own(frame, expected, **options), pose=look_at_pad(690.0, tilt_deg=4))

    monkeypatch.setattr(follower._detector, "look_near", slipped)
    found = follower.take(frame_of(here[10], camera=camera), 10 / FPS)
    assert not found.ok
    assert "contradicts" in found.failure.detail


def test_another_clock_begins_anew():
    images, truths = landing()
    follower = Follower(detector())
    for place in range(5):
        follower.take(images[place], 100 + place / FPS)
    follower.forget()
    found = follower.take(images[30], 2.0)
    assert found.ok
    assert errors(found.pose, truths[30])[0] < 1.0
    np.testing.assert_allclose(found.pose.position_mm, found.single.pose.position_mm)
