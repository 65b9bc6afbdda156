"""The central window's code, its place, and what else must bear it out."""

import numpy as np
import pytest
from paper_frames import edge_map

from padstudio.pad.spec import Layer, Pad
from padstudio.vision.baseline.central_window import central_window
from padstudio.vision.baseline.decode import WindowDecoder, WindowRead
from padstudio.vision.baseline.hough import Lines
from padstudio.vision.baseline.line_grid import Family, LineGrid
from padstudio.vision.frame.pyramid import Pyramid
from padstudio.vision.stage.params import PaperParams
from padstudio.vision.stage.trace import Reason, StageFailure

PITCH, WINDOW = 40, 4
PARAMS = PaperParams()


def field(seed=4, rows=20, cols=24, levels=2):
    return np.random.default_rng(seed).integers(0, levels, (rows, cols)).astype(np.uint8)


def pad_of(levels_field, levels=2):
    return Pad((Layer("red", 10.0, levels_field),), window=WINDOW, levels=levels)


def picture(cells, channel="red", high=220, low=40, levels=2):
    """A picture of cells of 40 px, upright, in one channel; the others are dark."""
    image = np.full((480, 640, 3), 30, np.uint8)
    values = low + (high - low) * cells.astype(float) / (levels - 1)
    patch = np.kron(values, np.ones((PITCH, PITCH))).astype(np.uint8)
    image[: patch.shape[0], : patch.shape[1], "bgr".index(channel[0])] = patch
    return image


def window_over(cells, channel="red"):
    """The central window of the lattice that shows some cells."""
    rows, cols = cells.shape
    x = np.array([(1.0, 0.0, 0.5 - PITCH * k) for k in range(cols + 1)])
    y = np.array([(0.0, 1.0, 0.5 - PITCH * k) for k in range(rows + 1)])
    families = [Family(0, lines, np.zeros(len(lines), bool)) for lines in (x, y)]
    edges = edge_map(channel=channel)
    nothing = Lines(np.zeros((0, 2, 2)), np.zeros(0), np.zeros((0, 2, 2)), edges)
    to_lattice = np.array([[1 / PITCH, 0, 0.5 / PITCH], [0, 1 / PITCH, 0.5 / PITCH], [0, 0, 1]])
    grid = LineGrid(*families, to_lattice, 0.1, nothing, np.zeros(0, bool))
    return central_window(grid, WINDOW)


def read(pad, cells, image=None):
    decoder = WindowDecoder(pad, pad.layers[0])
    image = picture(cells, levels=pad.levels) if image is None else image
    return decoder.decode(Pyramid(image), window_over(cells), 1, PARAMS)


@pytest.mark.parametrize("turn", range(4))
def test_place_and_turn_are_found(turn):
    pad = pad_of(field())
    shown = np.rot90(pad.layers[0].field[3:13, 5:16], -turn)
    found = read(pad, shown)
    assert isinstance(found, WindowRead)
    assert found.place[2] == turn
    np.testing.assert_array_equal(found.expected, shown)
    assert (found.evidence.wrong, found.windows_right) == (0, found.windows)
    assert found.windows == (shown.shape[0] - 3) * (shown.shape[1] - 3) - 1
    row, col, _ = found.place
    # The corners go round as the picture's do, and enclose the window's cells.
    assert found.corners_lattice.min(axis=0).tolist() == [col, row]
    assert found.corners_lattice.max(axis=0).tolist() == [col + WINDOW, row + WINDOW]
    x, y = found.corners_lattice.T
    area = 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))
    assert area == WINDOW**2
    first = [(0, 0), (0, WINDOW), (WINDOW, WINDOW), (WINDOW, 0)][turn]
    assert (found.corners_lattice[0] - (col, row)).tolist() == list(first)


def test_a_window_that_is_nowhere_is_refused():
    pad = pad_of(field())
    other = read(pad, field(seed=99)[:10, :11])
    assert isinstance(other, StageFailure)
    assert other.reason is Reason.UNKNOWN_CODE


def test_a_window_that_stands_in_several_turns_is_refused_as_such():
    pad = pad_of(field())
    copied = pad.layers[0].field.copy()
    shown = copied[2:12, 2:13].copy()
    window = window_over(shown)
    at = np.s_[window.row : window.row + WINDOW, window.column : window.column + WINDOW]
    copied[15:19, 18:22] = np.rot90(shown[at])
    found = read(pad_of(copied), shown)
    assert isinstance(found, StageFailure)
    assert found.reason is Reason.UNKNOWN_CODE
    assert "2 turns" in found.detail


def test_other_windows_that_disagree_refuse_a_chance_hit():
    pad = pad_of(field())
    shown = field(seed=7)[:10, :11]
    window = window_over(shown)
    at = np.s_[window.row : window.row + WINDOW, window.column : window.column + WINDOW]
    shown[at] = pad.layers[0].field[6:10, 6:10]
    found = read(pad, shown)
    assert isinstance(found, StageFailure)
    assert "the central window is in the pad, but" in found.detail


def test_one_window_alone_is_not_enough():
    pad = pad_of(field())
    found = read(pad, pad.layers[0].field[3 : 3 + WINDOW, 5 : 5 + WINDOW])
    assert isinstance(found, StageFailure)
    assert "0 of 0 other windows and 0 of 16 cells" in found.detail


def test_a_misread_cell_outside_the_window_is_forgiven():
    pad = pad_of(field())
    shown = pad.layers[0].field[3:13, 5:16].copy()
    shown[0, 0] ^= 1
    found = read(pad, shown)
    assert isinstance(found, WindowRead)
    assert found.evidence.wrong == 1
    assert found.windows_right == found.windows - 1


def test_three_levels_are_read():
    pad = pad_of(field(levels=3), levels=3)
    found = read(pad, pad.layers[0].field[3:13, 5:16])
    assert isinstance(found, WindowRead)
    assert found.evidence.wrong == 0


def test_another_layers_ink_is_not_taken_for_the_layer():
    pad = pad_of(field())
    shown = pad.layers[0].field[3:13, 5:16]
    image = picture(shown, "blue") // 4 * 4
    image[:, :, 2] = 40 + image[:, :, 0] // 8
    found = read(pad, shown, image)
    assert isinstance(found, StageFailure)
    assert found.reason is Reason.CROSSTALK


def test_a_window_beyond_the_frame_is_refused():
    pad = pad_of(field())
    shown = pad.layers[0].field[:14, :20]
    found = read(pad, shown, picture(shown[:12, :16]))
    assert isinstance(found, WindowRead)
    far = pad.layers[0].field[:20, :24]
    beyond = WindowDecoder(pad, pad.layers[0]).decode(
        Pyramid(picture(far[:12, :16])[:200, :300]), window_over(far), 1, PARAMS
    )
    assert isinstance(beyond, StageFailure)
    assert beyond.reason is Reason.TOO_FEW_CELLS
