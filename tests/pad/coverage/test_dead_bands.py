"""Heights between those that read, by geometry."""

import numpy as np
import pytest

from padstudio.pad.coverage.dead_bands import dead_bands
from padstudio.pad.coverage.pinhole import View
from padstudio.pad.coverage.spans import ReadLimits, coverage
from padstudio.pad.spec import Layer, Pad

PAPER_VIEW = View(width_px=2720, height_px=1530, focal_px=1886.0)
WINDOW = ReadLimits(cell_px=3.0)


def pad(fine_mm=10.0, ratio=5, cells=125):
    fine = np.zeros((cells, cells), np.uint8)
    coarse = np.zeros((cells // ratio, cells // ratio), np.uint8)
    return Pad((Layer("blue", fine_mm * ratio, coarse), Layer("red", fine_mm, fine)))


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


def test_a_dead_band_below_the_whole_sign():
    """Cells too small to be read before so large a sign is in the picture as a whole."""
    large = Pad((Layer("red", 10.0, np.zeros((600, 600), np.uint8)),))
    limits = ReadLimits(cell_px=4.0, sign_cell_px=1.0)
    (band,) = dead_bands(large, PAPER_VIEW, limits)
    red, sign = coverage(large, PAPER_VIEW, limits)
    assert (band.low_mm, band.high_mm) == (red.high_mm, sign.low_mm)
    assert "the sign as a whole" in band.message
    assert dead_bands(large, PAPER_VIEW, ReadLimits(cell_px=4.0)) == ()
