"""The whole pattern matched to a far pad."""

import numpy as np
import pytest
from dense_frames import errors, frame_of, random_pose, sample_pad, small_camera

from padstudio.geometry.planar_pnp import mirrored
from padstudio.geometry.pose import look_at_pad
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.simulate.motion import Motion
from padstudio.simulate.radiance.scene import Scene
from padstudio.simulate.render import render
from padstudio.simulate.sensor import Imaging
from padstudio.simulate.vibration import Vibration
from padstudio.vision.frame.pyramid import Pyramid
from padstudio.vision.pose.least_squares import MOVING, STILL
from padstudio.vision.pose.pattern.image_alignment import Match
from padstudio.vision.pose.pattern.solver_kernel import stretched

CAMERA = small_camera()


def view(pose, imaging=None):
    return Pyramid(frame_of(pose, camera=CAMERA, imaging=imaging))


def matched(pyramid, start):
    return Match.of(pyramid, CAMERA, sample_pad(), start, 16_000).fit(start, STILL)


@pytest.mark.parametrize("height_mm", [2500.0, 5000.0])
def test_a_start_off_by_a_pixel_is_mended(height_mm):
    pose = random_pose(np.random.default_rng(int(height_mm)), height_mm, tilt_deg=25.0)
    nudge = np.array([0.7, -0.5, 1.0]) * height_mm / 440
    start = MovingPose(pose).moved(np.concatenate([nudge, [0.0005, -0.0005, 0.001]]))
    fit = matched(view(pose), start)
    assert fit is not None
    position, attitude = errors(fit.pose.pose, pose)
    assert position < 0.3
    assert attitude < 0.2
    error = fit.pose.step_to(MovingPose(pose))
    assert error @ np.linalg.solve(fit.covariance + np.eye(6) * 1e-9, error) / 6 < 6
    assert 0 < fit.rms_px < 3


def test_light_that_falls_off_does_not_move_it():
    pose = look_at_pad(3000.0, tilt_deg=15, heading_deg=40)
    image = frame_of(pose, camera=CAMERA, imaging=Imaging(brightness=0.3, vignetting=0.6))
    fit = matched(Pyramid(image), MovingPose(pose))
    assert fit is not None
    assert errors(fit.pose.pose, pose)[0] < 0.2


def test_a_pad_of_too_few_pixels_or_out_of_view_is_not_matched():
    pyramid = view(look_at_pad(60_000.0))
    far = MovingPose(look_at_pad(60_000.0))
    assert Match.of(pyramid, CAMERA, sample_pad(), far, 16_000) is None
    away = MovingPose(look_at_pad(3000.0, target_mm=(9000, 0)))
    assert Match.of(pyramid, CAMERA, sample_pad(), away, 16_000) is None


def test_a_rough_match_tells_a_right_start_from_a_mirrored_one():
    pose = look_at_pad(3500.0, tilt_deg=25, heading_deg=70, tilt_towards_deg=10)
    mirrored = look_at_pad(3500.0, tilt_deg=25, heading_deg=70, tilt_towards_deg=190)
    pyramid, off = view(pose), []
    for start in (pose, mirrored):
        match = Match.of(pyramid, CAMERA, sample_pad(), MovingPose(start), 16_000)
        fit = match.fit(MovingPose(start), STILL, rough=True)
        off.append(fit.rms_px)
    assert off[0] < 0.8 * off[1]


def test_brightness_found_for_one_pose_serves_the_next():
    pose = MovingPose(look_at_pad(3000.0, tilt_deg=15, heading_deg=40))
    start = pose.moved(np.array([3.0, -2.0, 4.0, 0.0004, 0, 0.001]))
    match = Match.of(view(pose.pose), CAMERA, sample_pad(), start, 16_000)
    first = match.fit(start, STILL)
    again = match.fit(first.pose, STILL)
    moving = match.fit(first.pose, MOVING)
    assert np.abs(first.pose.step_to(again.pose)[:3]).max() < 0.2
    assert moving.rms_px <= again.rms_px * 1.001


def test_a_pad_so_small_that_its_mirror_image_fits_says_so():
    """Perspective draws its halves alike to some hundredths of a pixel: either tilt may be."""
    pose = look_at_pad(18_000.0, tilt_deg=4.0, heading_deg=30.0)
    fit = matched(view(pose, Imaging()), MovingPose(pose))
    assert fit is not None
    step = MovingPose(pose).step_to(MovingPose(mirrored(pose)))
    away = step / np.linalg.norm(step)
    assert np.sqrt(away @ fit.covariance @ away) > 0.2 * np.linalg.norm(step)
    # Distance and bearing are as sure as ever.
    axis = pose.position_mm / np.linalg.norm(pose.position_mm)
    assert np.sqrt(axis @ fit.covariance[:3, :3] @ axis) < 0.02 * 18_000.0


def test_a_picture_blurred_beyond_its_pattern_leaves_the_attitude_in_doubt():
    pose = look_at_pad(2500.0, tilt_deg=10.0, heading_deg=30.0)
    sigma = []
    for blur_px in (0.6, 1.6):
        fit = matched(view(pose, Imaging(blur_px=blur_px)), MovingPose(pose))
        assert fit is not None
        sigma.append(np.sqrt(np.diag(fit.covariance)[5]) * CAMERA.focal_px)
    assert sigma[1] > 0.5 > sigma[0]


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_far_pad_in_rows_that_shake_is_matched_until_they_fit(seed):
    """A still camera would have to lean by several degrees to show the same shear."""
    rng = np.random.default_rng(seed)
    pose = look_at_pad(5000.0, tilt_deg=4.0, heading_deg=100.0 * seed)
    shaking = tuple(Vibration.drawn(rng, hz, 0.1) for hz in (93.0, 141.0))
    imaging = Imaging(exposure_ms=0.0, readout_ms=20.0)
    scene, motion = Scene(pad=sample_pad()), Motion(vibrations=shaking)
    image = render(scene, CAMERA, pose, imaging, seed, motion=motion).image
    match = Match.of(Pyramid(image), CAMERA, sample_pad(), MovingPose(pose), 16_000)
    still = match.fit(MovingPose(pose), STILL)
    # A fit that went astray does not change what an earlier one says.
    match.fit(still.pose.moved(np.r_[np.zeros(6), np.full(6, 0.02)]), MOVING)
    found = still.settled()
    assert found.shaking > 10
    assert errors(found.pose.pose, pose)[1] < 1.2 < errors(still.pose.pose, pose)[1]
    error = found.pose.step_to(MovingPose(pose))
    assert error @ np.linalg.solve(found.covariance, error) / 6 < 4


def test_steps_that_go_a_part_of_the_way_are_lengthened_by_what_they_leave():
    normal, step = np.diag([1.0, 4.0, 100.0]), np.array([3.0, -1.0, 0.2])
    # Steps that leave 40 % are to be 1/0.6 times as long, however long the last one was made.
    for before in (1.0, 1.5):
        left = 1 - 0.6 * before
        found = stretched(before, float(step @ normal @ (left * step)), step, normal)
        assert found == pytest.approx(1 / 0.6)
    assert stretched(1.0, -5.0, step, normal) == 1.0
    assert stretched(1.0, float(step @ normal @ step), step, normal) == 2.5
