"""The spec of a pad: its red layer's field, and what goes with it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import get_args

import numpy as np

from padstudio.errors import SpecError, shown
from padstudio.pad.coding.search.spec import FieldSpec
from padstudio.pad.spec import MAX_CELLS, LayerFields

#: What layers that share a code cost, for whoever chooses.
PAPER_COST = (
    "whatever shows the fine pattern in the blue channel, or the coarse one in the red, reads as "
    "another height, and the other channel alone tells which is right"
)


@dataclass(frozen=True, kw_only=True)
class PadSpec(FieldSpec):
    """A pad to be generated: its red layer's field, and what else the pad holds.

    Attributes
    ----------
    name : str
    ratio : int
        How many red cells a blue cell is wide; the blue layer has rows/ratio × cols/ratio cells.
        1 makes a pad of the red layer alone.
    cell_mm, quiet_mm : float
        Side of a red cell and width of the white margin, mm.
    layers : {"independent", "paper"}
        "independent": windows of the two layers differ as those of one do, and in every turn.
        "paper": the blue field is the upper left part of the red one, the source paper's
        construction; exchanged or mixed channels may then read as another height.

    Raises
    ------
    SpecError
        As `FieldSpec`, and where the ratio leaves the blue layer less than one window.
    """

    name: str = "pad"
    ratio: int = 5
    cell_mm: float = 10.0
    quiet_mm: float = 0.0
    layers: LayerFields = "independent"

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.layers not in get_args(LayerFields):
            raise SpecError(
                f"layers is {shown(self.layers)}; it must be independent or paper",
                detail={"field": "layers"},
            )
        _check_ratio(self)

    @property
    def has_two_fields(self) -> bool:
        """Whether the blue layer has a field of its own."""
        return self.ratio > 1 and self.layers == "independent"

    def windows_needed(self, rows: int, cols: int) -> int:
        """How many windows must differ, were the red field of so many rows and columns."""
        needed = super().windows_needed(rows, cols)
        if self.has_two_fields:
            needed += super().windows_needed(rows // self.ratio, cols // self.ratio)
        return needed

    @property
    def cells_in_words(self) -> str:
        """The cells of all fields that the spec asks for, for messages."""
        if not self.has_two_fields:
            return super().cells_in_words
        blue = self.blue_field()
        return f"layers of {self.rows} x {self.cols} and {blue.cells_in_words}"

    @property
    def last_resort(self) -> str:
        """What does where only one field finds room, as the end of a sentence; else nothing."""
        if not self.has_two_fields:
            return ""
        return f'; or layers that share a code, layers="paper": {PAPER_COST}'

    def blue_field(self) -> FieldSpec:
        """The blue layer's field, of a random stream of its own."""
        entropy = np.random.SeedSequence([self.seed, self.ratio])
        return FieldSpec(
            rows=self.rows // self.ratio,
            cols=self.cols // self.ratio,
            window=self.window,
            levels=self.levels,
            unique=self.unique,
            distance=self.distance,
            visible_lines=self.visible_lines,
            method=self.method,
            seed=int(entropy.generate_state(1, np.uint64)[0] >> np.uint64(1)),
        )


def _check_ratio(spec: PadSpec) -> None:
    """Raise SpecError where a pad cannot have a red layer of a spec and a blue one of its ratio."""
    side, window, ratio = min(spec.rows, spec.cols), spec.window, spec.ratio
    if not 1 <= ratio <= side:
        raise SpecError(
            f"ratio is {ratio}; it must be 1 (red layer only) … {side} cells",
            detail={"field": "ratio"},
        )
    if ratio > 1 and side // ratio < window:
        raise SpecError(
            f"a ratio of {ratio} leaves a blue layer of {spec.rows // ratio} x "
            f"{spec.cols // ratio} cells, less than one {window} x {window} window: take a ratio "
            f"of at most {side // window}, or 1 for the red layer only",
            detail={"field": "ratio"},
        )
    if max(spec.rows, spec.cols) > MAX_CELLS:
        raise SpecError(
            f"{spec.rows} x {spec.cols} cells; a pad has at most {MAX_CELLS} a side",
            detail={"field": "rows" if spec.rows > MAX_CELLS else "cols"},
        )
