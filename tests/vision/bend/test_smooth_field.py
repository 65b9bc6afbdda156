"""A smooth height field on cosines, and the evidence for one."""

import numpy as np
import pytest

from padstudio.vision.bend.smooth_field import Cosines, find_evidence, solve

BOX = np.array([[-300.0, -200.0], [300.0, 200.0]])


def test_the_cosines_have_the_covariance_that_they_stand_for():
    cosines = Cosines.over(BOX, 150.0)
    xy = np.array([[0.0, 0.0], [150.0, 0.0], [0.0, 150.0], [-100.0, -90.0]])
    at = cosines.at(xy)
    covariance = at * cosines.variance @ at.T
    distance = np.linalg.norm(xy[:, None] - xy[None], axis=-1)
    assert covariance == pytest.approx(np.exp(-(distance**2) / (2 * 150.0**2)), abs=0.08)


@pytest.mark.parametrize("axis", [0, 1])
def test_slopes_are_those_of_differences(axis):
    cosines = Cosines.over(BOX, 200.0)
    xy = np.array([[10.0, -40.0], [-250.0, 120.0]])
    step = np.eye(2)[axis] * 0.01
    differences = (cosines.at(xy + step) - cosines.at(xy - step)) / 0.02
    assert cosines.at(xy, axis) == pytest.approx(differences, abs=1e-9)


def equations(amplitude_mm, noise, seed=1):
    """Normal equations of heights seen straight, with six columns that a pose might have."""
    rng = np.random.default_rng(seed)
    xy = rng.uniform(*BOX, (500, 2))
    cosines = Cosines.over(BOX, 150.0)
    coefficients = amplitude_mm * np.sqrt(cosines.variance) * rng.normal(size=len(cosines.modes))
    columns = np.hstack([np.ones((500, 1)), xy, rng.normal(size=(500, 3)), cosines.at(xy)])
    seen = columns[:, 6:] @ coefficients + noise * rng.normal(size=500)
    return columns.T @ columns / noise**2, columns.T @ seen / noise**2, cosines


def test_the_evidence_finds_how_high_bends_are():
    normal, right, cosines = equations(4.0, 0.3)
    evidence = find_evidence(normal, right, cosines.variance)
    assert evidence.log_odds > 100
    assert evidence.amplitude_mm == pytest.approx(4.0, rel=0.5)


def test_there_is_no_evidence_in_noise():
    odds = [find_evidence(*_of(equations(0.0, 0.3, seed))).log_odds for seed in range(20)]
    assert max(odds) < 5


def _of(parts):
    normal, right, cosines = parts
    return normal, right, cosines.variance


def test_a_system_of_unlike_units_is_solved():
    unit = np.array([1e-6, 1.0, 1e5])
    matrix = np.outer(unit, unit) * np.array([[2, 1, 0], [1, 3, 1], [0, 1, 2]])
    expected = np.array([3.0, -2.0, 5.0]) / unit
    assert solve(matrix, matrix @ expected) == pytest.approx(expected, rel=1e-12)
