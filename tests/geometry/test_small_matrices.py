"""Compiled steps on small matrices against NumPy's and OpenCV's."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from padstudio.geometry.small_matrices import least_axis, rotation_vector

SEEDS = st.integers(0, 2**32 - 1)


@given(SEEDS, st.integers(1, 9), st.integers(-12, 12))
def test_the_least_axis_is_that_of_the_least_eigenvalue(seed: int, size: int, power: int) -> None:
    rows = np.random.default_rng(seed).normal(size=(size + 2, size)) * 10.0**power
    matrix = rows.T @ rows
    axis = least_axis(matrix)
    values = np.linalg.eigvalsh(matrix)
    assert np.linalg.norm(axis) == pytest.approx(1)
    assert axis @ matrix @ axis == pytest.approx(values[0], abs=1e-12 * values[-1])


def test_equal_eigenvalues_have_an_axis_too() -> None:
    for matrix in (np.eye(4), np.zeros((3, 3))):
        assert np.linalg.norm(least_axis(matrix)) == pytest.approx(1)


@given(SEEDS, st.floats(0, 3.1))
def test_a_rotation_vector_is_rodrigues(seed: int, angle: float) -> None:
    axis = np.random.default_rng(seed).normal(size=3)
    vector = angle * axis / np.linalg.norm(axis)
    rotation = np.asarray(cv2.Rodrigues(vector)[0], float)
    assert rotation_vector(rotation) == pytest.approx(vector, abs=1e-7)
