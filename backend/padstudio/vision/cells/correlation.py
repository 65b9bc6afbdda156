"""Stage `decode`: which place of the pad, and which turn of it, the read cells show.

The whole patch of read cells is correlated with the pad's field at all places and in all four
turns at once, by Fourier transform: every cell in view votes, a misread one costs one vote, and
views with less than a full window count as well. `padstudio.vision.cells.evidence` then judges the
best place by the levels read blind. It is template matching by cross-correlation in the Fourier
domain, normalized by the template's energy in the overlap.

References
----------
Lewis, J. P. (1995). Fast normalized cross-correlation. Vision Interface.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.pad.spec import Layer, Pad
from padstudio.vision.cells.evidence import Evidence, judge
from padstudio.vision.cells.sampling import CellGrid, relative_field

Spectrum = NDArray[np.complex128] | NDArray[np.complex64]

# Cells' brightness counts up to so many deviations, twice those of a binary code's levels, so that
# glare does not outvote cells. 1 and 4 find the same stills of the score.
_CLIP = 2.0
# The energy of smaller overlaps counts as that of so many cells, which chance could still explain.
_LEAST_OVERLAP = 12
# At most so many cells a side are correlated: more take longer, and are no surer. 24 and 96 find
# the same stills of the score.
_PATCH = 48


@dataclass(frozen=True, eq=False)
class Placement:
    """Where on a layer the read cells lie.

    Attributes
    ----------
    layer : Layer
    quarter_turns : int
        Counter-clockwise quarter turns that take the read patch to the field.
    pad_from_lattice : (3, 3) float64
        Takes homogeneous lattice coordinates (column, row, 1) of the picture to those of the
        layer.
    evidence : Evidence
    cells : CellGrid
    expected : (R, C) int8
        Levels that the pad has at the read cells; −1 off the pad.
    """

    layer: Layer
    quarter_turns: int
    pad_from_lattice: Array
    evidence: Evidence
    cells: CellGrid
    expected: NDArray[np.int8]


class LayerIndex:
    """A layer prepared for look-up by correlation.

    Parameters
    ----------
    pad : Pad
    layer : Layer
    """

    def __init__(self, pad: Pad, layer: Layer) -> None:
        self.pad = pad
        self.layer = layer
        # Wide enough for any patch, so that the field need be transformed only once.
        self._side = cv2.getOptimalDFTSize(max(layer.field.shape) + _PATCH)

    def locate(self, cells: CellGrid, attempts: int = 1) -> Placement | None:
        """The likeliest place of read cells.

        Parameters
        ----------
        cells : CellGrid
            Read from the layer's channel.
        attempts : int
            How many other questions were asked of the same frame; it weakens the evidence.

        Returns
        -------
        Placement or None
            The best place, whether or not the evidence suffices; None without any overlap.
        """
        side = self._side
        top, left, patch = _middle(np.clip(cells.relative, -_CLIP, _CLIP), cells.seen)
        signal = np.fft.rfft2(patch, (side, side)).conj()
        energy = np.fft.rfft2(patch * patch, (side, side)).conj()
        best: tuple[float, int, int, int] | None = None
        fields, supports = self._spectra
        # A field turned by a half overlaps as it does unturned.
        norms = []
        for support in supports:
            weight = np.fft.irfft2(support * energy, (side, side))
            norms.append(1 / np.sqrt(np.maximum(weight, _LEAST_OVERLAP)))
        for quarters, field in enumerate(fields):
            match = np.fft.irfft2(field * signal, (side, side))
            score = match * norms[quarters % len(norms)]
            peak = int(np.argmax(score))
            if best is None or score.flat[peak] > best[0]:
                best = (float(score.flat[peak]), quarters, *divmod(peak, side))
        assert best is not None
        _, quarters, row, col = best
        shape = self.layer.field.shape if quarters % 2 == 0 else self.layer.field.shape[::-1]
        # A peak in the upper part of the cyclic range stands for a negative shift.
        row = row - side if row >= shape[0] else row
        col = col - side if col >= shape[1] else col
        return self._placement(cells, quarters, row - top, col - left, attempts)

    @cached_property
    def _spectra(self) -> tuple[list[Spectrum], list[Spectrum]]:
        """Transforms of the field turned clockwise by 0 … 3 quarters, and of its support: upright
        and turned by one, or one for all turns of a square field."""
        field = np.clip(relative_field(self.layer.field), -_CLIP, _CLIP)
        shape = (self._side, self._side)
        ones = np.ones_like(field)
        supports = 1 if field.shape[0] == field.shape[1] else 2
        return (
            [np.fft.rfft2(np.rot90(field, -quarters), shape) for quarters in range(4)],
            [np.fft.rfft2(np.rot90(ones, -quarters), shape) for quarters in range(supports)],
        )

    def _placement(
        self, cells: CellGrid, quarters: int, row: int, col: int, attempts: int
    ) -> Placement | None:
        """The place where the patch's first cell lies in the field turned clockwise."""
        turned = np.rot90(self.layer.field, -quarters)
        expected = crop(turned, row, col, cells.values.shape)
        rows, cols = cells.values.shape
        places = 4 * (self.layer.rows + rows) * (self.layer.cols + cols)
        evidence = judge(
            cells.levels(self.pad.levels), expected, self.pad.levels, places * attempts
        )
        shift = np.array([[1.0, 0, col - cells.column0], [0, 1.0, row - cells.row0], [0, 0, 1]])
        to_pad = _turned_back(quarters, turned.shape) @ shift
        return Placement(self.layer, quarters, to_pad, evidence, cells, expected)


def crop(field: NDArray[np.uint8], row: int, col: int, shape: tuple[int, int]) -> NDArray[np.int8]:
    """A window of a field that may reach beyond it; −1 there."""
    out = np.full(shape, -1, np.int8)
    r0, c0 = max(row, 0), max(col, 0)
    r1, c1 = min(row + shape[0], field.shape[0]), min(col + shape[1], field.shape[1])
    if r0 < r1 and c0 < c1:
        out[r0 - row : r1 - row, c0 - col : c1 - col] = field[r0:r1, c0:c1]
    return out


def _middle(
    patch: NDArray[np.float32], seen: NDArray[np.bool_]
) -> tuple[int, int, NDArray[np.float32]]:
    """The middle of a large patch, and where it begins: more cells do not make a place surer."""
    rows, cols = np.nonzero(seen.any(axis=1))[0], np.nonzero(seen.any(axis=0))[0]
    top = max(0, int((rows[0] + rows[-1] + 1) // 2) - _PATCH // 2)
    left = max(0, int((cols[0] + cols[-1] + 1) // 2) - _PATCH // 2)
    return top, left, patch[top : top + _PATCH, left : left + _PATCH]


def _turned_back(quarters: int, shape: tuple[int, ...]) -> Array:
    """Lattice coordinates of a field turned clockwise to those of the field itself."""
    rows, cols = shape
    turns = {
        0: [[1.0, 0, 0], [0, 1.0, 0], [0, 0, 1]],
        1: [[0.0, 1, 0], [-1.0, 0, cols], [0, 0, 1]],
        2: [[-1.0, 0, cols], [0, -1.0, rows], [0, 0, 1]],
        3: [[0.0, -1, rows], [1.0, 0, 0], [0, 0, 1]],
    }
    return np.array(turns[quarters])
