"""Loops over pieces of lines, held to plain NumPy."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from padstudio.vision.baseline.hough import homogeneous
from padstudio.vision.baseline.lines_kernel import join, merge, pointed_at, sharpen, uncrossed
from padstudio.vision.baseline.vanishing_points import aligned

NEAR = 2.5


def pieces_of(rng, count):
    """Short pieces along a few lines, each a little beside its line, and some anywhere."""
    middle = rng.uniform(0, 600, (6, 2))
    angle = rng.uniform(0, math.pi, 6)
    which = rng.integers(0, 6, count)
    along = np.stack([np.cos(angle), np.sin(angle)], axis=1)[which]
    start = (
        middle[which] + along * rng.uniform(-200, 200, (count, 1)) + rng.normal(0, 0.5, (count, 2))
    )
    return np.stack([start, start + along * rng.uniform(10, 60, (count, 1))], axis=1)


def line_through(points):
    middle = points.mean(axis=0)
    normal = np.linalg.svd(points - middle)[2][1]
    return np.append(normal, -normal @ middle)


@given(st.integers(0, 10_000), st.integers(1, 60))
def test_groups_are_of_pieces_on_one_line_and_numbered_in_order(seed, count):
    rng = np.random.default_rng(seed)
    pieces, order = pieces_of(rng, count), rng.permutation(count)
    group = merge(pieces, order, NEAR)
    assert group.min() == 0
    first = [order[np.isin(order, np.flatnonzero(group == g))][0] for g in range(group.max() + 1)]
    assert sorted(range(len(first)), key=lambda g: np.flatnonzero(order == first[g])[0]) == list(
        range(len(first))
    )
    for number, head in enumerate(first):
        members = pieces[group == number]
        assert (group[first[:number]] != number).all()
        # All are beside the first piece, or beside the line through those that are.
        own = line_through(pieces[head])
        beside = (np.abs(members @ own[:2] + own[2]) < NEAR + 1e-9).all(axis=1)
        joint = line_through(members[beside].reshape(-1, 2)) if beside.any() else own
        near = (np.abs(members @ joint[:2] + joint[2]) < NEAR + 1e-6).all(axis=1)
        assert (beside | near).all()


@given(st.integers(0, 10_000), st.integers(1, 40))
def test_a_joined_line_reaches_over_its_pieces_and_covers_each_length_once(seed, count):
    rng = np.random.default_rng(seed)
    pieces = pieces_of(rng, count)
    group = merge(pieces, np.arange(count), NEAR)
    ends, support = join(pieces, group)
    for number in range(len(ends)):
        members = pieces[group == number]
        line = line_through(members.reshape(-1, 2))
        along = np.array([-line[1], line[0]])
        spans = np.sort(members @ along, axis=1)
        np.testing.assert_allclose(ends[number] @ line[:2] + line[2], 0, atol=1e-6)
        reached = np.sort(ends[number] @ along)
        np.testing.assert_allclose(reached, [spans.min(), spans.max()], atol=1e-6)
        fine = np.linspace(spans.min(), spans.max(), 4001)
        covered = ((fine[:, None] >= spans[:, 0]) & (fine[:, None] <= spans[:, 1])).any(axis=1)
        assert support[number] == pytest.approx(
            covered.mean() * np.ptp(fine), abs=0.2 + np.ptp(fine) / 500
        )


@given(st.integers(0, 10_000), st.floats(0, math.pi))
def test_a_line_is_fitted_to_the_points_beside_it(seed, angle):
    rng = np.random.default_rng(seed)
    along, normal = (
        np.array([math.cos(angle), math.sin(angle)]),
        np.array([-math.sin(angle), math.cos(angle)]),
    )
    points = along * rng.uniform(-100, 100, (300, 1)) + normal * rng.normal(0, 0.2, (300, 1))
    far = rng.uniform(-300, 300, (200, 2))
    far = far[np.abs(far @ normal) > 8]
    start = np.array([[-100 * along + 0.8 * normal, 100 * along + 0.8 * normal]])
    sharp = sharpen(start, np.concatenate([points, far]), NEAR)
    assert np.abs(sharp[0] @ normal).max() < 0.2
    np.testing.assert_allclose(np.abs(sharp[0] @ along), 100, atol=0.1)
    # Too few points leave a line as it was.
    np.testing.assert_allclose(sharpen(start, points[:4], NEAR), start, atol=1e-9)


@given(st.integers(0, 10_000))
def test_weight_pointed_at_a_point_is_that_of_aligned_lines(seed):
    rng = np.random.default_rng(seed)
    ends, weight = rng.normal(0, 1, (40, 2, 2)), rng.uniform(0, 1, 40)
    points = rng.normal(0, 1, (10, 3))
    expected = [weight[aligned(point, ends)].sum() for point in points]
    found = pointed_at(points, ends, weight, float(np.radians(1.5)))
    np.testing.assert_allclose(found, expected, atol=1e-12)


@given(st.integers(0, 10_000), st.integers(0, 40))
def test_lines_that_cross_better_ones_within_their_length_are_dropped(seed, count):
    rng = np.random.default_rng(seed)
    ends, family = rng.normal(0, 1, (count, 2, 2)), rng.uniform(0, 1, count) < 0.7
    # Some are supported alike.
    support = -np.sort(-rng.integers(1, 20, count).astype(float))
    lines, expected = homogeneous(ends), family.copy()
    for k in np.flatnonzero(family)[::-1]:
        others = np.flatnonzero(expected & (support > support[k]))
        sides = lines[others] @ np.column_stack([ends[k], np.ones(2)]).T
        across = np.concatenate([ends[others], np.ones((len(others), 2, 1))], axis=2) @ lines[k]
        expected[k] = not ((sides.prod(axis=1) < 0) & (across.prod(axis=1) < 0)).any()
    np.testing.assert_array_equal(uncrossed(ends, family, support), expected)
