"""The whole pattern matched to a far pad."""

import numpy as np
import pytest
from dense_frames import errors, frame_of, random_pose, sample_pad, small_camera

from padstudio.geometry.pose import look_at_pad
from padstudio.simulate.imaging import Imaging
from padstudio.vision.align import align
from padstudio.vision.motion import MovingPose
from padstudio.vision.pattern import by_pose, look_up, on_pad, pixels_of, texture_of
from padstudio.vision.planes import Pyramid

CAMERA = small_camera()


def view(pose, imaging=None):
    return Pyramid(frame_of(pose, camera=CAMERA, imaging=imaging))


@pytest.mark.parametrize("height_mm", [2500.0, 5000.0])
def test_a_start_off_by_a_pixel_is_mended(height_mm):
    pose = random_pose(np.random.default_rng(int(height_mm)), height_mm, tilt_deg=25.0)
    nudge = np.array([0.7, -0.5, 1.0]) * height_mm / 440
    start = MovingPose(pose).moved(np.concatenate([nudge, [0.0005, -0.0005, 0.001]]))
    fit = align(view(pose), CAMERA, sample_pad(), start, motion=False)
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
    fit = align(Pyramid(image), CAMERA, sample_pad(), MovingPose(pose), motion=False)
    assert fit is not None
    assert errors(fit.pose.pose, pose)[0] < 0.2


def test_a_pad_of_too_few_pixels_or_out_of_view_is_not_matched():
    pyramid = view(look_at_pad(60_000.0))
    assert (
        align(pyramid, CAMERA, sample_pad(), MovingPose(look_at_pad(60_000.0)), motion=False)
        is None
    )
    away = MovingPose(look_at_pad(3000.0, target_mm=(9000, 0)))
    assert align(pyramid, CAMERA, sample_pad(), away, motion=False) is None


@pytest.mark.parametrize("seed", range(3))
def test_points_on_the_pad_move_with_the_pose_as_said(seed):
    rng = np.random.default_rng(seed)
    pose = MovingPose(random_pose(rng, 2000.0), rng.normal(0, 3, 3), rng.normal(0, 1e-3, 3))
    rays = np.column_stack([rng.uniform(-0.2, 0.2, (40, 2)), np.ones(40)])
    moment = rng.uniform(-0.5, 0.5, 40)
    points, direction = on_pad(pose, rays, moment)
    # A ray meets the pad at a point whose picture is that ray.
    seen = pose.to_camera(np.column_stack([points, np.zeros(40)]), moment)
    np.testing.assert_allclose(seen[:, :2] / seen[:, 2:], rays[:, :2], atol=2e-5)
    change = by_pose(pose, rays, direction)
    for k, size in enumerate([1e-2] * 3 + [1e-5] * 3):
        step = np.zeros(6)
        step[k] = size
        after, before = (on_pad(pose.moved(sign * step), rays, moment)[0] for sign in (1, -1))
        there = (after - before) / (2 * size)
        np.testing.assert_allclose(change[:, :, k], there, atol=1e-2 * np.abs(there).max() + 1e-6)


def test_the_texture_is_the_pad():
    pad = sample_pad()
    texture = texture_of(pad, 0.5)
    for layer, shown in zip(pad.layers, texture.layers, strict=True):
        rows, cols = np.mgrid[: layer.rows, : layer.cols] + 0.5
        points = np.stack(
            [
                cols.ravel() * layer.cell_mm - pad.size_mm[0] / 2,
                pad.size_mm[1] / 2 - rows.ravel() * layer.cell_mm,
            ],
            axis=1,
        )
        value, slope = look_up(texture, shown, points)
        assert value.min() >= 0
        assert value.max() <= 1
        right = ((value > 0.5) == (layer.field.ravel() == 1)).mean()
        assert right > (0.99 if layer.cell_mm > 20 else 0.9)
        assert slope.shape == (layer.field.size, 2)


def test_pixels_show_the_pad_and_nothing_beyond_its_rim():
    pose = look_at_pad(3000.0, tilt_deg=20, heading_deg=10)
    pixels = pixels_of(view(pose), CAMERA, sample_pad(), MovingPose(pose))
    assert pixels is not None
    points, _ = on_pad(MovingPose(pose), pixels.rays, np.zeros(len(pixels.rays)))
    assert np.abs(points).max() < 625
    assert set(pixels.values) == {"red", "blue"}
    assert len(pixels.tile) == len(pixels.moment) == len(pixels.shade)
