from __future__ import annotations

import numpy as np
import pytest
from measure_print import make_pad

from padstudio.errors import SpecError
from padstudio.pad.layout import corners_mm
from padstudio.pad.print_scale import print_scale, with_measured_size


def test_poses_rest_on_the_measured_size() -> None:
    pad = make_pad()
    measured = with_measured_size(pad, ruler_mm=200, x_mm=199, y_mm=201)
    assert measured.scale == (0.995, 1.005)
    nominal, real = corners_mm(pad, "red"), corners_mm(measured, "red")
    np.testing.assert_allclose(real, nominal * [0.995, 1.005, 1])


@pytest.mark.parametrize(
    ("ruler_mm", "read_mm"),
    [(0, 200), (-200, 200), (float("nan"), 200), (200, 20), (200, 2000), (200, float("nan"))],
)
def test_impossible_readings_are_refused(ruler_mm: float, read_mm: float) -> None:
    with pytest.raises(SpecError, match="ruler"):
        print_scale(ruler_mm, read_mm)
