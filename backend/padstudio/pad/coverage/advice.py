"""Sizes of cells, layers and pad for a wanted range of heights."""

from __future__ import annotations

import math
from dataclasses import dataclass

from padstudio.errors import SpecError
from padstudio.pad.coverage.pinhole import View
from padstudio.pad.coverage.spans import (
    ReadLimits,
    cells_needed,
    sign_known_to_mm,
    window_known_to_mm,
)
from padstudio.pad.spec import MAX_CELLS

# The layers' ranges overlap by this factor of height: a gust across the border costs no pose.
OVERLAP = 1.25
# Cells are chosen as for a layer of so many a side; fewer need a little less in the picture.
_MANY = 250
# From what a lens can focus on to a hundred kilometres.
_LEAST_MM, _MOST_MM = 0.1, 1e8


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


@dataclass(frozen=True)
class Envelope:
    """Where a camera flies.

    Attributes
    ----------
    low_mm, high_mm : float
        Heights between which the pad must be read.
    tilt_deg : float
        The largest lean of the camera.
    reach_mm : float
        How far from the pad's centre the camera may be at the lowest height.

    Raises
    ------
    SpecError
        If the heights are no range above 0.
    """

    low_mm: float
    high_mm: float
    tilt_deg: float = 0.0
    reach_mm: float = 0.0

    def __post_init__(self) -> None:
        in_range = _LEAST_MM <= self.low_mm < self.high_mm <= _MOST_MM
        if not (in_range and 0 <= self.reach_mm <= _MOST_MM):
            raise SpecError(
                f"heights {self.low_mm:g} … {self.high_mm:g} mm and reach {self.reach_mm:g} mm "
                f"are no range above 0, within {_LEAST_MM:g} … {_MOST_MM:g} mm"
            )


def advise(
    view: View,
    envelope: Envelope,
    *,
    window: int = 5,
    levels: int = 2,
    limits: ReadLimits | None = None,
) -> Advice:
    """Choose cell size, ratio of the layers and pad size.

    Parameters
    ----------
    view : View
    envelope : Envelope
    window, levels : int
        Of the pad's code.
    limits : ReadLimits, optional
        Of the method.
    """
    limits = limits or ReadLimits()
    wish = _Wish(view, envelope.high_mm, window, limits, (0.0, envelope.tilt_deg))
    need = cells_needed(window, levels, (_MANY, _MANY), view, limits)
    # A leaning camera sees more ground, so that the upright one decides below.
    extent = view.extent_per_height(0.0)
    seen_mm = envelope.low_mm * extent
    cell = round_down(seen_mm / need)
    lowest = need * cell / extent
    ratio, notes = wish.ratio(cell, math.floor(wish.layer_reach_mm(cell) / lowest / OVERLAP))
    least_mm = seen_mm + 2 * envelope.reach_mm
    coarse = max(2 * math.ceil(need), math.ceil(least_mm / (cell * ratio)))
    cells = wish.enough(cell, ratio, coarse) * ratio
    room = _room(window, levels)
    if cells > room:
        notes.append(
            f"{cells} x {cells} cells do not fit the code of window {window} and {levels} levels "
            f"({room} a side at most under rotation); use a larger window or cells"
        )
        cells = max(ratio, room // ratio * ratio)
    lowest = cells_needed(window, levels, (cells, cells), view, limits) * cell / extent
    highest = min(wish.layer_reach_mm(cell * ratio), wish.sign_reach_mm(cell, ratio, cells))
    return Advice(cell, ratio, cells, lowest, highest, tuple(notes))


def _room(window: int, levels: int) -> int:
    """Most cells a side whose windows can all differ, in all four turns."""
    most = math.floor(math.sqrt(float(levels) ** min(window * window, 60) / 4)) + window - 1
    return min(most, MAX_CELLS)


@dataclass(frozen=True)
class _Wish:
    """A height that must be read, and what of a pad reads how far up at all of some tilts."""

    view: View
    high_mm: float
    window: int
    limits: ReadLimits
    tilts_deg: tuple[float, ...]

    def layer_reach_mm(self, cell_mm: float) -> float:
        """Height up to which a layer's cells are read and its windows tell the pose."""
        view, limits = self.view, self.limits
        side_mm = self.window * cell_mm
        return min(
            min(
                view.cell_px(cell_mm, 1.0, tilt) / limits.cell_px,
                window_known_to_mm(side_mm, view, limits, tilt),
            )
            for tilt in self.tilts_deg
        )

    def sign_reach_mm(self, cell_mm: float, ratio: int, cells: int) -> float:
        """Height up to which a pad of so many fine cells a side tells the pose."""
        side_mm, sizes = cells * cell_mm, sorted({cell_mm, cell_mm * ratio})
        return min(
            sign_known_to_mm(side_mm, sizes, self.view, self.limits, tilt)
            for tilt in self.tilts_deg
        )

    def ratio(self, cell_mm: float, most: int) -> tuple[int, list[str]]:
        """The least ratio that reads the height, at most ``most``; a note where that is too low."""
        ratio = max(1, math.ceil(self.high_mm / self.layer_reach_mm(cell_mm) * (1 - 1e-9)))
        while ratio <= most and self.layer_reach_mm(cell_mm * ratio) < self.high_mm * (1 - 1e-9):
            ratio += 1
        if ratio <= max(1, most):
            return ratio, []
        most = max(1, most)
        reached = self.layer_reach_mm(cell_mm * most)
        note = (
            f"two layers reach {reached:.0f} mm, not {self.high_mm:.0f}: a ratio above {most} "
            "leaves a dead band between the layers; use a third layer, a longer focal length for "
            "the height or a higher lowest height"
        )
        return most, [note]

    def enough(self, cell_mm: float, ratio: int, least: int) -> int:
        """Coarse cells a side, from which the pad tells the pose at the height; ``least`` or more.

        Where the cells themselves do not reach the height, as high up as they do.
        """
        wanted = min(self.high_mm, self.layer_reach_mm(cell_mm * ratio)) * (1 - 1e-3)

        def tells(coarse: int) -> bool:
            return self.sign_reach_mm(cell_mm, ratio, coarse * ratio) >= wanted

        low, high = least - 1, least
        while not tells(high):
            low, high = high, 2 * high
        while high - low > 1 and low >= least:
            middle = (low + high) // 2
            low, high = (low, middle) if tells(middle) else (middle, high)
        return high


def round_down(value: float) -> float:
    """The largest number of two digits, whose second is 0 or 5, that is not above a value."""
    step = 10.0 ** math.floor(math.log10(value)) / 2
    return float(f"{math.floor(value / step + 1e-9) * step:.6g}")
