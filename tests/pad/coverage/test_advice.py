"""Sizes of a pad for a wanted range of heights, against the chart of what they read."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from padstudio.errors import SpecError
from padstudio.pad.coverage.advice import OVERLAP, Envelope, advise, round_down
from padstudio.pad.coverage.dead_bands import dead_bands
from padstudio.pad.coverage.pinhole import View
from padstudio.pad.coverage.spans import METHOD_LIMITS, ReadLimits, coverage
from padstudio.pad.spec import Layer, Pad

PAPER_VIEW = View(width_px=2720, height_px=1530, focal_px=1886.0)
WINDOW = ReadLimits(cell_px=3.0)


@given(
    low=st.floats(30, 800),
    factor=st.floats(1.5, 400),
    tilt=st.floats(0, 40),
)
def test_advice_without_notes_covers_the_wanted_heights(low, factor, tilt):
    advice = advise(PAPER_VIEW, Envelope(low, low * factor, tilt), limits=WINDOW)
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
    advice = advise(narrow, Envelope(50.0, 20_000.0), limits=ReadLimits(cell_px=6.0))
    assert "third layer" in advice.notes[0]
    assert advice.high_mm < 20_000


def test_advice_names_a_code_that_is_too_small():
    advice = advise(PAPER_VIEW, Envelope(20.0, 400.0, reach_mm=500.0), window=3, limits=WINDOW)
    assert any("window 3" in note for note in advice.notes)


@given(st.floats(1e-3, 1e5))
def test_round_down_keeps_within_a_third(value):
    assert value * 0.66 < round_down(value) <= value * (1 + 1e-9)


def test_refuses_what_is_no_range():
    with pytest.raises(SpecError, match="no range"):
        Envelope(300.0, 200.0)


@pytest.mark.parametrize("method", ["dense", "paper"])
@pytest.mark.parametrize("high_mm", [1500.0, 9000.0])
def test_an_advised_pad_tells_its_pose_at_the_wanted_height(method, high_mm):
    """From straight above too, where a sign that is too small does not show its lean."""
    limits = METHOD_LIMITS[method]
    advice = advise(PAPER_VIEW, Envelope(100.0, high_mm, 20.0), limits=limits)
    layers = [Layer("red", advice.cell_mm, np.zeros((advice.cells,) * 2, np.uint8))]
    if advice.ratio > 1:
        coarse = np.zeros((advice.cells // advice.ratio,) * 2, np.uint8)
        layers.append(Layer("blue", advice.cell_mm * advice.ratio, coarse))
    for tilt in (0.0, 20.0):
        spans = coverage(Pad(tuple(layers)), PAPER_VIEW, limits, (tilt,))
        reached = max(span.high_mm for span in spans if span.layer != "outline")
        assert reached >= advice.high_mm * 0.999
    assert bool(advice.notes) == (advice.high_mm < high_mm * 0.999)
