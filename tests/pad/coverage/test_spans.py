"""Heights at which layers and the whole sign read, by geometry."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from padstudio.errors import SpecError
from padstudio.pad.coverage.dead_bands import dead_bands
from padstudio.pad.coverage.pinhole import View
from padstudio.pad.coverage.spans import (
    METHOD_LIMITS,
    ReadLimits,
    cells_needed,
    coverage,
    layer_span,
    sign_span,
)
from padstudio.pad.spec import Layer, Pad

PAPER_VIEW = View(width_px=2720, height_px=1530, focal_px=1886.0)
WINDOW = ReadLimits(cell_px=3.0)


def pad(fine_mm=10.0, ratio=5, cells=125):
    fine = np.zeros((cells, cells), np.uint8)
    coarse = np.zeros((cells // ratio, cells // ratio), np.uint8)
    return Pad((Layer("blue", fine_mm * ratio, coarse), Layer("red", fine_mm, fine)))


def test_spans_follow_similar_triangles():
    red, blue = coverage(pad(), PAPER_VIEW, WINDOW)
    assert (red.layer, blue.layer) == ("red", "blue")
    assert red.low_mm == pytest.approx(5 * 10 * 1886 / 1530)
    assert red.high_mm == pytest.approx(1886 * 10 / 3)
    assert blue.low_mm == pytest.approx(5 * red.low_mm)
    assert blue.high_mm == pytest.approx(5 * red.high_mm)


@given(tilt=st.floats(0, 80), low=st.floats(0, 80), cell=st.floats(0.5, 200), need=st.floats(2, 12))
def test_a_layer_reads_within_its_span_and_not_beyond(tilt, low, cell, need):
    limits = ReadLimits(cells_across=need, cell_px=2.5)
    layer = Layer("red", cell, np.zeros((40, 40), np.uint8))
    span = layer_span(Pad((layer,)), layer, PAPER_VIEW, limits, tilt)
    assert PAPER_VIEW.cells_across(cell, span.low_mm, tilt) == pytest.approx(need)
    assert PAPER_VIEW.cell_px(cell, span.high_mm, tilt) == pytest.approx(2.5)
    other = layer_span(Pad((layer,)), layer, PAPER_VIEW, limits, low)
    assert (other.high_mm <= span.high_mm) == (low >= tilt) or math.isclose(low, tilt, abs_tol=1e-6)


@given(tilt=st.floats(0, 60), cell=st.floats(0.5, 200), spare=st.floats(1, 40))
def test_where_all_cells_count_their_number_is_what_the_layers_places_need(tilt, cell, spare):
    """The picture's area over a cell's, on its axis."""
    layer = Layer("red", cell, np.zeros((60, 60), np.uint8))
    span = layer_span(Pad((layer,)), layer, PAPER_VIEW, ReadLimits(spare_bits=spare), tilt)
    area = PAPER_VIEW.width_px * PAPER_VIEW.height_px
    cells = area / PAPER_VIEW.cell_px(cell, span.low_mm, tilt) ** 2
    assert cells == pytest.approx(np.log2(4 * 60 * 60) + spare)
    steeper, steepest = (
        layer_span(Pad((layer,)), layer, PAPER_VIEW, ReadLimits(spare_bits=spare), by)
        for by in (60, 75)
    )
    assert steepest.low_mm == steeper.low_mm <= span.low_mm * (1 + 1e-9)


def test_a_layer_smaller_than_the_need_reads_nowhere():
    small = Pad((Layer("red", 10.0, np.zeros((6, 6), np.uint8)),))
    (span,) = coverage(small, PAPER_VIEW, ReadLimits(cells_across=8.0))
    assert not span.reads
    assert dead_bands(small, PAPER_VIEW, ReadLimits(cells_across=8.0)) == ()


def test_more_cells_in_the_picture_are_needed_to_find_one_place_of_many():
    """The cells must tell 4 · rows · columns places apart, and some bits more, of Y levels each."""
    limits = ReadLimits(spare_bits=20.0)
    square = View(width_px=500, height_px=500, focal_px=500.0)
    need = cells_needed(5, 2, (64, 64), square, limits)
    assert need**2 == pytest.approx(2 + 12 + 20)
    assert cells_needed(5, 4, (64, 64), square, limits) ** 2 == pytest.approx((2 + 12 + 20) / 2)
    wide = View(width_px=2000, height_px=500, focal_px=500.0)
    assert cells_needed(5, 2, (64, 64), wide, limits) == pytest.approx(need / 2)
    assert cells_needed(4, 2, (64, 64), square, ReadLimits()) == 4
    assert cells_needed(4, 2, (64, 64), square, ReadLimits(cells_across=6)) == 6


def sign(cells=25, cell_mm=50.0):
    return Pad((Layer("blue", cell_mm, np.zeros((cells, cells), np.uint8)),))


def test_the_whole_sign_reads_where_it_is_in_view_and_large_enough():
    limits = ReadLimits(sign_cell_px=2.0, sign_side_px=40.0)
    span = sign_span(sign(), PAPER_VIEW, limits)
    assert span.layer == "outline"
    assert span.low_mm == PAPER_VIEW.holds_from_mm(1250.0)
    assert PAPER_VIEW.cell_px(50.0, span.high_mm) == pytest.approx(2.0)
    few = sign_span(sign(cells=6), PAPER_VIEW, limits, 50.0)
    assert PAPER_VIEW.shorter_px(300.0, few.high_mm, 50.0) == pytest.approx(40.0)
    assert not sign_span(sign(), PAPER_VIEW, ReadLimits()).reads
    assert [each.layer for each in coverage(sign(), PAPER_VIEW, limits)] == ["blue", "outline"]
    assert [each.layer for each in coverage(sign(), PAPER_VIEW, ReadLimits())] == ["blue"]


def test_from_straight_above_the_lean_is_lost_before_the_cells_are():
    """A small sign far away; a lean of 30 degrees shows in its outline."""
    limits = METHOD_LIMITS["dense"]
    upright, leaning = (sign_span(sign(), PAPER_VIEW, limits, tilt) for tilt in (0.0, 30.0))
    least_px = limits.sign_cell_px
    assert PAPER_VIEW.cell_px(50.0, upright.high_mm) > 3 * least_px
    assert PAPER_VIEW.cell_px(50.0, leaning.high_mm, 30.0) < 2 * least_px
    # The same picture from twice as far by a lens twice as long: less perspective, less known.
    longer = View(width_px=2720, height_px=1530, focal_px=2 * 1886.0)
    assert sign_span(sign(), longer, limits).high_mm < 1.7 * upright.high_mm
    # More cells of the same size make the sign larger.
    assert sign_span(sign(cells=40), PAPER_VIEW, limits).high_mm > 1.5 * upright.high_mm


@given(
    cells=st.integers(8, 200),
    cell=st.floats(2, 100),
    scale=st.floats(0.2, 5),
    tilt=st.floats(0, 75),
    method=st.sampled_from(["dense", "paper"]),
)
def test_heights_grow_with_the_pad(cells, cell, scale, tilt, method):
    """All but for the millimetre that a place may always be off."""
    limits = METHOD_LIMITS[method]
    one = coverage(sign(cells, cell), PAPER_VIEW, limits, (tilt,))
    other = coverage(sign(cells, cell * scale), PAPER_VIEW, limits, (tilt,))
    for a, b in zip(one, other, strict=True):
        if math.isfinite(a.low_mm):
            assert b.low_mm == pytest.approx(scale * a.low_mm)
        if min(a.high_mm, b.high_mm) > 1000:
            assert b.high_mm == pytest.approx(scale * a.high_mm, rel=0.05)


def test_refuses_limits_that_are_no_numbers_above_0():
    with pytest.raises(SpecError, match="above 0"):
        ReadLimits(cell_px=0.0)
    with pytest.raises(SpecError, match="above 0"):
        ReadLimits(border_px=-1.0)
    with pytest.raises(SpecError, match="0 … 89"):
        layer_span(sign(), sign().layers[0], PAPER_VIEW, WINDOW, 90.0)
