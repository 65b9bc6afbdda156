"""Frames in planes show the same as their pictures in BGR."""

import cv2
import numpy as np
import pytest
from dense_frames import errors, frame_of, near_view, params, recorder, sample_pad, small_camera

from padstudio.arrays import YuvFrame
from padstudio.geometry.pose import look_at_pad
from padstudio.vision.cells import cells_kernel
from padstudio.vision.detector import Detector
from padstudio.vision.frame.pixels_kernel import values_at
from padstudio.vision.frame.prepare import find_denoise, prepare
from padstudio.vision.frame.pyramid import Pyramid
from padstudio.vision.frame.yuv import YuvPyramid


def in_planes(bgr):
    """A frame of full range BT.601, as OpenCV makes them of even sizes, and its way back."""
    height, width = bgr.shape[:2]
    y, cr, cb = cv2.split(cv2.cvtColor(bgr, cv2.COLOR_BGR2YCrCb))
    u, v = (
        cv2.resize(c, (width // 2, height // 2), interpolation=cv2.INTER_AREA) for c in (cb, cr)
    )

    def make_bgr():
        wide = [cv2.resize(c, (width, height), interpolation=cv2.INTER_NEAREST) for c in (v, u)]
        return cv2.cvtColor(cv2.merge([y, *wide]), cv2.COLOR_YCrCb2BGR)

    return YuvFrame(y, u, v, width, "bt601", True, make_bgr)


def shown(pyramid, channel, level):
    """Values at every pixel of a level but the outermost."""
    window = pyramid.window(channel, level)
    y, x = np.mgrid[1 : len(window.values) - 1, 1 : window.width - 1].astype(float)
    xy = window.to_frame(np.stack([x, y], axis=-1))
    return cells_kernel.sample(window, xy, np.ones(x.shape, bool))


def smooth(seed, height=96, width=160):
    rng = np.random.default_rng(seed)
    small = rng.integers(60, 200, (height // 16, width // 16, 3)).astype(np.uint8)
    return cv2.resize(small, (width, height), interpolation=cv2.INTER_CUBIC)


@pytest.mark.parametrize("channel", ["red", "green", "blue"])
@pytest.mark.parametrize("level", [0, 1, 2, 3])
def test_every_channel_at_every_scale_is_that_of_the_picture(channel, level):
    frame = in_planes(smooth(level))
    found, plain = (
        shown(p(f), channel, level) for p, f in ((YuvPyramid, frame), (Pyramid, frame.bgr))
    )
    off = found - plain
    # At the frame's own scale pictures repeat the colours that are drawn out between pixels here.
    assert np.abs(off).max() <= (3 if level else 14)
    assert abs(off.mean()) < 0.6


@pytest.mark.parametrize("channel", ["red", "green", "blue"])
def test_single_pixels_are_those_of_the_picture(channel):
    frame = in_planes(smooth(4))
    # As pictures of which colours are drawn out between pixels.
    y, u, v = frame.y, *(cv2.resize(c, (160, 96)) for c in (frame.u, frame.v))
    drawn = cv2.cvtColor(cv2.merge([y, v, u]), cv2.COLOR_YCrCb2BGR)
    plain = Pyramid(frame.bgr if channel == "green" else drawn)
    every = np.stack(np.meshgrid(np.arange(160.0), np.arange(96.0)), axis=-1).reshape(-1, 2)
    found, there = (
        values_at(pyramid.window(channel, 0), every) for pyramid in (YuvPyramid(frame), plain)
    )
    np.testing.assert_allclose(found, there, atol=2)


def test_a_limited_range_of_the_other_standard_is_the_same_picture():
    """By the equations of ITU-R BT.709, from a full picture to 16 … 235 and 16 … 240."""
    blue, green, red = (c.astype(float) for c in cv2.split(smooth(9)))
    bright = 0.2126 * red + 0.7152 * green + 0.0722 * blue
    y = np.round(16 + 219 / 255 * bright)
    u, v = ((c - bright) / (2 * (1 - k)) for c, k in ((blue, 0.0722), (red, 0.2126)))
    u, v = (np.round(128 + 224 / 255 * cv2.resize(c, None, fx=0.5, fy=0.5)) for c in (u, v))
    frame = YuvFrame(*(p.astype(np.uint8) for p in (y, u, v)), 160, "bt709", False, lambda: None)
    pyramid = YuvPyramid(frame)
    for channel, plain in (("red", red), ("blue", blue)):
        half = cv2.resize(plain, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
        np.testing.assert_allclose(shown(pyramid, channel, 1), half[1:-1, 1:-1], atol=4)
    grey = pyramid.brightness
    np.testing.assert_allclose(grey.gain * grey.values + grey.black, bright, atol=1.5)


def test_odd_sides_end_as_those_of_the_picture():
    bgr = smooth(3)[:95, :159]
    even = in_planes(smooth(3))
    frame = YuvFrame(even.y[:95], even.u, even.v, 159, "bt601", True, lambda: bgr)
    pyramid, plain = YuvPyramid(frame), Pyramid(bgr)
    for level in (0, 1, 2):
        found = [shown(p, "red", level) for p in (pyramid, plain)]
        assert found[0].shape == found[1].shape
        assert np.abs(found[0] - found[1]).max() <= 4
    assert (pyramid.width, pyramid.height) == (159, 95)


def test_frames_are_followed_alike():
    image, _, pose = near_view()
    detector = Detector(sample_pad(), small_camera(), params=params())
    frame = in_planes(image)
    *_, plain = detector.track([frame.bgr] * 3)
    *_, found = detector.track([frame] * 3)
    assert found.ok
    assert "outline" not in found.elapsed_ms
    assert errors(found.pose, plain.pose)[0] < 0.15
    assert errors(found.pose, pose)[0] < 1.0
    *_, traced = detector.track([frame] * 2, trace=True)
    np.testing.assert_array_equal(traced.trace.image, frame.bgr)


def test_salt_and_pepper_are_taken_from_the_picture():
    frame = frame_of(look_at_pad(900.0), camera=small_camera())
    rng = np.random.default_rng(5)
    spoilt = frame.copy()
    spoilt[rng.random(frame.shape[:2]) < 0.05] = 255
    spoilt[rng.random(frame.shape[:2]) < 0.05] = 0
    clean, salted = in_planes(frame), in_planes(spoilt)
    assert not find_denoise(YuvPyramid(clean).brightness, 0.005).applied
    assert find_denoise(YuvPyramid(salted).brightness, 0.005).applied
    quiet = recorder()
    assert isinstance(prepare(clean, sample_pad(), params().prepare, quiet), YuvPyramid)
    median = prepare(salted, sample_pad(), params().prepare, quiet)
    np.testing.assert_array_equal(median.level(0), cv2.medianBlur(salted.bgr, 3))
