"""Covariances that are true where residuals are not as they should be."""

import numpy as np
import pytest

from padstudio.vision.pose.covariance import (
    TILES,
    pose_covariance,
    tiles_of,
    with_picture_shift,
)

COUNT = 4000


def sums_by_tile(rows, tile):
    out = np.zeros((TILES * TILES, rows.shape[1]))
    np.add.at(out, tile, rows)
    return out


def estimates(noise_of, draws=400, size=4):
    """Errors of least squares and the covariances said of them, for a kind of noise."""
    rng = np.random.default_rng(12)
    xy = rng.uniform(0, 640, (COUNT, 2))
    jacobian = rng.normal(size=(COUNT, size)) + (xy[:, :1] / 320 - 1)
    tile = tiles_of(xy)
    normal = jacobian.T @ jacobian
    errors, said = [], []
    for _ in range(draws):
        noise = noise_of(rng, tile)
        error = np.linalg.solve(normal, jacobian.T @ noise)
        left = noise - jacobian @ error
        variance = float((left**2).mean())
        scores = sums_by_tile(jacobian * (left / variance)[:, None], tile)
        said.append(pose_covariance(normal / variance, scores, np.zeros((size, 0))))
        errors.append(error)
    return np.array(errors), np.array(said)


def nees(errors, covariances):
    return np.mean(
        [e @ np.linalg.solve(p, e) / len(e) for e, p in zip(errors, covariances, strict=True)]
    )


def test_independent_residuals():
    assert nees(*estimates(lambda rng, tile: rng.normal(0, 0.3, COUNT))) == pytest.approx(
        1, abs=0.2
    )


def test_residuals_that_neighbours_share():
    def noise(rng, tile):
        return rng.normal(0, 0.3, COUNT) + rng.normal(0, 0.2, TILES * TILES)[tile]

    errors, said = estimates(noise)
    assert nees(errors, said) == pytest.approx(1, abs=0.35)
    independent = np.cov(errors.T).trace() / np.mean([np.trace(p) for p in said])
    assert independent == pytest.approx(1, abs=0.35)


def test_what_is_not_measured_enters_along_its_own_direction():
    normal = np.diag([4.0, 1.0])
    pull = np.array([[0.0], [1.0]]) * 3.0
    scores = np.zeros((64, 2))
    found = pose_covariance(normal, scores, pull)
    assert found[1, 1] == pytest.approx(9.0)
    assert found[0, 0] == pytest.approx(0.5 / 4)


def test_units_do_not_matter():
    rng = np.random.default_rng(3)
    a = rng.normal(size=(30, 3))
    normal, scores, pull = a.T @ a, rng.normal(size=(64, 3)), rng.normal(size=(3, 2))
    units = np.array([1.0, 1e4, 1e-5])
    found = pose_covariance(normal, scores, pull)
    scaled = pose_covariance(normal / np.outer(units, units), scores / units, pull / units[:, None])
    np.testing.assert_allclose(scaled, found * np.outer(units, units), rtol=1e-6)


def test_tiles_cover_the_points():
    xy = np.random.default_rng(1).uniform(-50, 900, (5000, 2))
    tile = tiles_of(xy)
    assert set(tile) == set(range(TILES * TILES))
    assert set(tiles_of(np.ones((4, 2)))) == {0}


def test_a_shift_of_the_picture_is_a_turn_of_the_camera():
    found = with_picture_shift(np.eye(6) * 1e-12, 1000.0)
    assert np.sqrt(found[3, 3]) * 1000 == pytest.approx(np.sqrt(found[4, 4]) * 1000)
    assert 0.01 < np.sqrt(found[3, 3]) * 1000 < 0.1
    np.testing.assert_array_equal(np.diag(found)[[0, 1, 2, 5]], 1e-12)
