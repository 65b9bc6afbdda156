"""The pad as a picture, and the pixels of a frame that show it."""

import cv2
import numpy as np
import pytest
from dense_frames import frame_of, sample_pad, small_camera

from padstudio.arrays import YuvFrame
from padstudio.geometry.pose import look_at_pad
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.vision.frame.pyramid import Pyramid
from padstudio.vision.frame.yuv import YuvPyramid
from padstudio.vision.pose.least_squares import STILL
from padstudio.vision.pose.pattern.image_alignment import Match
from padstudio.vision.pose.pattern.template import on_pad, pixels_of, texture_of

CAMERA = small_camera()


def test_rays_meet_the_pad_where_it_projects_to():
    pose = look_at_pad(2000.0, tilt_deg=30, heading_deg=20)
    rng = np.random.default_rng(3)
    rays = np.column_stack([rng.uniform(-0.2, 0.2, (40, 2)), np.ones(40)])
    points = np.column_stack([on_pad(pose, rays), np.zeros(40)])
    seen = (points - pose.position_mm) @ pose.rotation
    np.testing.assert_allclose(seen[:, :2] / seen[:, 2:], rays[:, :2], atol=1e-12)


@pytest.mark.parametrize("px_per_mm", [0.5, 0.55])
def test_the_texture_is_the_pad(px_per_mm):
    pad = sample_pad()
    texture = texture_of(pad, px_per_mm)
    assert texture is texture_of(pad, px_per_mm * 1.01)
    for layer, shown in zip(pad.layers, texture.layers, strict=True):
        rows, cols = np.mgrid[: layer.rows, : layer.cols] + 0.5
        x_mm = cols * layer.cell_mm - pad.size_mm[0] / 2
        y_mm = pad.size_mm[1] / 2 - rows * layer.cell_mm
        x = np.round(texture.place[0] + texture.place[1] * x_mm).astype(int)
        y = np.round(texture.place[2] + texture.place[3] * y_mm).astype(int)
        value = shown[y, x]
        assert value.min() >= 0
        assert value.max() <= 1
        right = ((value > 0.5) == (layer.field == 1)).mean()
        assert right > (0.99 if layer.cell_mm > 20 else 0.9)
        # A blur moves light and loses none, but for what lies beyond the rim.
        assert shown.mean() == pytest.approx(layer.field.mean(), rel=0.03)


def test_pixels_show_the_pad_and_nothing_beyond_its_rim():
    pose = look_at_pad(3000.0, tilt_deg=20, heading_deg=10)
    pyramid = Pyramid(frame_of(pose, camera=CAMERA))
    pixels = pixels_of(pyramid, CAMERA, sample_pad(), MovingPose(pose), 16_000)
    assert pixels is not None
    assert np.abs(on_pad(pose, pixels.rays.T)).max() < 625
    assert pixels.values.shape == (2, len(pixels.row_time))
    stride = -(-len(pixels.row_time) // 1000)
    few = pixels.thinned(1000)
    assert len(few.row_time) <= 1000
    np.testing.assert_array_equal(few.values, pixels.values[:, ::stride])
    assert pixels.thinned(10**6) is pixels


@pytest.mark.parametrize("most", [300, 800, 1500, 3000, 6000, 20_000])
@pytest.mark.parametrize("corner", [0, 1])
def test_colours_of_two_by_two_pixels_are_off_to_no_side(most, corner):
    pose = look_at_pad(3000.0, target_mm=(7.0 * corner, 3.0))
    image = frame_of(pose, camera=CAMERA)
    pixels = pixels_of(Pyramid(image), CAMERA, sample_pad(), MovingPose(pose), most)
    xy = np.round(CAMERA.focal_px * pixels.rays[:2].T + CAMERA.matrix[:2, 2]).astype(int)
    off = xy % 2 - 0.5
    assert np.abs(off.mean(axis=0)).max() < 0.1
    assert abs((off[:, 0] * off[:, 1]).mean()) < 0.05
    assert (np.diff(xy[:, 1]) >= 0).all()


@pytest.mark.parametrize("height_mm", [2900.0, 3300.0, 3800.0])
def test_a_video_shows_a_far_pad_where_it_is(height_mm):
    pose = look_at_pad(height_mm, tilt_deg=10, heading_deg=25)
    bgr = frame_of(pose, camera=CAMERA)
    y, red, blue = cv2.split(cv2.cvtColor(bgr, cv2.COLOR_BGR2YCrCb))
    half = [cv2.resize(c, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA) for c in (blue, red)]
    wide = [cv2.resize(c, None, fx=2, fy=2, interpolation=cv2.INTER_NEAREST) for c in half]
    merged = cv2.merge([y, wide[1], wide[0]])
    plain = cv2.cvtColor(merged, cv2.COLOR_YCrCb2BGR)
    frame = YuvFrame(y, *half, CAMERA.width, "bt601", True, lambda: plain)
    for pyramid in (YuvPyramid(frame), Pyramid(plain)):
        for most in (500, 1000, 2000, 4000):
            match = Match.of(pyramid, CAMERA, sample_pad(), MovingPose(pose), most)
            found = match.fit(MovingPose(pose), STILL).pose.pose
            middle = pose.to_camera(np.zeros((1, 3)))[0], found.to_camera(np.zeros((1, 3)))[0]
            there, here = (point[:2] / point[2] * CAMERA.focal_px for point in middle)
            assert np.abs(there - here).max() < 0.12
