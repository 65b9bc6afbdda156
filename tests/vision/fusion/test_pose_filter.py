"""Tests of padstudio.vision.fusion: poses fused over time, against truth."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from wandering import Wandering, normalized_error, position_error

from padstudio.geometry.curvature import with_curvature
from padstudio.geometry.pose import Pose, look_at_pad, rotation_angle_deg, rotation_from_vector
from padstudio.vision.fusion.measurement import Fused, Measurement, pose_by_seen
from padstudio.vision.fusion.motion import MotionModel
from padstudio.vision.fusion.pose_filter import REBELS, FilterState, PoseFilter
from padstudio.vision.fusion.smoother import fuse

FAR = Wandering()
NEAR = Wandering(height_mm=600.0, fps=30.0, tilt_sigma_deg=0.02, sight_px=0.02)
SHAKEN = Wandering(height_mm=2000.0, fps=30.0, tilt_sigma_deg=0.3, shake_deg=0.2)


def fused_of(frames: list[Measurement], *, smooth: bool = False) -> list[Fused]:
    found = [fused for _, fused in fuse(frames, lambda frame: frame, PoseFilter(), smooth=smooth)]
    assert len(found) == len(frames)
    return [fused for fused in found if fused is not None]


def errors(fused: list[Fused] | list[Measurement], truth: list[Pose]) -> np.ndarray:
    return np.array([position_error(t, f.pose) for t, f in zip(truth, fused, strict=True)])


@pytest.mark.parametrize("smooth", [False, True])
@pytest.mark.parametrize("wandering", [FAR, NEAR, SHAKEN], ids=["far", "near", "shaken"])
def test_fused_covariance_is_true(wandering: Wandering, smooth: bool) -> None:
    nees = []
    for seed in range(6):
        frames, truth = wandering.frames(150, seed)
        for fused, pose in zip(fused_of(frames, smooth=smooth), truth, strict=True):
            nees.append(normalized_error(pose, fused.pose, fused.covariance))
    assert 0.7 < np.mean(nees) < 1.5
    assert 0.4 < np.median(nees) / 0.891 < 1.5


def test_far_frames_gain_by_those_before_and_more_by_those_after() -> None:
    single, filtered, smoothed = [], [], []
    for seed in range(6):
        frames, truth = FAR.frames(150, seed)
        single.append(errors(frames, truth))
        filtered.append(errors(fused_of(frames), truth))
        smoothed.append(errors(fused_of(frames, smooth=True), truth))
    assert np.median(filtered) < 0.7 * np.median(single)
    assert np.median(smoothed) < 0.8 * np.median(filtered)


def test_shaking_that_a_frame_measures_well_is_kept() -> None:
    wandering = replace(NEAR, shake_deg=0.3)
    frames, truth = wandering.frames(150, 3)
    for smooth in (False, True):
        turns = [
            rotation_angle_deg(f.pose.rotation, t.rotation)
            for f, t in zip(fused_of(frames, smooth=smooth), truth, strict=True)
        ]
        assert np.median(turns) < 0.05


def test_first_frame_says_what_it_says_alone() -> None:
    frame = FAR.frames(1, 0)[0][0]
    fused = PoseFilter().step(frame)
    assert np.allclose(fused.pose.position_mm, frame.pose.position_mm)
    assert np.allclose(fused.pose.rotation, frame.pose.rotation)
    assert np.allclose(fused.covariance, frame.covariance)


def test_attitudes_that_are_less_sure_than_they_say_are_found_out() -> None:
    wandering = replace(FAR, height_mm=3000.0, share=0.0)
    nees, single = [], []
    for seed in range(4):
        frames, truth = wandering.frames(200, seed)
        sure = [replace(f, covariance=_surer(f, 5.0)) for f in frames]
        for fused, frame, pose in list(zip(fused_of(sure), sure, truth, strict=True))[30:]:
            nees.append(normalized_error(pose, fused.pose, fused.covariance))
            single.append(normalized_error(pose, frame.pose, frame.covariance))
    assert np.median(single) > 5
    assert np.median(nees) < 2


def _surer(frame: Measurement, times: float) -> np.ndarray:
    """The covariance of a frame that makes more of its attitude than it knows."""
    _, _, seen = frame.seen
    seen = seen.copy()
    seen[3:] /= times
    seen[:, 3:] /= times
    by_seen = pose_by_seen(frame.pose)
    return with_curvature(by_seen @ seen @ by_seen.T, frame.pose)


def test_outlier_is_not_believed_and_leaves_no_trace() -> None:
    frames, truth = SHAKEN.frames(60, 1)
    wrong = look_at_pad(400.0, heading_deg=70.0)
    frames[30] = replace(frames[30], pose=wrong)
    fused = fused_of(frames)
    assert [f.is_outlier for f in fused] == [number == 30 for number in range(60)]
    assert errors(fused, truth).max() < 0.03
    assert normalized_error(truth[30], fused[30].pose, fused[30].covariance) < 3


def test_outliers_that_agree_are_right() -> None:
    frames, truth = SHAKEN.frames(90, 2)
    # The filter follows something else first, as long as it likes.
    elsewhere = Pose(np.array([500.0, 0.0, 900.0]), look_at_pad(900.0).rotation)
    frames[:40] = [replace(frame, pose=elsewhere) for frame in frames[:40]]
    fused = fused_of(frames)
    outliers = [number for number, f in enumerate(fused) if f.is_outlier]
    assert outliers == list(range(40, 40 + REBELS - 1))
    assert errors(fused[42:], truth[42:]).max() < 0.03
    smoothed = fused_of(frames, smooth=True)
    # The smoother knows better by then.
    assert not any(f.is_outlier for f in smoothed)
    assert errors(smoothed[40:], truth[40:]).max() < 0.03


def test_gap_widens_the_covariance_and_a_long_one_begins_anew() -> None:
    frames, truth = FAR.frames(150, 4)
    short = frames[:60] + frames[75:]
    fused = fused_of(short)
    nees = normalized_error(truth[75], fused[60].pose, fused[60].covariance)
    assert np.trace(fused[60].covariance[:3, :3]) > np.trace(fused[59].covariance[:3, :3])
    assert nees < 3
    fused = fused_of(frames[:60] + frames[110:])
    assert np.allclose(fused[60].covariance, frames[110].covariance)


def test_a_filter_goes_on_from_a_state_that_was_written_down() -> None:
    frames, _ = FAR.frames(60, 5)
    frames[29] = replace(frames[29], pose=look_at_pad(400.0))
    whole = fused_of(frames)
    first = PoseFilter()
    begun = [first.step(frame) for frame in frames[:30]]
    assert first.state is not None
    assert first.state.rival is not None
    record = json.loads(json.dumps(first.state.to_record()))
    second = PoseFilter(state=FilterState.from_record(record))
    resumed = begun + [second.step(frame) for frame in frames[30:]]
    for a, b in zip(whole, resumed, strict=True):
        assert np.array_equal(a.pose.position_mm, b.pose.position_mm)
        assert np.array_equal(a.pose.rotation, b.pose.rotation)
        assert np.array_equal(a.covariance, b.covariance)


def test_filter_looks_at_no_later_frame() -> None:
    frames, _ = FAR.frames(40, 6)
    other = frames[:20] + [replace(f, pose=look_at_pad(500.0)) for f in frames[20:]]
    for a, b in zip(fused_of(frames)[:20], fused_of(other)[:20], strict=True):
        assert np.array_equal(a.pose.position_mm, b.pose.position_mm)


def test_smoothing_in_stretches_is_smoothing_at_once() -> None:
    frames, _ = replace(FAR, fps=10.0).frames(300, 7)
    for start in (0, 37):
        whole = fused_of(frames[start:], smooth=True)
        alone = fused_of(frames[start : start + 80], smooth=True)
        # As long before the end as the smoother looks ahead, more frames change nothing.
        for a, b in zip(whole[:30], alone[:30], strict=True):
            sigma = np.sqrt(np.diag(a.covariance))
            assert (np.abs(a.pose.step_to(b.pose)) < 0.01 * sigma).all()


def test_warm_filter_forgets_where_it_began() -> None:
    frames, _ = replace(FAR, fps=10.0).frames(150, 8)
    whole, late = fused_of(frames), fused_of(frames[60:])
    for a, b in zip(whole[120:], late[60:], strict=True):
        sigma = np.sqrt(np.diag(a.covariance))
        assert (np.abs(a.pose.step_to(b.pose)) < 0.05 * sigma).all()


def test_what_lasts_is_not_averaged_away() -> None:
    """A camera at rest whose frames all err alike stays as unsure as the part that lasts."""
    frames, _ = replace(NEAR, shake_deg=0.0).frames(1, 0)
    pose_filter = PoseFilter()
    for number in range(40):
        fused = pose_filter.step(replace(frames[0], time_s=number / 30))
    single = np.trace(frames[0].covariance[:3, :3])
    share = MotionModel().share
    assert 0.5 * share * single < np.trace(fused.covariance[:3, :3]) < single


def test_half_a_turn_between_frames_is_an_outlier_and_no_error() -> None:
    frames, _ = NEAR.frames(20, 9)
    turned = frames[10].pose.rotation @ rotation_from_vector(np.array([0.0, 0.0, np.pi]))
    frames[10] = replace(frames[10], pose=Pose(frames[10].pose.position_mm, turned))
    fused = fused_of(frames)
    assert fused[10].is_outlier
    assert all(np.isfinite(f.pose.rotation).all() for f in fused)
