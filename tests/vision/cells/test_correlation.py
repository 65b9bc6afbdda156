"""Where on the pad read cells lie: every turn, every place, also beyond the rim."""

import numpy as np
import pytest
from dense_frames import cell_grid, random_pad
from hypothesis import given
from hypothesis import strategies as st

from padstudio.pad.spec import Layer, Pad
from padstudio.vision.cells.correlation import LayerIndex, crop

PAD = random_pad(8, cells=(60, 25))
OBLONG = Pad((Layer("red", 10.0, np.random.default_rng(3).integers(0, 2, (40, 23))),))
INDICES = {"square": LayerIndex(PAD, PAD.layers[0]), "oblong": LayerIndex(OBLONG, OBLONG.layers[0])}


def seen_patch(field, turn, row, col, shape, rng):
    """Cells of a field turned clockwise, from a place on; the ground beyond it is random."""
    expected = crop(np.rot90(field, -turn), row, col, shape)
    ground = rng.integers(0, 2, shape)
    return np.where(expected >= 0, expected, ground), expected


@given(
    which=st.sampled_from(sorted(INDICES)),
    turn=st.integers(0, 3),
    place=st.tuples(st.floats(0, 1), st.floats(0, 1)),
    shape=st.tuples(st.integers(10, 20), st.integers(10, 20)),
    beyond=st.integers(0, 6),
    wrong=st.floats(0, 0.06),
    corner=st.tuples(st.integers(-40, 40), st.integers(-40, 40)),
    seed=st.integers(0, 10**6),
)
def test_every_turn_and_place_is_found(which, turn, place, shape, beyond, wrong, corner, seed):
    index = INDICES[which]
    field = index.layer.field
    rng = np.random.default_rng(seed)
    rows, cols = np.rot90(field, -turn).shape
    row = round(place[0] * (rows - shape[0] + 2 * beyond)) - beyond
    col = round(place[1] * (cols - shape[1] + 2 * beyond)) - beyond
    # So much of a patch must lie on the pad that no other place can be as good.
    patch, expected = seen_patch(field, turn, row, col, shape, rng)
    if (expected >= 0).sum() < 64:
        return
    flipped = rng.random(shape) < wrong
    cells = cell_grid(np.where(flipped, 1 - patch, patch), column0=corner[0], row0=corner[1])
    found = index.locate(cells)
    assert found is not None
    np.testing.assert_array_equal(found.expected, expected)
    assert found.quarter_turns == turn
    # The first cell's middle, by the map and by the turned field itself.
    numbers = np.arange(field.size).reshape(field.shape)
    turned = crop_numbers(np.rot90(numbers, -turn), row, col, shape)
    r, c = np.argwhere(turned >= 0)[0]
    there = found.pad_from_lattice @ [corner[0] + c + 0.5, corner[1] + r + 0.5, 1.0]
    true_row, true_col = divmod(int(turned[r, c]), field.shape[1])
    np.testing.assert_allclose(there, [true_col + 0.5, true_row + 0.5, 1.0], atol=1e-9)


def crop_numbers(numbers, row, col, shape):
    out = np.full(shape, -1)
    for r in range(shape[0]):
        for c in range(shape[1]):
            if 0 <= row + r < numbers.shape[0] and 0 <= col + c < numbers.shape[1]:
                out[r, c] = numbers[row + r, col + c]
    return out


@pytest.mark.parametrize("turn", range(4))
def test_the_whole_pad_and_more_in_view(turn):
    index = INDICES["square"]
    rng = np.random.default_rng(turn)
    patch, expected = seen_patch(index.layer.field, turn, -9, -4, (80, 75), rng)
    found = index.locate(cell_grid(patch))
    assert found is not None
    np.testing.assert_array_equal(found.expected, expected)
    assert found.evidence.wrong == 0
    assert found.evidence.suffices(-100)


def test_unseen_cells_do_not_vote():
    index = INDICES["square"]
    rng = np.random.default_rng(2)
    patch, expected = seen_patch(index.layer.field, 1, 20, 30, (14, 14), rng)
    seen = np.ones(patch.shape, bool)
    seen[:, :5] = False
    garbled = np.where(seen, patch, rng.integers(0, 2, patch.shape))
    found = index.locate(cell_grid(garbled, seen=seen))
    assert found is not None
    np.testing.assert_array_equal(found.expected, expected)
    assert found.evidence.read == seen.sum()


def test_earlier_attempts_weaken_the_evidence():
    index = INDICES["square"]
    patch = index.layer.field[10:22, 10:22]
    once, often = (index.locate(cell_grid(patch), attempts) for attempts in (1, 1000))
    assert once is not None
    assert often is not None
    assert often.evidence.log10_false_alarm == pytest.approx(once.evidence.log10_false_alarm + 3)


def test_a_crop_beyond_the_field_is_marked():
    field = np.arange(12, dtype=np.uint8).reshape(3, 4)
    out = crop(field, -1, 2, (3, 4))
    np.testing.assert_array_equal(out, [[-1, -1, -1, -1], [2, 3, -1, -1], [6, 7, -1, -1]])
    assert (crop(field, 9, 9, (2, 2)) == -1).all()
