"""The pattern row by row against the pattern as a whole, and the steps' own parts."""

import numpy as np
import pytest
from dense_frames import random_pose

from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.vision.pose.edge_points import Sway
from padstudio.vision.pose.noise_kernel import TILES
from padstudio.vision.pose.pattern.alignment_kernel import match_pattern
from padstudio.vision.pose.pattern.block_kernel import Brightness, Pixels, Texture
from padstudio.vision.pose.pattern.elimination_kernel import eliminated, without_brightness
from padstudio.vision.pose.pattern.rows_kernel import blur_variance, match_rows
from padstudio.vision.pose.pattern.solver_kernel import median_size


def scene(n=700):
    rng = np.random.default_rng(3)
    pose = MovingPose(random_pose(rng, 2000.0), rng.normal(0, 3, 3), rng.normal(0, 1e-3, 3))
    x, y = np.meshgrid(np.linspace(0, 6, 90), np.linspace(0, 5, 90))
    layers = np.stack([np.sin(x) * np.cos(y), np.cos(1.3 * x + y)]).astype(np.float32)
    pixels = Pixels(
        np.vstack([rng.uniform(-0.1, 0.1, (2, n)), np.ones((1, n))]),
        np.sort(rng.uniform(-0.4, 0.4, n)),
        np.vstack([np.ones((1, n)), rng.uniform(-1, 1, (5, n))]),
        rng.integers(0, TILES**2, n),
        rng.uniform(0, 255, (2, n)).astype(np.float32),
    )
    texture = Texture(layers, np.array([45.0, 0.05, 45.0, -0.05]))
    return pose, pixels, texture, Brightness(rng.normal(0, 20, (2, 12)), np.array([60.0, 90.0]))


def test_rows_sum_up_to_the_whole():
    pose, pixels, texture, brightness = scene()
    rows = match_rows(pixels, texture, pose.state, brightness, np.zeros((0, 3)))
    whole = match_pattern(pixels, texture, pose.state, brightness, 12, 1)
    np.testing.assert_array_equal(rows.whole.residuals, whole.residuals)
    np.testing.assert_allclose(rows.whole.sums, whole.sums, rtol=1e-10)
    of_pose = np.r_[:6, 12:24]
    lower = np.tril(whole.normal[:, of_pose][:, :, of_pose])
    np.testing.assert_allclose(np.tril(rows.whole.normal), lower, rtol=1e-9, atol=1e-6)
    starts = rows.first + rows.width * np.arange(rows.normal.shape[2])
    once = rows.normal[:, 0] * starts[:, None, None] + rows.normal[:, 1] * rows.width
    assert rows.normal.shape[2] == 16
    for c in range(2):
        scale = np.abs(whole.normal[c, :12, :12]).max()
        here, later = rows.normal[c, 0].sum(axis=0), once[c].sum(axis=0)
        np.testing.assert_allclose(
            np.tril(here), np.tril(whole.normal[c, :6, :6]), atol=1e-9 * scale
        )
        np.testing.assert_allclose(later, whole.normal[c, 6:12, :6], atol=1e-9 * scale)
        pull = rows.pull[c, 0] * starts[:, None] + rows.pull[c, 1] * rows.width
        np.testing.assert_allclose(pull.sum(axis=0), whole.right[c, 0, 6:12], rtol=1e-9)


def test_rows_of_a_shaken_frame_are_seen_from_where_the_shaking_puts_them():
    pose, pixels, texture, brightness = scene()
    plain = match_rows(pixels, texture, pose.state, brightness, np.zeros((0, 3)))
    ends = plain.first + plain.width * np.arange(17)
    sway = Sway(ends, np.random.default_rng(4).normal(0, 2e-3, (17, 3)))
    shaken = match_rows(pixels, texture, pose.state, brightness, sway.rotvec)
    for k in (0, 7, 15):
        here = sway.within(pose, ends[k], ends[k + 1]).state
        among = (pixels.row_time >= ends[k]) & (pixels.row_time < ends[k + 1])
        there = match_pattern(pixels, texture, here, brightness, 6, 1)
        found = shaken.whole.residuals[:, among]
        np.testing.assert_allclose(found, there.residuals[:, among], atol=1e-3)


def test_a_picture_is_as_blurred_as_was_said():
    pose, pixels, texture, _ = scene()
    terms = np.zeros((2, 12))
    terms[0, 6], terms[1, 9] = 80.0, 50.0
    still = MovingPose(pose.pose)
    sharp = match_pattern(pixels, texture, still.state, Brightness(terms, np.zeros(2)), 0, 1)
    drawn = pixels.values - sharp.residuals
    layers = texture.layers
    bend = -4 * layers
    for axis in (1, 2):
        bend += np.roll(layers, 1, axis) + np.roll(layers, -1, axis)
    blurred = texture._replace(layers=(layers + 0.3 / 2 * bend).astype(np.float32))
    found = match_pattern(pixels, blurred, still.state, Brightness(terms, np.zeros(2)), 0, 1)
    left = (pixels.values - found.residuals - drawn).astype(np.float32)
    variance = blur_variance(pixels, texture, still.state, terms, 1, left)
    assert variance == pytest.approx(0.3, rel=0.1)


@pytest.mark.parametrize("count", [1, 2, 7, 1000])
def test_the_median_is_that_of_sorted_sizes(count):
    values = np.random.default_rng(count).normal(0, 9, count).astype(np.float32)
    assert median_size(values) == np.sort(np.abs(values))[count // 2]
    values[:] = 0
    assert median_size(values) == 0


def test_what_is_eliminated_once_serves_every_right_side():
    rng = np.random.default_rng(8)
    rows, size = rng.normal(size=(2, 200, 18)), 6
    normal = np.tril(rows.transpose(0, 2, 1) @ rows)
    held, right = eliminated(normal, size), rng.normal(size=(2, 18))
    for c in range(2):
        inner, pull, shared, _ = without_brightness(normal[c], right[c], size, 1e-9)
        np.testing.assert_allclose(held.inner[c], inner)
        np.testing.assert_allclose(held.shared[c], shared)
        asked = right[c, :size] - held.shared[c].T @ right[c, size:]
        np.testing.assert_allclose(asked, pull, atol=1e-9)
