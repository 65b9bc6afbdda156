"""Sizes of cells, layers and pad for a wanted range of heights."""

from __future__ import annotations

import math
from dataclasses import dataclass

from padstudio.errors import SpecError
from padstudio.pad.coverage import ReadLimits, View
from padstudio.pad.spec import MAX_CELLS

# The layers' ranges overlap by this factor of height: a gust across the border costs no pose.
OVERLAP = 1.25


@dataclass(frozen=True)
class Advice:
    """A pad for a range of heights.

    Attributes
    ----------
    cell_mm : float
        Side of a fine cell.
    ratio : int
        Fine cells along a coarse one; 1 is a single layer.
    cells : int
        Fine cells along a side of the pad, a multiple of the ratio.
    low_mm, high_mm : float
        Heights that this pad reads at the tilt asked for.
    notes : tuple of str
        What does not hold, and why; empty where the whole range is reached.
    """

    cell_mm: float
    ratio: int
    cells: int
    low_mm: float
    high_mm: float
    notes: tuple[str, ...]

    @property
    def size_mm(self) -> float:
        """Side of the pad without its quiet margin, mm."""
        return self.cells * self.cell_mm


def advise(
    view: View,
    low_mm: float,
    high_mm: float,
    *,
    window: int = 5,
    levels: int = 2,
    limits: ReadLimits | None = None,
    tilt_deg: float = 0.0,
    reach_mm: float = 0.0,
) -> Advice:
    """Choose cell size, ratio of the layers and pad size.

    Parameters
    ----------
    view : View
    low_mm, high_mm : float
        Heights between which the pad must be read.
    window, levels : int
        Of the pad's code.
    limits : ReadLimits, optional
        Of the method.
    tilt_deg : float
        The largest lean of the camera.
    reach_mm : float
        How far from the pad's centre the camera may be at the lowest height.

    Raises
    ------
    SpecError
        If the heights are no range above 0.
    """
    limits = limits or ReadLimits()
    if not 0 < low_mm < high_mm < math.inf or reach_mm < 0:
        raise SpecError(
            f"heights {low_mm:g} … {high_mm:g} mm and reach {reach_mm:g} mm are no range above 0"
        )
    need = limits.cells_across or float(window)
    # A leaning camera sees more ground, so that the upright one decides below, the leaning above.
    extent = view.extent_per_height(0.0)
    scale = view.cell_px(1.0, 1.0, tilt_deg)
    cell = round_down(low_mm * extent / need)
    fine_high = scale * cell / limits.cell_px
    notes: list[str] = []
    ratio = 1
    if fine_high < high_mm:
        ratio = max(2, math.ceil(high_mm / fine_high))
        most = max(1, math.floor(extent * scale / (limits.cell_px * need) / OVERLAP))
        if ratio > most:
            notes.append(
                f"two layers reach {fine_high * most:.0f} mm, not {high_mm:.0f}: a ratio above "
                f"{most} leaves a dead band between the layers; use a third layer, a longer focal "
                "length for the height or a higher lowest height"
            )
            ratio = most
    cells = _cells(cell, ratio, need, low_mm * extent + 2 * reach_mm)
    room = math.floor(math.sqrt(float(levels) ** min(window * window, 60) / 4)) + window - 1
    if cells > min(room, MAX_CELLS):
        notes.append(
            f"{cells} x {cells} cells do not fit the code of window {window} and {levels} levels "
            f"({min(room, MAX_CELLS)} a side at most under rotation); use a larger window or cells"
        )
        cells = max(ratio, min(room, MAX_CELLS) // ratio * ratio)
    return Advice(cell, ratio, cells, need * cell / extent, fine_high * ratio, tuple(notes))


def round_down(value: float) -> float:
    """The largest number of two digits, whose second is 0 or 5, that is not above a value."""
    step = 10.0 ** math.floor(math.log10(value)) / 2
    return float(f"{math.floor(value / step + 1e-9) * step:.6g}")


def _cells(cell_mm: float, ratio: int, need: float, ground_mm: float) -> int:
    """Fine cells a side: two coarse windows fit, and the lowest view stays on the pad."""
    coarse = max(2 * math.ceil(need), math.ceil(ground_mm / (cell_mm * ratio)))
    return coarse * ratio
