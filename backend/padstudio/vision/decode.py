"""Stage `decode`: which place of the pad, and which turn of it, the read cells show.

The whole patch of read cells is correlated with the pad's field at all places and in all four
turns at once, by Fourier transform: every cell in view votes, a misread one costs one vote, and
views with less than a full window count as well. `padstudio.vision.evidence` then judges the
best place by the levels read blind.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.pad.spec import Layer, Pad
from padstudio.vision.cells import CellGrid, relative_field
from padstudio.vision.evidence import Evidence, judge
from padstudio.vision.types import Array

Spectrum = NDArray[np.complex128]

_CLIP = 2.0
# Overlaps of fewer cells with the pad are not looked at.
_LEAST_OVERLAP = 12


@dataclass(frozen=True, eq=False)
class Placement:
    """Where on a layer the read cells lie.

    Attributes
    ----------
    layer : Layer
    turn : int
        Counter-clockwise quarter turns that take the read patch to the field (`numpy.rot90`).
    pad_from_lattice : (3, 3) float64
        Takes homogeneous lattice coordinates (column, row, 1) of the picture to those of the
        layer.
    evidence : Evidence
    cells : CellGrid
    expected : (R, C) int8
        Levels that the pad has at the read cells; −1 off the pad.
    """

    layer: Layer
    turn: int
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
        self._relative = np.clip(relative_field(layer.field), -_CLIP, _CLIP)
        self._spectra: dict[tuple[int, int], tuple[Spectrum, Spectrum]] = {}

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
        patch = np.clip(cells.relative, -_CLIP, _CLIP)
        rows, cols = self.layer.field.shape
        side = max(patch.shape)
        shape = (cv2.getOptimalDFTSize(rows + side), cv2.getOptimalDFTSize(cols + side))
        best: tuple[float, int, int, int] | None = None
        for turn in range(4):
            score = self._correlate(np.rot90(patch, turn), shape)
            peak = int(np.argmax(score))
            value = float(score.flat[peak])
            if best is None or value > best[0]:
                best = (value, turn, *divmod(peak, shape[1]))
        assert best is not None
        _, turn, row, col = best
        turned = np.rot90(patch, turn).shape
        # A peak in the upper half of the cyclic range stands for a negative shift.
        row = row - shape[0] if row >= rows else row
        col = col - shape[1] if col >= cols else col
        return self._placement(cells, turn, row, col, turned, attempts)

    def _correlate(self, patch: NDArray[np.float32], shape: tuple[int, int]) -> Array:
        """Matched-filter score of a patch at every cyclic shift, (H, W)."""
        field, ones = self._spectrum(shape)
        signal = np.fft.rfft2(patch, shape)
        energy = np.fft.rfft2(patch * patch, shape)
        match = np.fft.irfft2(field * signal.conj(), shape)
        weight = np.fft.irfft2(ones * energy.conj(), shape)
        return np.asarray(match / np.sqrt(np.maximum(weight, _LEAST_OVERLAP)))

    def _spectrum(self, shape: tuple[int, int]) -> tuple[Spectrum, Spectrum]:
        if shape not in self._spectra:
            field = np.fft.rfft2(self._relative, shape)
            ones = np.fft.rfft2(np.ones(self.layer.field.shape, np.float32), shape)
            self._spectra = {shape: (field, ones)}
        return self._spectra[shape]

    def _placement(
        self,
        cells: CellGrid,
        turn: int,
        row: int,
        col: int,
        turned: tuple[int, ...],
        attempts: int,
    ) -> Placement | None:
        expected_turned = crop(self.layer.field, row, col, (turned[0], turned[1]))
        expected = np.ascontiguousarray(np.rot90(expected_turned, -turn))
        places = 4 * (self.layer.rows + turned[0]) * (self.layer.cols + turned[1])
        evidence = judge(
            cells.levels(self.pad.levels), expected, self.pad.levels, places * attempts
        )
        to_pad = _turn_matrix(turn, cells, row, col)
        return Placement(self.layer, turn, to_pad, evidence, cells, expected)


def crop(field: NDArray[np.uint8], row: int, col: int, shape: tuple[int, int]) -> NDArray[np.int8]:
    """A window of a field that may reach beyond it; −1 there."""
    out = np.full(shape, -1, np.int8)
    r0, c0 = max(row, 0), max(col, 0)
    r1, c1 = min(row + shape[0], field.shape[0]), min(col + shape[1], field.shape[1])
    if r0 < r1 and c0 < c1:
        out[r0 - row : r1 - row, c0 - col : c1 - col] = field[r0:r1, c0:c1]
    return out


def _turn_matrix(turn: int, cells: CellGrid, row: int, col: int) -> Array:
    """Lattice coordinates of the picture to those of the layer, homogeneous."""
    rows, cols = cells.values.shape
    shift = np.array([[1.0, 0, -cells.column0], [0, 1.0, -cells.row0], [0, 0, 1]])
    turns = {
        0: [[1.0, 0, 0], [0, 1.0, 0], [0, 0, 1]],
        1: [[0.0, 1, 0], [-1.0, 0, cols], [0, 0, 1]],
        2: [[-1.0, 0, cols], [0, -1.0, rows], [0, 0, 1]],
        3: [[0.0, -1, rows], [1.0, 0, 0], [0, 0, 1]],
    }
    place = np.array([[1.0, 0, col], [0, 1.0, row], [0, 0, 1]])
    return np.asarray(place @ np.array(turns[turn]) @ shift)
