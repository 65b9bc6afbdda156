"""The compiled match against plain forms and numerical derivatives."""

import math

import numpy as np
import pytest
from dense_frames import random_pose, seen_by

from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.vision.pose.pattern import (
    alignment_kernel,
    block_kernel,
    elimination_kernel,
    template_kernel,
)
from padstudio.vision.pose.pattern.block_kernel import Brightness, Pixels, Texture


def moving_pose(seed):
    rng = np.random.default_rng(seed)
    pose = random_pose(rng, 2000.0)
    return MovingPose(pose, rng.normal(0, 3, 3), rng.normal(0, 1e-3, 3)), rng


def meet(pose, ray, s):
    """Where a ray meets the pad, and how that moves with the pose (2, 6)."""
    block = block_kernel.room(6, 1)
    pixels = Pixels(
        ray[:, None].copy(),
        np.array([s]),
        np.ones((6, 1)),
        np.zeros(1, int),
        np.zeros((1, 1), np.float32),
    )
    block_kernel.meet_pad(block, pixels, (0, 1), pose.state)
    at = block.at[:, 0].copy()
    moves = []
    for slopes in ([1.0, 0.0], [0.0, 1.0]):
        block.rows[:], block.slopes[:, 0] = 1.0, slopes
        known = np.array([0.0] * 6 + [1.0, 0.0, 0.0])
        alignment_kernel.pose_jacobian(block, known, pixels, (0, 1), pose.state.rotation)
        moves.append(block.rows[:6, 0].copy())
    return at, np.array(moves)


@pytest.mark.parametrize("seed", range(5))
def test_points_on_the_pad_move_with_the_pose_as_said(seed):
    pose, rng = moving_pose(seed)
    ray, s = np.array([*rng.uniform(-0.2, 0.2, 2), 1.0]), rng.uniform(-0.5, 0.5)
    at, moves = meet(pose, ray, s)
    seen = seen_by(pose, np.array([[*at, 0.0]]), s)[0]
    np.testing.assert_allclose(seen[:2] / seen[2], ray[:2], atol=2e-5)
    for k, size in enumerate([1e-2] * 3 + [1e-5] * 3):
        step = np.zeros(6)
        step[k] = size
        # A turn within the frame is small, so that the kernel leaves out its product with a turn.
        after, before = (meet(pose.moved(sign * step), ray, s)[0] for sign in (1, -1))
        there = (after - before) / (2 * size)
        np.testing.assert_allclose(moves[:, k], there, atol=2e-2 * np.abs(there).max() + 1e-6)


def test_blurred_cells_are_cells_through_a_gaussian():
    rng = np.random.default_rng(2)
    cells = rng.integers(0, 2, (12, 3)).astype(np.float32)
    fine = np.repeat(cells, 700, axis=0)
    found = np.zeros((84, 3), np.float32)
    template_kernel.blurred_cells(cells, 7.0, 1.6, found)
    at = (np.arange(len(fine)) + 0.5) / 100
    for y in (10, 30, 41, 70):
        weight = np.exp(-((at - y - 0.5) ** 2) / (2 * 1.6**2)) / (1.6 * math.sqrt(2 * math.pi))
        np.testing.assert_allclose(found[y], weight @ fine / 100, atol=2e-4)


def equations(pose, shift_brightness, size, scale=0.0, seed=0, tiles=4):
    rng = np.random.default_rng(seed)
    n = 60
    rays = np.column_stack([rng.uniform(-0.1, 0.1, (n, 2)), np.ones(n)])
    x, y = np.meshgrid(np.linspace(0, 6, 90), np.linspace(0, 5, 90))
    layers = np.stack([np.sin(x) * np.cos(y), np.cos(1.3 * x + y)]).astype(np.float32)
    known = rng.normal(0, 20, (2, 12))
    known[0] += shift_brightness
    pixels = Pixels(
        rays.T.copy(),
        rng.uniform(-0.5, 0.5, n),
        np.column_stack([np.ones(n), rng.uniform(-1, 1, (n, 5))]).T.copy(),
        rng.integers(0, 4, n) % max(tiles, 1),
        rng.uniform(0, 255, (2, n)).astype(np.float32),
    )
    texture = Texture(layers, np.array([45.0, 0.05, 45.0, -0.05]))
    brightness = Brightness(known, np.full(2, scale))
    return alignment_kernel.match_pattern(pixels, texture, pose.state, brightness, size, tiles)


@pytest.mark.parametrize("size", [6, 12])
def test_the_right_side_is_the_squares_change_with_brightness(size):
    pose, _ = moving_pose(4)
    right = equations(pose, np.zeros(12), size)[1].sum(axis=1)
    # The sum is a parabola of each, so that large steps are exact.
    for k in range(12):
        step = np.zeros(12)
        step[k] = 10.0
        after, before = (equations(pose, sign * step, size)[2][0, 0] for sign in (1, -1))
        change = (after - before) / 20.0
        assert -2 * right[0, size + k] == pytest.approx(change, rel=1e-3, abs=1e-2)


def test_the_right_side_is_about_the_squares_change_with_the_pose():
    pose, _ = moving_pose(6)
    right = equations(pose, np.zeros(12), 12)[1].sum(axis=(0, 1))
    sizes = [0.5] * 3 + [3e-4] * 3 + [0.5] * 3 + [3e-4] * 3
    there = []
    for k, size in enumerate(sizes):
        step = np.zeros(12)
        step[k] = size
        after, before = (
            equations(pose.moved(sign * step), np.zeros(12), 12)[2][:, 0].sum() for sign in (1, -1)
        )
        there.append((after - before) / (2 * size))
    scaled = np.array(sizes) * np.array(there)
    np.testing.assert_allclose(-2 * right[:12] * sizes, scaled, atol=0.05 * np.abs(scaled).max())


def test_residuals_that_stand_out_are_trusted_little():
    pose, _ = moving_pose(5)
    _, _, alike, residuals = equations(pose, np.zeros(12), 0)
    _, _, trusted, same = equations(pose, np.zeros(12), 0, scale=20.0)
    np.testing.assert_array_equal(residuals, same)
    weight = 1 / (1 + (residuals.astype(float) / 20.0) ** 2) ** 2
    np.testing.assert_allclose(alike[:, 1], 60)
    np.testing.assert_allclose(trusted[:, 1], weight.sum(axis=1), rtol=1e-5)
    steep = weight * (4 * np.sqrt(weight) - 3)
    np.testing.assert_allclose(trusted[:, 2], steep.sum(axis=1), rtol=1e-4, atol=1e-4)


def test_one_tile_is_the_sum_of_all():
    pose, _ = moving_pose(7)
    apart, together = (equations(pose, np.zeros(12), 12, scale=30.0, tiles=n) for n in (4, 1))
    assert together.right.shape == (2, 1, 24)
    largest = np.abs(apart.right).sum(axis=1)
    np.testing.assert_array_less(
        np.abs(apart.right.sum(axis=1) - together.right[:, 0]), 1e-12 * largest
    )
    np.testing.assert_allclose(apart.normal, together.normal)
    alone = equations(pose, np.zeros(12), 12, scale=30.0, tiles=0)
    np.testing.assert_array_equal(alone.right, together.right)
    assert not alone.normal.any()


@pytest.mark.parametrize("size", [0, 6, 12])
def test_without_brightness_the_pose_has_the_same_solution(size):
    rng = np.random.default_rng(size)
    rows = rng.normal(size=(200, size + 5))
    rows[:, -1] = 0.0  # a term of which the picture says nothing
    normal, right = rows.T @ rows, rows.T @ rng.normal(size=200)
    inner, pull, shared, change = elimination_kernel.without_brightness(
        np.tril(normal), right, size, 1e-9
    )
    whole = np.linalg.lstsq(normal, right, rcond=None)[0]
    pose = np.linalg.solve(inner, pull) if size else np.empty(0)
    np.testing.assert_allclose(pose, whole[:size], atol=1e-7)
    np.testing.assert_allclose(change - shared @ pose, whole[size:], atol=1e-7)
