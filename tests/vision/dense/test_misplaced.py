"""A sheet in another one's place that fills most of the view."""

from types import SimpleNamespace

import numpy as np
import pytest

from padstudio.pad.spec import Layer, Pad
from padstudio.vision.cells.evidence import judge
from padstudio.vision.dense.misplaced import _other_place

FIELD = np.random.default_rng(6).integers(0, 2, (60, 60)).astype(np.uint8)
PAD = Pad((Layer("red", 10.0, FIELD),), window=5)
REFINER = SimpleNamespace(pad=PAD, attempts=3)
ROWS, COLS, ROW0, COL0 = 30, 24, 20, 10


def read_of(levels):
    """Cells as read where a pose puts them from row 20 and column 10 on."""
    expected = FIELD[ROW0 : ROW0 + ROWS, COL0 : COL0 + COLS].astype(np.int8)
    cells = SimpleNamespace(levels=lambda count: levels, row0=ROW0, column0=COL0)
    evidence = judge(levels, expected, 2, 1)
    layer = PAD.layers[0]
    return SimpleNamespace(cells=cells, expected=expected, evidence=evidence, layer=layer)


def elsewhere(row0, col0):
    return FIELD[row0 : row0 + ROWS, col0 : col0 + COLS].astype(np.int8)


def test_a_view_of_one_place_has_no_other():
    levels = elsewhere(ROW0, COL0)
    levels[:, :11] = np.random.default_rng(1).integers(0, 2, (ROWS, 11))
    assert _other_place(REFINER, read_of(levels)) is None


@pytest.mark.parametrize(("sides", "more"), [(1, 0), (2, 1)])
def test_cells_of_another_place_are_found_and_their_pieces_counted(sides, more):
    levels, other = elsewhere(ROW0, COL0), elsewhere(5, 30)
    levels[:8] = other[:8]
    if sides > 1:
        levels[-8:] = other[-8:]
    place = _other_place(REFINER, read_of(levels))
    assert place.away == (5 - ROW0, 30 - COL0)
    assert place.more == more


@pytest.mark.parametrize("off", [1, 2, 4])
def test_rows_that_shaking_puts_off_are_no_other_place(off):
    levels = elsewhere(ROW0, COL0)
    levels[:12] = elsewhere(ROW0, COL0 + off)[:12]
    levels[-8:] = elsewhere(ROW0, COL0 - off)[-8:]
    assert _other_place(REFINER, read_of(levels)) is None
