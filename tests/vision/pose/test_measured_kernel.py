"""Sums over measured borders against their plain forms."""

import numpy as np

from padstudio.geometry.small_matrices import inverse_trace
from padstudio.vision.pose.drift_kernel import Priors, Rows, drifting, mixture, unrest
from padstudio.vision.pose.edge_points import Sway
from padstudio.vision.pose.measured_kernel import Measured, blur_variance, explained_by
from padstudio.vision.pose.row_motion_kernel import row_sums


def borders(n=300):
    rng = np.random.default_rng(5)
    rows, sides = rng.normal(size=(n, 7)), rng.normal(size=(n, 2))
    time = rng.uniform(-0.4, 0.4, n)
    tile, weight = rng.integers(0, 64, n), rng.uniform(0.2, 1, n)
    return Measured(rows, sides, time, weight, tile, -0.4, 0.1, 8), rng


def test_what_steps_explain_is_linear_in_them():
    measured, rng = borders()
    static, drift, sway = rng.normal(size=8), rng.normal(size=6), rng.normal(size=(9, 3))
    change, time = measured.rows[:, 1:], measured.row_time
    knots = measured.first + measured.width * np.arange(9)
    plain = change @ static[:6] + measured.sides @ static[6:] + time * (change @ drift)
    plain += (change[:, 3:] * Sway(knots, sway).at(time)).sum(axis=1)
    np.testing.assert_allclose(explained_by(measured, static, drift, sway), plain, atol=1e-10)


def summed(measured):
    trust = np.ones(len(measured.rows))
    time = measured.row_time
    sums = row_sums(measured.rows, measured.sides, time, trust, -0.4, 0.1, 8)
    return Rows(sums, -0.4, 0.1)


def test_a_drift_of_one_size_is_that_of_least_squares():
    measured, rng = borders()
    sigma, away = rng.uniform(0.5, 2, (1, 6)), rng.normal(size=6)
    found = drifting(summed(measured), away, Priors(0.7, sigma, np.zeros(1)))
    change, time = measured.rows[:, 1:], measured.row_time
    jacobian = np.hstack([change, measured.sides, change * time[:, None]])
    prior = np.r_[np.zeros(6), np.full(2, 0.7**-2), sigma[0] ** -2]
    normal = jacobian.T @ jacobian + np.diag(prior)
    left = measured.rows[:, 0] + time * (change @ away)
    mean = np.linalg.solve(normal, jacobian.T @ left)
    np.testing.assert_allclose(found.mean[0], mean, atol=1e-8)
    np.testing.assert_allclose(found.mixed.mean, mean, atol=1e-8)
    inverse = np.linalg.inv(normal)[:6, :6]
    np.testing.assert_allclose(found.mixed.covariance, inverse, atol=1e-8)


def test_unrest_is_what_intervals_still_ask_for():
    measured, rng = borders(3000)
    quiet = measured._replace(rows=measured.rows.copy())
    best, away = np.zeros(14), rng.normal(size=6)
    best[8:] = away
    # Residuals that are as large as independent ones are asked for nothing but by chance.
    assert 0.3 < unrest(summed(quiet), best, away, np.zeros((0, 3))) < 2.5
    sway = rng.normal(0, 1, (9, 3))
    quiet.rows[:, 0] += explained_by(measured, np.zeros(8), np.zeros(6), sway)
    assert unrest(summed(quiet), best, away, np.zeros((0, 3))) > 20
    assert 0.3 < unrest(summed(quiet), best, away, sway) < 2.5


def test_a_mixture_has_the_moments_of_its_parts():
    rng = np.random.default_rng(2)
    log_weight, mean = rng.normal(size=3), rng.normal(size=(3, 9))
    covariance = np.stack([np.diag(rng.uniform(1, 2, 6)) for _ in range(3)])
    weight = np.exp(log_weight) / np.exp(log_weight).sum()
    found = mixture(log_weight, mean, covariance)
    whole = weight @ mean
    away = (mean - whole)[:, :6]
    spread = np.tensordot(weight, covariance, 1) + (away * weight[:, None]).T @ away
    np.testing.assert_allclose(found.mean, whole)
    np.testing.assert_allclose(found.covariance, spread)


def test_blur_tells_how_the_camera_turned():
    rng = np.random.default_rng(9)
    rows, weight = rng.normal(0, 1000.0, (400, 7)), rng.uniform(0.2, 1, 400)
    turns = np.array([4e-7, 3e-7])
    blur = 3.0 * rows[:, 4:6] ** 2 @ turns + 0.2
    found = blur_variance(rows, weight, blur)
    np.testing.assert_allclose(found[:2], turns, rtol=0.1)
    assert found[2] == found[:2].mean()
    assert not blur_variance(rows, weight, np.zeros(400)).any()


def test_the_trace_of_an_inverse_bears_units_that_differ_widely():
    rng = np.random.default_rng(1)
    a, b = rng.normal(size=(2, 30, 6))
    units = np.array([1.0, 1e5, 1e-5, 1e2, 1.0, 1e-3])
    matrix, other = a.T @ a, b.T @ b
    trace = np.trace(np.linalg.solve(matrix, other))
    scaled = inverse_trace(matrix * np.outer(units, units), other * np.outer(units, units))
    np.testing.assert_allclose(scaled, trace)
