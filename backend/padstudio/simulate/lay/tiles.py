"""Prints of many sheets that are not laid exactly, and other prints beside them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from padstudio.arrays import Array
from padstudio.errors import SpecError


@dataclass(frozen=True, kw_only=True)
class Tiles:
    """A print of many sheets of equal size, laid side by side by hand.

    Attributes
    ----------
    columns, rows : int
        1 … 40 each.
    gap_mm : float
        Between neighbours, on the whole; below 0 they overlap.
    offset_mm : float
        Each sheet lies up to so much off its place, in x and in y.
    turn_deg : float
        Each sheet is turned by up to so much.
    swaps : int
        So many pairs of sheets are exchanged.
    seed : int
    """

    columns: int
    rows: int
    gap_mm: float = 0.0
    offset_mm: float = 0.0
    turn_deg: float = 0.0
    swaps: int = 0
    seed: int = 0

    def __post_init__(self) -> None:
        for name, low, high in _TILE_RANGES:
            value = getattr(self, name)
            if not low <= value <= high:
                raise SpecError(f"{name} is {value}; it must lie within {low} … {high}")
        if 2 * self.swaps > self.columns * self.rows:
            raise SpecError(
                f"{self.swaps} pairs of sheets are to be exchanged, of {self.columns * self.rows} "
                "sheets; give fewer"
            )

    def placed(self, half_x: float, half_y: float) -> Array:
        """Where the sheets of a print with these half sides lie.

        Returns
        -------
        (N, 8) float64
            Centre, cosine and sine of the turn, half sides, centre on the whole print; mm.
        """
        rng = np.random.default_rng([self.seed, *b"tiles"])
        side_x, side_y = half_x / self.columns, half_y / self.rows
        column, row = np.meshgrid(np.arange(self.columns), np.arange(self.rows))
        across = (column - (self.columns - 1) / 2).ravel()
        up = (row - (self.rows - 1) / 2).ravel()
        count = len(across)
        offset = rng.uniform(-self.offset_mm, self.offset_mm, (count, 2))
        turn = np.radians(rng.uniform(-self.turn_deg, self.turn_deg, count))
        shown = np.arange(count)
        pairs = rng.permutation(count)[: 2 * self.swaps].reshape(-1, 2)
        shown[pairs] = pairs[:, ::-1]
        return np.stack(
            [
                across * (2 * side_x + self.gap_mm) + offset[:, 0],
                up * (2 * side_y + self.gap_mm) + offset[:, 1],
                np.cos(turn),
                np.sin(turn),
                np.full(count, side_x),
                np.full(count, side_y),
                across[shown] * 2 * side_x,
                up[shown] * 2 * side_y,
            ],
            axis=1,
        )


_TILE_RANGES = (
    ("columns", 1, 40),
    ("rows", 1, 40),
    ("gap_mm", -20.0, 100.0),
    ("offset_mm", 0.0, 50.0),
    ("turn_deg", 0.0, 10.0),
    ("swaps", 0, 800),
)
