"""Changes that a team can make, and the cases that tell what each would do."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from padstudio.experiments.budget.conditions import (
    QUANTITIES,
    SOURCES,
    Conditions,
    SourceName,
)
from padstudio.experiments.budget.order import (
    BudgetOrder,
    Case,
    floor_case,
    source_case,
    whole_case,
)
from padstudio.pad.spec import MAX_CELL_MM

_PIXELS = 1.5
# A steel rule laid along 400 mm reads to 0.2 mm.
_MEASURED_PERCENT = 0.05
# Of the sizes that a calibration has now: a new one of three times as many pictures that fill the
# frame's corners (docs/calibration.md, 3 against 30 pictures).
_RECALIBRATED = 1 / 3
_FLATTER = 0.2


@dataclass(frozen=True)
class Change:
    """A change that can be made.

    Attributes
    ----------
    title : str
        As an advice.
    source : SourceName
        What it lessens.
    sizes : mapping
        New sizes, as multiples of those there are.
    most : mapping
        New sizes, which are no change where they are as small already.
    sharper, larger : float
        As of `Case`.
    """

    title: str
    source: SourceName
    sizes: Mapping[str, float] = field(default_factory=dict)
    most: Mapping[str, float] = field(default_factory=dict)
    sharper: float = 1.0
    larger: float = 1.0

    @property
    def is_global(self) -> bool:
        """Whether the shutter does not roll any more, which the detector is told."""
        return self.sizes.get("readout_ms") == 0

    def made(self, conditions: Conditions) -> Conditions:
        """The conditions after the change."""
        sizes = {
            name: min(getattr(conditions, name) * by, QUANTITIES[name].high)
            for name, by in self.sizes.items()
        }
        sizes |= {name: min(getattr(conditions, name), size) for name, size in self.most.items()}
        return replace(conditions, **sizes)

    def is_possible(self, order: BudgetOrder) -> bool:
        """Whether it changes anything, within the limits of what there may be."""
        if self.larger != 1:
            return max(x.cell_mm for x in order.pad.layers) * self.larger <= MAX_CELL_MM
        return self.sharper != 1 or self.made(order.conditions) != order.conditions

    def cases(self, conditions: Conditions) -> dict[SourceName, Case]:
        """What has to be simulated anew, by the source whose amount it replaces."""
        after = self.made(conditions)
        if self.is_global:
            # A detector that knows it looks for no motion of rows, whatever else is wrong.
            told = {source: source_case(after, source) for source in SOURCES}
            return {name: replace(case, is_told_global=True) for name, case in told.items()}
        if self.source == "pixels":
            floor = floor_case(after)
            return {"pixels": replace(floor, sharper=self.sharper, larger=self.larger)}
        return {self.source: source_case(after, self.source)}

    def whole(self, conditions: Conditions) -> Case:
        """All sources together, after the change."""
        return replace(
            whole_case(self.made(conditions)),
            sharper=self.sharper,
            larger=self.larger,
            is_told_global=self.is_global,
        )


CHANGES: dict[str, Change] = {
    "global_shutter": Change(
        "a camera with a global shutter, said in its file (readout_ms 0)",
        "rolling_shutter",
        sizes={"readout_ms": 0.0},
    ),
    "half_readout": Change(
        "a camera that reads out in half the time", "rolling_shutter", sizes={"readout_ms": 0.5}
    ),
    "half_exposure": Change(
        "half the exposure time at the same brightness", "blur", sizes={"exposure_ms": 0.5}
    ),
    "measured_print": Change(
        f"measuring the print with a steel rule (to {_MEASURED_PERCENT:g} %: padstudio measure)",
        "print_scale",
        most={"scale_percent": _MEASURED_PERCENT},
    ),
    "flat_substrate": Change(
        "gluing the print on a stiff board (a fifth of its waves)",
        "flatness",
        sizes={"waves_mm": _FLATTER},
    ),
    "recalibration": Change(
        "a new calibration of the lens, three times as sure",
        "calibration",
        sizes={
            "focal_percent": _RECALIBRATED,
            "principal_px": _RECALIBRATED,
            "distortion_px": _RECALIBRATED,
        },
    ),
    "twice_the_bit_rate": Change(
        "twice the stream's bit rate", "compression", sizes={"mbit_s": 2.0}
    ),
    "higher_resolution": Change(
        f"a sensor of {_PIXELS:g} times as many pixels a side", "pixels", sharper=_PIXELS
    ),
    "larger_cells": Change(
        f"cells of {_PIXELS:g} times the side, and so a larger pad", "pixels", larger=_PIXELS
    ),
}
