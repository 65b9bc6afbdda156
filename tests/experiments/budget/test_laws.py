"""A budget's amounts follow the laws of optics, whatever the sizes that are set."""

import numpy as np
import pytest
from small_budget import NOTHING, read_here, small_camera, small_order

from padstudio.experiments.budget.amounts import MEASURES, Sample, alone, beside, over
from padstudio.experiments.budget.draws import draw
from padstudio.experiments.budget.order import floor_case, source_case


def measured(order, source):
    """Readings of the floor and of a source, frame by frame."""
    cases = [floor_case(order.conditions), source_case(order.conditions, source)]
    floor, readings = read_here(order, cases)
    assert {each.state for each in (*floor, *readings)} == {"full"}
    return floor, readings


def roots(order, excess):
    amounts = Sample(order.frames, order.seed).amounts(Sample(order.frames, 1).means(excess))
    return dict(zip(MEASURES, amounts, strict=True))


def test_an_error_of_the_print_scale_is_that_share_of_the_distance():
    order = small_order(scale_percent=0.5)
    floor, readings = measured(order, "print_scale")
    distances = [
        np.linalg.norm(draw(order, order.conditions, k).pose.position_mm) for k in range(8)
    ]
    found = roots(order, beside(readings, floor))
    assert found["position"].value == pytest.approx(
        0.005 * np.sqrt(np.mean(np.square(distances))), rel=0.02
    )
    assert found["height"].value == pytest.approx(0.005 * 450, rel=0.02)
    # A larger print looks nearer: half of the frames each.
    heights = [
        each.error_mm[2] - below.error_mm[2] for each, below in zip(readings, floor, strict=True)
    ]
    assert sorted(np.sign(heights)) == [-1] * 4 + [1] * 4
    # Attitudes do not depend on size.
    assert found["attitude"].value < 0.01


def test_an_error_of_the_focal_length_is_that_share_of_the_height():
    order = small_order(focal_percent=0.5)
    floor, readings = measured(order, "calibration")
    found = roots(order, beside(readings, floor))
    assert found["height"].value == pytest.approx(0.005 * 450, rel=0.03)


def test_the_floor_falls_with_more_pixels():
    coarse, fine = (
        roots(order, alone(read_here(order, [floor_case(order.conditions)])[0]))
        for order in (small_order(900, 16), small_order(900, 16, small_camera(2.0)))
    )
    assert fine["position"].value < 0.6 * coarse["position"].value


@pytest.mark.parametrize(
    "source", ["blur", "rolling_shutter", "print_scale", "flatness", "calibration", "compression"]
)
def test_a_source_of_no_size_adds_nothing(source):
    order = small_order(frames=4, **NOTHING)
    floor, readings = measured(order, source)
    assert readings == floor
    assert not roots(order, over(readings, floor))["position"].is_resolved


def test_a_rolling_shutter_adds_what_its_rows_shear():
    """An unknown motion that shakes within the readout is no turn of the camera alone."""
    order = small_order(frames=4, readout_ms=20.0, vibration_deg=0.3)
    floor, readings = measured(order, "rolling_shutter")
    found = roots(order, over(readings, floor))
    assert found["position"].value > 3 * roots(order, alone(floor))["position"].value


def test_less_bit_rate_is_more_error():
    errors = []
    for mbit_s in (0.06, 2.0):
        order = small_order(frames=4, mbit_s=mbit_s)
        [readings] = read_here(order, [source_case(order.conditions, "compression")])
        assert all(each.mbit_s <= mbit_s for each in readings)
        errors.append(roots(order, alone(readings))["position"].value)
    assert errors[0] > errors[1]
