"""Sheets for the simulator: a board's pattern in the middle of a white page of the pad's size."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from padstudio.pad.layout import Layout
from padstudio.pad.spec import Pad

#: Along the longer side of the page: markers of the ArUco board, squares of the ChArUco board.
PLACES = 25
#: Nested markers go on as long as their modules are printed at least so large.
LEAST_MODULE_MM = 1.0


@dataclass(frozen=True)
class Page:
    """The printed size that all boards of a shoot-out have, mm."""

    width_mm: float
    height_mm: float

    @property
    def side_mm(self) -> float:
        """Of the largest square that is printed on it."""
        return min(self.width_mm, self.height_mm)

    def places(self, along: int) -> tuple[int, int, float]:
        """Columns, rows and side in mm of square places, so many along the longer side."""
        side = max(self.width_mm, self.height_mm) / along
        columns, rows = (
            max(1, int(length / side + 1e-6)) for length in (self.width_mm, self.height_mm)
        )
        return columns, rows, side


def page_of(pad: Pad) -> Page:
    """The pad as it is printed, its quiet margin included, at its measured size."""
    width_mm, height_mm = pad.size_mm
    return Page(width_mm + 2 * pad.quiet_mm, height_mm + 2 * pad.quiet_mm)


def centred(grey: NDArray[np.uint8], width_mm: float, page: Page) -> Layout:
    """A pattern of square patches in the middle of the page, white round it.

    Parameters
    ----------
    grey : (R, C) uint8
        A value a patch.
    width_mm : float
        Of all columns together.
    page : Page

    Returns
    -------
    Layout
    """
    patch = width_mm / grey.shape[1]
    x_mm, columns = _edges(grey.shape[1], patch, page.width_mm)
    y_mm, rows = _edges(grey.shape[0], patch, page.height_mm)
    framed = np.full((len(y_mm) - 1, len(x_mm) - 1), 255, np.uint8)
    framed[rows, columns] = grey
    colors = np.repeat(framed[:, :, None], 3, axis=2)
    return Layout(page.width_mm, page.height_mm, x_mm, y_mm, colors)


def _edges(count: int, patch_mm: float, length_mm: float) -> tuple[NDArray[np.float64], slice]:
    """Edges of the patches with a margin on both sides, if there is any, and the patches' place."""
    margin = (length_mm - count * patch_mm) / 2
    inner = margin + patch_mm * np.arange(count + 1.0)
    if margin < 1e-6 * length_mm:
        inner[0], inner[-1] = 0.0, length_mm
        return inner, slice(0, count)
    return np.concatenate([[0.0], inner, [length_mm]]), slice(1, count + 1)


def square_mm(side_mm: float) -> NDArray[np.float64]:
    """(4, 2) corners of a square about the origin, top left first, clockwise on the page, mm."""
    return np.array([[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]]) * side_mm / 2
