"""Noise and covariances that are true where residuals are not as they should be."""

import numpy as np
import pytest

from padstudio.vision.pose.covariance import with_picture_shift
from padstudio.vision.pose.noise_kernel import TILES, newton_share, noise_share, tiles_of

COUNT = 4000


def sums_by_tile(rows, tile):
    out = np.zeros((TILES * TILES, rows.shape[1]))
    np.add.at(out, tile, rows)
    return out


def said_and_true(noise_of, most_alike=np.inf, draws=200):
    """Mean of the noise that residuals are said to have, over that of least squares' errors."""
    rng = np.random.default_rng(12)
    xy = rng.uniform(0, 640, (COUNT, 2))
    jacobian = rng.normal(size=(COUNT, 6)) + (xy[:, :1] / 320 - 1)
    tile, normal = tiles_of(xy), jacobian.T @ jacobian
    said, true = [], []
    for _ in range(draws):
        noise = noise_of(rng, tile)
        error = np.linalg.solve(normal, jacobian.T @ noise)
        score = jacobian * (noise - jacobian @ error)[:, None]
        scores = sums_by_tile(score, tile)
        said.append(noise_share(normal, score.T @ score, scores, COUNT, most_alike))
        true.append(error @ normal @ error / 6)
    return np.mean(said), np.mean(true)


def test_independent_residuals():
    said, true = said_and_true(lambda rng, tile: rng.normal(0, 1.5, COUNT))
    assert said == pytest.approx(true, rel=0.2)


def shared(rng, tile):
    """Noise that neighbours share."""
    return rng.normal(0, 1.5, COUNT) + rng.normal(0, 1.0, TILES * TILES)[tile]


def test_residuals_that_neighbours_share():
    said, true = said_and_true(shared)
    assert said == pytest.approx(true, rel=0.35)
    assert said_and_true(shared, most_alike=1.3)[0] < said


def test_units_do_not_matter():
    rng = np.random.default_rng(3)
    a = rng.normal(size=(30, 6))
    normal, scores = a.T @ a, rng.normal(size=(64, 6))
    units = np.array([1.0, 1e4, 1e-5, 1e3, 1.0, 1e-2])
    found = noise_share(normal, normal, scores, 30, np.inf)
    scaled = normal / np.outer(units, units)
    assert noise_share(scaled, scaled, scores / units, 30, np.inf) == pytest.approx(found)


def test_weights_that_fall_make_less_sure():
    x = np.random.default_rng(4).normal(0, 0.3, 500)
    weight, trust = 1 / (1 + x**2) ** 2, np.ones(500)
    steep = ((1 - 3 * x**2) / (1 + x**2) ** 3).sum() / weight.sum()
    assert newton_share(weight, trust) == pytest.approx(steep, rel=1e-6)
    assert newton_share(np.full(10, 1e-3), np.ones(10)) == pytest.approx(0.3)


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
