"""What is told of a pad beforehand, and what goes with an imported table; the OpenAPI's source."""

from __future__ import annotations

from typing import Annotated, Literal

from fastapi import Form
from pydantic import BaseModel, ConfigDict, Field

from padstudio.pad.spec import (
    MAX_CELL_MM,
    MAX_CELLS,
    MAX_LEVELS,
    MAX_WINDOW,
    MIN_CELL_MM,
    LayerFields,
)
from padstudio.web.schemas.asked import Text
from padstudio.workers.pads import TableSizes


class PadBounds(BaseModel):
    """Counts of windows, before any search."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "windows_needed": 15082,
                    "log10_possible": 7.53,
                    "log10_allowed": 6.92,
                    "log10_at_most": 5.51,
                    "share": 0.047,
                    "largest_square": 561,
                    "outlook": "easy",
                }
            ]
        }
    )

    windows_needed: int = Field(
        description="Windows that must differ: of all layers, or of red with `layers` paper."
    )
    log10_possible: float | None = Field(description="Windows that exist: Y^(b²).")
    log10_allowed: float | None = Field(description="Those that the uniqueness leaves.")
    log10_at_most: float | None = Field(
        description="How many a field can hold at the distance, at most; null for none."
    )
    share: float | None = Field(description="Needed of at most; null where there are none.")
    largest_square: int = Field(description="Largest side that the count does not rule out.")
    outlook: Literal["easy", "long", "impossible"] = Field(
        description="long: near the bound, the search may not end in its time."
    )


class PadCrosstalk(BaseModel):
    """The mixture of colours by which a pad's frames are un-mixed."""

    matrix: list[list[float]] = Field(
        description="RGB, linear light: camera = matrix @ ink + offset, as shares of white."
    )
    red_separation: float = Field(description="By how much red stands out in its channel.")
    blue_separation: float
    warnings: list[str]


def table_sizes(
    name: Annotated[
        Text | None, Form(max_length=200, description="Instead of the file's own name.")
    ] = None,
    window: Annotated[int, Form(ge=2, le=MAX_WINDOW)] = 5,
    levels: Annotated[
        int | None, Form(ge=2, le=MAX_LEVELS, description="As many as occur where none is given.")
    ] = None,
    cell_mm: Annotated[float, Form(ge=MIN_CELL_MM, le=MAX_CELL_MM)] = 10.0,
    ratio: Annotated[int, Form(ge=1, le=MAX_CELLS, description="Above 1 adds a blue layer.")] = 1,
    quiet_mm: Annotated[float, Form(ge=0, le=10_000)] = 0.0,
    layers: Annotated[
        LayerFields, Form(description="As of a new pad: how a blue layer that is added is made.")
    ] = "independent",
) -> TableSizes:
    """What a table does not say of its pad, from the fields of a form."""
    return TableSizes(name or "", window, levels, cell_mm, ratio, quiet_mm, layers)
