"""Heights at which layers read, dead bands and advice, by geometry."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from padstudio.errors import SpecError
from padstudio.pad.advice import OVERLAP, advise, round_down
from padstudio.pad.coverage import (
    ReadLimits,
    Span,
    View,
    coverage,
    covered_share,
    dead_bands,
    layer_span,
)
from padstudio.pad.spec import Layer, Pad

PAPER_VIEW = View(width_px=2720, height_px=1530, focal_px=1886.0)
WINDOW = ReadLimits(cell_px=3.0)


def pad(fine_mm=10.0, ratio=5, cells=125):
    fine = np.zeros((cells, cells), np.uint8)
    coarse = np.zeros((cells // ratio, cells // ratio), np.uint8)
    return Pad((Layer("blue", fine_mm * ratio, coarse), Layer("red", fine_mm, fine)))


def test_the_papers_camera_sees_2_9_coarse_cells_at_18_cm():
    assert PAPER_VIEW.cells_across(50.0, 180.0) == pytest.approx(2.92, abs=0.005)


def test_switching_at_18_cm_leaves_a_dead_band():
    assert dead_bands(pad(), PAPER_VIEW, WINDOW) == ()
    (band,) = dead_bands(pad(), PAPER_VIEW, WINDOW, switch_mm=180.0)
    assert band.low_mm == 180.0
    assert band.high_mm == pytest.approx(5 * 50 * 1886 / 1530)
    assert "2.9 blue cells" in band.message


def test_a_dead_band_between_layers_that_are_far_apart():
    wide_apart = Pad(
        (Layer("red", 1.0, np.zeros((200, 200))), Layer("blue", 400.0, np.zeros((6, 6))))
    )
    (band,) = dead_bands(wide_apart, PAPER_VIEW, WINDOW)
    red, blue = coverage(wide_apart, PAPER_VIEW, WINDOW)
    assert (band.low_mm, band.high_mm) == (red.high_mm, blue.low_mm)


def test_spans_follow_similar_triangles():
    red, blue = coverage(pad(), PAPER_VIEW, WINDOW)
    assert (red.channel, blue.channel) == ("red", "blue")
    assert red.low_mm == pytest.approx(5 * 10 * 1886 / 1530)
    assert red.high_mm == pytest.approx(1886 * 10 / 3)
    assert blue.low_mm == pytest.approx(5 * red.low_mm)
    assert blue.high_mm == pytest.approx(5 * red.high_mm)


@pytest.mark.parametrize("tilt", [10.0, 35.0, 60.0])
def test_extent_and_cell_size_under_tilt_agree_with_rays(tilt):
    """Rays of the picture's middle lines, met with the ground one by one."""
    angle, height = math.radians(tilt), 700.0
    extents = []
    for along, across in ((2720, 1530), (1530, 2720)):
        edge = [math.atan(s * along / 2 / 1886.0) for s in (-1, 1)]
        if angle + edge[1] < math.pi / 2:
            near, far = (height * math.tan(angle + e) for e in edge)
            extents.append(far - near)
        extents.append(height / math.cos(angle) * across / 1886.0)
    assert PAPER_VIEW.cells_across(10.0, height, tilt) == pytest.approx(min(extents) / 10.0)
    step = math.atan((height * math.tan(angle) + 0.5) / height) - math.atan(
        (height * math.tan(angle) - 0.5) / height
    )
    along = 1886.0 * math.tan(step)
    across = 1886.0 / (height / math.cos(angle))
    width = PAPER_VIEW.cell_px(1.0, height, tilt)
    assert width == pytest.approx(math.sqrt(along * across), rel=1e-3)


@given(tilt=st.floats(0, 80), low=st.floats(0, 80), cell=st.floats(0.5, 200), need=st.floats(2, 12))
def test_a_layer_reads_within_its_span_and_not_beyond(tilt, low, cell, need):
    limits = ReadLimits(cells_across=need, cell_px=2.5)
    layer = Layer("red", cell, np.zeros((40, 40), np.uint8))
    span = layer_span(Pad((layer,)), layer, PAPER_VIEW, limits, tilt)
    assert PAPER_VIEW.cells_across(cell, span.low_mm, tilt) == pytest.approx(need)
    assert PAPER_VIEW.cell_px(cell, span.high_mm, tilt) == pytest.approx(2.5)
    other = layer_span(Pad((layer,)), layer, PAPER_VIEW, limits, low)
    assert (other.high_mm <= span.high_mm) == (low >= tilt) or math.isclose(low, tilt, abs_tol=1e-6)


def test_a_layer_smaller_than_the_need_reads_nowhere():
    small = Pad((Layer("red", 10.0, np.zeros((6, 6), np.uint8)),))
    (span,) = coverage(small, PAPER_VIEW, ReadLimits(cells_across=8.0))
    assert not span.reads
    assert dead_bands(small, PAPER_VIEW, ReadLimits(cells_across=8.0)) == ()


def test_covered_share_counts_ratios_of_height():
    spans = (
        Span(channel="red", tilt_deg=0, low_mm=10, high_mm=100),
        Span(channel="blue", tilt_deg=0, low_mm=1000, high_mm=5000),
    )
    assert covered_share(spans, 10, 10_000) == pytest.approx((1 + math.log10(5)) / 3)
    assert covered_share(spans[:1], 10, 100) == pytest.approx(1.0)


@given(
    low=st.floats(30, 800),
    factor=st.floats(1.5, 400),
    tilt=st.floats(0, 40),
)
def test_advice_without_notes_covers_the_wanted_heights(low, factor, tilt):
    advice = advise(PAPER_VIEW, low, low * factor, limits=WINDOW, tilt_deg=tilt)
    fine = np.zeros((advice.cells, advice.cells), np.uint8)
    coarse = np.zeros((advice.cells // advice.ratio,) * 2, np.uint8)
    layers = [Layer("red", advice.cell_mm, fine)]
    if advice.ratio > 1:
        layers.append(Layer("blue", advice.cell_mm * advice.ratio, coarse))
    advised = Pad(tuple(layers))
    assert advice.cells % advice.ratio == 0
    assert advice.size_mm == pytest.approx(advised.width_mm)
    assert dead_bands(advised, PAPER_VIEW, WINDOW) == ()
    upright = coverage(advised, PAPER_VIEW, WINDOW)
    leaning = coverage(advised, PAPER_VIEW, WINDOW, (tilt,))
    assert upright[0].low_mm <= low * 1.0001
    if not advice.notes:
        assert leaning[-1].high_mm >= low * factor * 0.9999
    if len(upright) == 2:
        assert upright[1].low_mm <= upright[0].high_mm / OVERLAP * 1.0001


def test_advice_says_what_two_layers_cannot():
    narrow = View(width_px=320, height_px=240, focal_px=300.0)
    advice = advise(narrow, 50.0, 20_000.0, limits=ReadLimits(cell_px=6.0))
    assert "third layer" in advice.notes[0]
    assert advice.high_mm < 20_000


def test_advice_names_a_code_that_is_too_small():
    advice = advise(PAPER_VIEW, 20.0, 400.0, window=3, limits=WINDOW, reach_mm=500.0)
    assert any("window 3" in note for note in advice.notes)


@given(st.floats(1e-3, 1e5))
def test_round_down_keeps_within_a_third(value):
    assert value * 0.66 < round_down(value) <= value * (1 + 1e-9)


def test_refuses_what_is_no_view_tilt_or_range():
    with pytest.raises(SpecError, match="focal length"):
        View(width_px=100, height_px=100, focal_px=0.0)
    with pytest.raises(SpecError, match="0 … 89"):
        PAPER_VIEW.cells_across(10.0, 100.0, 90.0)
    with pytest.raises(SpecError, match="no range"):
        advise(PAPER_VIEW, 300.0, 200.0)
    with pytest.raises(SpecError, match="no range"):
        covered_share((), 5.0, 5.0)
    with pytest.raises(SpecError, match="above 0"):
        ReadLimits(cell_px=0.0)
