"""Points beside a piece of line, by tile, against a look at all of them."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from padstudio.vision.baseline.tiles_kernel import beside, tiled


def within(points, ends, near):
    """Numbers of the points within a distance of a piece's line and of its ends along it."""
    along = ends[1] - ends[0]
    length = np.linalg.norm(along)
    along = along / length
    off = points - ends[0]
    place, away = off @ along, off @ [-along[1], along[0]]
    with np.errstate(invalid="ignore"):
        held = (np.abs(away) <= near) & (place >= 0) & (place <= length)
    return set(np.flatnonzero(held).tolist())


def listed(points, ends, near, *, others=()):
    found = np.empty(len(points), np.intp)
    pieces = np.array([ends, *others])
    count = beside(tiled(points, pieces, near), ends, near, found)
    return found[:count].tolist()


@given(st.integers(0, 10_000), st.floats(0.5, 8.0), st.sampled_from([1, 10, 1e9]))
def test_all_points_beside_a_piece_are_found_once(seed, near, spread):
    rng = np.random.default_rng(seed)
    points = rng.uniform((-80, -20), (500, 300), (400, 2))
    ends = rng.uniform((-150, -150), (600, 450), (2, 2))
    found = listed(points, ends, near, others=spread * rng.uniform(-500, 500, (3, 2, 2)))
    assert len(found) == len(set(found))
    assert within(points, ends, near) <= set(found)


def test_points_far_from_a_piece_are_not_looked_at():
    rng = np.random.default_rng(3)
    points = rng.uniform(0, 700, (20_000, 2))
    found = listed(points, np.array([[10.0, 300.0], [690.0, 320.0]]), 2.5)
    assert len(found) < 0.1 * len(points)


@given(st.integers(0, 1000))
def test_points_that_are_not_finite_are_in_no_tile(seed):
    rng = np.random.default_rng(seed)
    points = rng.uniform(0, 100, (50, 2))
    lost = rng.integers(0, 50, 10)
    points[lost, rng.integers(0, 2, 10)] = rng.choice([np.nan, np.inf, -np.inf], 10)
    found = listed(points, np.array([[0.0, 0.0], [100.0, 100.0]]), 200.0)
    assert sorted(found) == np.flatnonzero(np.isfinite(points).all(axis=1)).tolist()


def test_points_thrown_far_by_a_lens_take_no_memory():
    points = np.concatenate([np.full((10, 2), 1e12), np.full((10, 2), -1e12), np.eye(2) * 50])
    assert sorted(listed(points, np.array([[0.0, 0.0], [60.0, 60.0]]), 60.0)) == [20, 21]


def test_no_points_and_a_piece_without_length_are_no_fault():
    assert listed(np.empty((0, 2)), np.array([[0.0, 0.0], [9.0, 9.0]]), 2.0) == []
    assert listed(np.full((3, 2), np.nan), np.array([[0.0, 0.0], [9.0, 9.0]]), 2.0) == []
    assert listed(np.array([[5.0, 5.0]]), np.array([[5.0, 5.0], [5.0, 5.0]]), 2.0) == [0]
