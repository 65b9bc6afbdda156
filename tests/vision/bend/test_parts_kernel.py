"""Shifts of parts eliminated from normal equations, against the whole system."""

import numpy as np
import pytest

from padstudio.vision.bend.parts_kernel import SHARED, part_sums, without_shifts


def test_eliminated_shifts_are_those_of_the_whole_system():
    rng = np.random.default_rng(2)
    count, parts, expected = 90, 5, 3.0
    rows, row_time = rng.normal(size=(count, 7)), rng.uniform(-0.5, 0.5, count)
    trust, part = rng.uniform(0.5, 2.0, count), rng.integers(0, parts, count)
    place, weight = rng.normal(size=(parts, 2)), rng.uniform(0.2, 1.0, parts)
    found = without_shifts(part_sums(rows, row_time, place, trust, part, parts), weight, expected)

    pose, moves = rows[:, 1:], -rows[:, 1:3]
    x, y = place[part].T
    stretched = [x * moves[:, 0], y * moves[:, 1], y * moves[:, 0] + x * moves[:, 1]]
    shared = np.hstack([pose, row_time[:, None] * pose, np.stack(stretched, axis=1)])
    own = np.zeros((count, parts, 2))
    own[np.arange(count), part] = moves
    own = own.reshape(count, -1)
    scaled = (trust * weight[part])[:, None]
    inner = own.T @ (scaled * own) + expected * np.eye(2 * parts)
    across = shared.T @ (scaled * own)
    right = scaled[:, 0] * rows[:, 0]
    assert shared.shape[1] == SHARED
    np.testing.assert_allclose(
        found[0], shared.T @ (scaled * shared) - across @ np.linalg.solve(inner, across.T)
    )
    np.testing.assert_allclose(
        found[1], shared.T @ right - across @ np.linalg.solve(inner, own.T @ right), atol=1e-9
    )
    likely = right @ own @ np.linalg.solve(inner, own.T @ right)
    likely -= np.linalg.slogdet(inner / expected)[1]
    assert found[2] == pytest.approx(likely)
