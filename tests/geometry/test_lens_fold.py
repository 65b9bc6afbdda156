import numpy as np
import pytest

from padstudio.geometry.camera import Camera
from padstudio.geometry.lens_fold import fold_note, folded_share

K = np.array([[1000.0, 0, 959.5], [0, 1000.0, 539.5], [0, 0, 1]])


def camera(model, *coefficients):
    return Camera(1920, 1080, K, coefficients, model)


@pytest.mark.parametrize("k1", [-0.1, -0.3, -0.6])
def test_one_coefficient_turns_back_where_its_slope_is_zero(k1):
    # r (1 + k1 r^2) is greatest at r = (-3 k1)^-1/2, where it is two thirds of that.
    reach = 2 / 3 / np.sqrt(-3 * k1)
    across, down = np.meshgrid(np.linspace(-0.96, 0.96, 400), np.linspace(-0.54, 0.54, 400))
    beyond = float(np.mean(np.hypot(across, down) > reach))
    assert folded_share(camera("radtan", k1, 0, 0, 0)) == pytest.approx(beyond, abs=0.04)


def test_a_fisheye_turns_back_where_its_slope_is_zero():
    k1 = -0.4
    reach = 2 / 3 / np.sqrt(-3 * k1)
    across, down = np.meshgrid(np.linspace(-0.96, 0.96, 400), np.linspace(-0.54, 0.54, 400))
    beyond = float(np.mean(np.hypot(across, down) > reach))
    assert folded_share(camera("fisheye", k1, 0, 0, 0)) == pytest.approx(beyond, abs=0.04)
    note = fold_note(camera("fisheye", k1, 0, 0, 0))
    assert note is not None
    assert "folds back within" in note


@pytest.mark.parametrize(
    "lens",
    [("radtan",), ("radtan", -0.05, 0.01, 0, 0), ("fisheye", 0, 0, 0, 0), ("radtan", 0.2, 0, 0, 0)],
)
def test_a_lens_that_is_one_to_one_has_no_note(lens):
    assert fold_note(camera(*lens)) is None
