"""Stretch, denoise and channel."""

import cv2
import numpy as np
import pytest

from padstudio.vision.frame.prepare import (
    denoised,
    find_denoise,
    find_stretch,
    take_channel,
)
from padstudio.vision.frame.pyramid import Pyramid


def ramp(low, high, shape=(300, 400)):
    """A picture whose grey values run evenly from low to high."""
    values = np.linspace(low, high, shape[0] * shape[1]).reshape(shape)
    return np.repeat(np.round(values)[:, :, None], 3, axis=2).astype(np.uint8)


def salted(image, share, seed=1):
    rng = np.random.default_rng(seed)
    out = image.copy()
    hit = rng.random(image.shape[:2]) < share
    out[hit] = rng.choice(np.array([0, 255], np.uint8), int(hit.sum()))[:, None]
    return out


@pytest.mark.parametrize(("low", "high"), [(0, 255), (40, 90), (100, 250)])
def test_stretch_spans_the_grey_values(low, high):
    image = ramp(low, high)
    stretch = find_stretch(Pyramid(image))
    assert stretch.low == pytest.approx((low,) * 3, abs=2)
    assert stretch.high == pytest.approx((high,) * 3, abs=2)
    spread = stretch.apply(image)
    assert (spread.min(), spread.max()) == (0, 255)


def test_a_few_hot_pixels_do_not_decide():
    image = ramp(60, 120)
    image[::40, ::40] = 255
    assert max(find_stretch(Pyramid(image)).high) < 125


def test_a_flat_picture_is_not_blown_up():
    stretch = find_stretch(Pyramid(np.full((200, 300, 3), 77, np.uint8)))
    assert stretch.gain("red") == pytest.approx(255 / 12)


def test_dark_and_burnt_shares():
    image = ramp(50, 200)
    image[:150] = 0
    image[225:, :, 2] = 255
    stretch = find_stretch(Pyramid(image))
    assert stretch.dark == pytest.approx(0.5, abs=0.01)
    assert stretch.bright == pytest.approx(0.25, abs=0.01)


def test_a_channel_is_stretched_and_not_clipped():
    image = ramp(60, 120)
    image[0, 0] = 255
    pyramid = Pyramid(image)
    plane = take_channel(pyramid, find_stretch(pyramid), "red", 0)
    assert plane.values[0, 0] > 700
    assert np.percentile(plane.values, [1, 99]) == pytest.approx([0, 255], abs=10)


def test_impulses_are_pixels_far_from_their_neighbours_median():
    """As OpenCV's median tells it, everywhere in five squares but at their rims."""
    image = salted(ramp(0, 255, (400, 500)), 0.05, seed=3)
    channel = np.ascontiguousarray(image[:, :, 1])
    stands_out = cv2.absdiff(channel, cv2.medianBlur(channel, 3)) > 60
    impulse = stands_out & ((channel <= 8) | (channel >= 247))
    size, plain = 96, 0
    for fy, fx in ((0.5, 0.5), (0.25, 0.25), (0.25, 0.75), (0.75, 0.25), (0.75, 0.75)):
        y, x = int(fy * (400 - size)), int(fx * (500 - size))
        plain += impulse[y + 1 : y + size - 1, x + 1 : x + size - 1].sum()
    found = find_denoise(Pyramid(image).brightness, 0.005)
    assert found.impulses == pytest.approx(plain / (5 * 94**2), rel=1e-9)


@pytest.mark.parametrize("share", [0.02, 0.08])
def test_salt_is_measured_and_removed(share):
    clean = ramp(60, 190)
    found = find_denoise(Pyramid(salted(clean, share)).brightness, 0.005)
    assert found.applied
    assert found.impulses == pytest.approx(share, rel=0.15)
    left = np.abs(denoised(salted(clean, share), found).astype(int) - clean)
    assert (left > 4).mean() < 0.1 * share


def test_a_clean_picture_stays_as_it_is():
    image = ramp(0, 255)
    found = find_denoise(Pyramid(image).brightness, 0.005)
    assert not found.applied
    assert denoised(image, found) is image


def test_a_picture_is_grey_where_its_channels_are_alike():
    grey = ramp(20, 220)
    assert find_stretch(Pyramid(grey)).grey
    tinted = grey.copy()
    tinted[100:140, 100:180, 2] += 20
    assert not find_stretch(Pyramid(tinted)).grey
