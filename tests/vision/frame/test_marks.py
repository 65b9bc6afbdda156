"""What tells a pad from the ground, where it hardly differs."""

import cv2
import numpy as np
import pytest
from dense_frames import frame_of, random_pose, sample_pad, small_camera

from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.layout import outline_mm
from padstudio.vision.frame.marks import halfway, likeness_of, parted, share_of
from padstudio.vision.frame.pyramid import Pyramid
from padstudio.vision.frame.regions import faint_regions, find_regions

GREEN = [1]


def veiled(image, left):
    """The picture behind a veil that leaves so much of its contrast."""
    noise = np.random.default_rng(1).normal(0, 1.0, image.shape)
    return np.clip(left * image + (1 - left) * 190 + noise, 0, 255).astype(np.uint8)


def overlap(region, pose, camera):
    corners = MovingPose(pose).project(camera, outline_mm(sample_pad()))
    mask = np.zeros(region.mask.shape, np.uint8)
    cv2.fillPoly(mask, [np.round(corners / (1 << region.level)).astype(np.int32)], 1)
    return (region.mask & (mask > 0)).sum() / (region.mask | (mask > 0)).sum()


@pytest.mark.parametrize("ground", ["gravel", "asphalt", "bricks", "concrete"])
@pytest.mark.parametrize("left", [0.3, 0.15])
def test_a_veiled_pad_is_a_faint_region(ground, left):
    camera, pose = small_camera(), random_pose(np.random.default_rng(8), 2200.0)
    pyramid = Pyramid(veiled(frame_of(pose, camera=camera, ground=ground), left))
    clear = find_regions(pyramid, sample_pad())[:-1]
    regions = [*clear, *faint_regions(pyramid, sample_pad(), clear)]
    assert len(regions) <= 7
    assert max(overlap(item, pose, camera) for item in regions) > 0.6


def test_black_is_of_no_colour():
    dark = np.zeros((40, 60, 3), np.uint8)
    np.testing.assert_allclose(share_of(dark, GREEN), 1 / 3, atol=1e-6)
    assert halfway(share_of(dark, GREEN)) is None


def test_channels_that_vary_alike_and_apart():
    rng = np.random.default_rng(2)
    first, second = rng.integers(0, 255, (2, 60, 80), dtype=np.uint8)
    alike = likeness_of(np.stack([first, second, first], axis=-1), 0, 2)
    apart = likeness_of(np.stack([first, second, first], axis=-1), 0, 1)
    assert alike.min() > 0.99
    assert abs(apart.mean()) < 0.05


def test_one_kind_of_pixel_is_not_parted():
    bell = np.random.default_rng(3).normal(0.3, 0.01, (200, 300)).astype(np.float32)
    assert parted(bell) is None
    assert parted(np.full((20, 30), 0.3, np.float32)) is None
    bell[50:90, 80:160] -= 0.06
    found = parted(bell)
    assert found is not None
    assert found.mask[55:85, 85:155].mean() > 0.95
    assert found.mask.mean() < 0.12
