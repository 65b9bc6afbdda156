"""Stage `decode`, paper: grey values at cell centres, the window's code, its place in the pad.

A b × b window says little by itself: of the 2^25 codes of a 5 × 5 window, 58,564 are somewhere in
a layer of 125 × 125 cells in one of four turns, so that one random lattice in 573 shows a valid
one. The lattice holds more windows than the central one, and they must bear it out:

1. the central window's code occurs in the layer exactly once, in one turn;
2. at least half of the other complete windows hold the codes that the pad has there;
3. all cells of the lattice together agree with the pad beyond `PaperParams.log10_false_alarm`,
   as `padstudio.vision.cells.evidence` counts it.

The third bound is weaker than the dense method's, as the paper's lattice may hold little more
than one window; what was reached stands in the result.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.pad.coding.window_index import WindowIndex
from padstudio.pad.spec import CHANNELS, Layer, Pad
from padstudio.vision.baseline.central_window import CentralWindow
from padstudio.vision.cells.correlation import crop
from padstudio.vision.cells.evidence import Evidence, judge
from padstudio.vision.cells.sampling import CellGrid, read_again, read_cells
from padstudio.vision.frame.pyramid import Pyramid
from padstudio.vision.stage.params import PaperParams
from padstudio.vision.stage.trace import Reason, StageFailure

Levels = NDArray[np.int8]
T = TypeVar("T", bound=np.generic)

# A channel whose picture follows another's this closely, with less than half its contrast, shows
# that one's ink and not its own layer.
_SAME, _FAINT = 0.8, 0.5


@dataclass(frozen=True, eq=False)
class WindowRead:
    """A window read and found in the pad.

    Attributes
    ----------
    window : CentralWindow
    layer : Layer
    place : (row, column, turn)
        Of its top-left cell in the layer; ``numpy.rot90(read, turn)`` is what the pad has there.
    corners_lattice : (4, 2) float64
        Layer coordinates (column, row) of the window's corners, in their order.
    cells : CellGrid
        All cells of the lattice.
    expected : (R, C) int8
        What the pad has there; −1 off the pad.
    evidence : Evidence
        Of all cells.
    windows, windows_right : int
        Other complete windows of the lattice, and those that hold the pad's codes.
    """

    window: CentralWindow
    layer: Layer
    place: tuple[int, int, int]
    corners_lattice: Array
    cells: CellGrid
    expected: Levels
    evidence: Evidence
    windows: int
    windows_right: int


class WindowDecoder:
    """Reads windows of one layer.

    Parameters
    ----------
    pad : Pad
    layer : Layer
    """

    def __init__(self, pad: Pad, layer: Layer) -> None:
        self.pad = pad
        self.layer = layer
        # As the page stands: a pad may be unique only so, and then its turns must be told apart.
        self._index = WindowIndex(layer.field, pad.window, pad.levels, rotation=False)

    def decode(
        self, pyramid: Pyramid, window: CentralWindow, attempts: int, params: PaperParams
    ) -> WindowRead | StageFailure:
        """Read the lattice's cells and look up the central window.

        Parameters
        ----------
        pyramid : Pyramid
        window : CentralWindow
        attempts : int
            Lattices looked at in this frame; each weakens the evidence.
        params : PaperParams
        """
        columns, rows = window.grid.columns, window.grid.rows
        cells = read_cells(
            pyramid,
            window.plane.channel,
            window.to_pixels,
            (columns.first, columns.last),
            (rows.first, rows.last),
        )
        at = (window.row - rows.first, window.column - columns.first)
        if cells is None or not _window(cells.seen, at, window.size).all():
            detail = "the central window reaches beyond the frame"
            return StageFailure("decode", Reason.TOO_FEW_CELLS, detail)
        leak = _leak(pyramid, cells)
        if leak is not None:
            return leak
        place = self._look_up(_window(cells.levels(self.pad.levels), at, window.size))
        if isinstance(place, StageFailure):
            return place
        return self._bear_out(window, cells, place, attempts, params)

    def _look_up(self, levels: Levels) -> tuple[int, int, int] | StageFailure:
        """The one place and turn of a window."""
        turned = np.stack([np.rot90(levels, turn) for turn in range(4)])
        places = self._index.lookup(turned)
        found = np.flatnonzero(places.rows >= 0)
        b = self.pad.window
        if not len(found):
            return StageFailure(
                "decode",
                Reason.UNKNOWN_CODE,
                f"the central {b} x {b} window in {self.layer.channel} is nowhere in the pad",
                "take the dense method: it reads on where single cells are wrong",
            )
        if len(found) > 1:
            return StageFailure(
                "decode",
                Reason.UNKNOWN_CODE,
                f"the central {b} x {b} window in {self.layer.channel} is in the pad in "
                f"{len(found)} turns",
                "design the pad unique in all turns, or take the dense method",
            )
        turn = int(found[0])
        return int(places.rows[turn]), int(places.cols[turn]), turn

    def _bear_out(
        self,
        window: CentralWindow,
        cells: CellGrid,
        place: tuple[int, int, int],
        attempts: int,
        params: PaperParams,
    ) -> WindowRead | StageFailure:
        """Compare all other cells of the lattice with the pad."""
        at = (window.row - cells.row0, window.column - cells.column0)
        levels = cells.levels(self.pad.levels)
        expected = self._expected(levels.shape, at, place)
        places = 4 * self.layer.rows * self.layer.cols * attempts
        evidence = judge(levels, expected, self.pad.levels, places)
        windows, right = _other_windows(levels, expected, window.size)
        if 2 * right < windows or evidence.log10_false_alarm > params.log10_false_alarm:
            return StageFailure(
                "decode",
                Reason.UNKNOWN_CODE,
                f"the central window is in the pad, but {windows - right} of {windows} other "
                f"windows and {evidence.wrong} of {evidence.read} cells differ from it "
                f"({evidence.compared_with(params.log10_false_alarm)})",
            )
        corners = _corners(place, window.size)
        return WindowRead(
            window, self.layer, place, corners, cells, expected, evidence, windows, right
        )

    def _expected(
        self, shape: tuple[int, ...], at: tuple[int, int], place: tuple[int, int, int]
    ) -> Levels:
        """The pad's levels at all cells of a lattice whose window is at a known place."""
        row, col, turn = place
        down, right = at
        b = self.pad.window
        below, beyond = shape[0] - b - down, shape[1] - b - right
        # Cells before the window, along the layer's rows and columns.
        above, left = ((down, right), (beyond, down), (below, beyond), (right, below))[turn]
        turned = (shape[0], shape[1]) if turn % 2 == 0 else (shape[1], shape[0])
        held = crop(self.layer.field, row - above, col - left, turned)
        return np.ascontiguousarray(np.rot90(held, -turn))


def _window(values: NDArray[T], at: tuple[int, int], size: int) -> NDArray[T]:
    return values[at[0] : at[0] + size, at[1] : at[1] + size]


def _corners(place: tuple[int, int, int], size: int) -> Array:
    """Layer coordinates (column, row) of a window's corners as the picture orders them."""
    row, col, turn = place
    square = np.array([[0, 0], [size, 0], [size, size], [0, size]], float)
    # A counter-clockwise quarter turn takes the picture's top left to the layer's bottom left.
    return np.roll(square + np.array([col, row]), turn, axis=0)


def _other_windows(levels: Levels, expected: Levels, size: int) -> tuple[int, int]:
    """Complete windows besides the central one, and those that equal the pad's."""
    known = (levels >= 0) & (expected >= 0)
    view = np.lib.stride_tricks.sliding_window_view
    complete = view(known, (size, size)).all(axis=(2, 3))
    right = complete & view(levels == expected, (size, size)).all(axis=(2, 3))
    return int(complete.sum()) - 1, int(right.sum()) - 1


def _leak(pyramid: Pyramid, cells: CellGrid) -> StageFailure | None:
    """Whether a channel shows another layer's ink rather than its own cells.

    A layer's code may stand in another layer as well, magnified: read through the wrong channel
    it would give a pose at a false height.
    """
    own = cells.values[cells.seen]
    for channel in CHANNELS:
        if channel == cells.channel:
            continue
        theirs = read_again(pyramid, channel, cells)[cells.seen]
        likeness = float(np.corrcoef(own, theirs)[0, 1]) if own.std() and theirs.std() else 0.0
        if abs(likeness) > _SAME and own.std() < _FAINT * theirs.std():
            return StageFailure(
                "decode",
                Reason.CROSSTALK,
                f"{cells.channel} follows {channel} (correlation {likeness:.2f}) with "
                f"{100 * own.std() / theirs.std():.0f} % of its contrast: it is that layer's ink",
                "print with purer inks",
            )
    return None
