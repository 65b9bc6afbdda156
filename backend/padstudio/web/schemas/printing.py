"""What requests and answers about prints look like; also the OpenAPI file's source."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from padstudio.errors import PadFormatError, SpecError
from padstudio.pad.print_scale import print_scale
from padstudio.pad.sheets.tiling import Joint, Orientation, Seams, SheetOptions
from padstudio.pad.spec import (
    MAX_CELL_MM,
    MAX_CELLS,
    MAX_LEVELS,
    MAX_WINDOW,
    MIN_CELL_MM,
    Channel,
    Layer,
    Pad,
)
from padstudio.render.painters.inks import Ink
from padstudio.render.painters.options import PrintOptions
from padstudio.web.schemas.asked import Asked, Flag, InAddress
from padstudio.web.schemas.pads import PadCrosstalk

RULER_MM = 200.0
_FURNITURE = "Rulers, labels and cut marks; by default on all papers but own."
_SHAPE_EXAMPLE: dict[str, Any] = {
    "window": 5,
    "levels": 2,
    "quiet_mm": 20.0,
    "layers": [
        {"channel": "red", "rows": 125, "cols": 125, "cell_mm": 10.0},
        {"channel": "blue", "rows": 25, "cols": 25, "cell_mm": 50.0},
    ],
}
_PLAN_EXAMPLE: dict[str, Any] = {
    "paper": "A4",
    "orientation": "portrait",
    "paper_mm": [210.0, 297.0],
    "page_mm": [180.0, 300.0],
    "rows": 2,
    "cols": 1,
    "count": 2,
    "paper_m2": 0.1247,
    "joint": "butt",
    "on_cells": True,
    "x_seams_mm": [],
    "y_seams_mm": [150.0],
    "sheets": [
        {"name": "A1", "row": 0, "col": 0, "core_mm": [0, 0, 180, 150], "at_mm": [17, 15]},
        {"name": "B1", "row": 1, "col": 0, "core_mm": [0, 150, 180, 300], "at_mm": [17, 15]},
    ],
}


def _example(value: dict[str, Any]) -> ConfigDict:
    return ConfigDict(json_schema_extra={"examples": [value]})


class SheetQuery(InAddress):
    """How a pad is spread over sheets."""

    paper: str = Field(
        "own",
        max_length=40,
        description="A4 … A0, Letter, Legal, Tabloid, WIDTHxHEIGHT in mm, or own: one page.",
        examples=["A4"],
    )
    orientation: Orientation = Field("auto", description="auto takes what needs fewer sheets.")
    margin_mm: float | None = Field(
        None,
        ge=0,
        le=1000,
        description="What the printer leaves blank; 5 on sheets, 0 on a bare page of its own size.",
    )
    joint: Joint = Field("butt", description="Sheets edge to edge, or over each other.")
    overlap_mm: float = Field(10.0, ge=0.1, le=1000, description="Strip under the next sheet.")
    seams: Seams = Field("cells", description="cells: never cut a cell needlessly.")
    furniture: Flag | None = Field(None, description=_FURNITURE)

    def sheet_options(self) -> SheetOptions:
        """For the planner; raises `SpecError` where a value is wrong."""
        own = self.paper.strip().lower() == "own"
        furniture = not own if self.furniture is None else self.furniture
        margin_mm = self.margin_mm
        if margin_mm is None:
            margin_mm = 5.0 if furniture else 0.0
        return SheetOptions(
            paper=self.paper,
            orientation=self.orientation,
            margin_mm=margin_mm,
            joint=self.joint,
            overlap_mm=self.overlap_mm,
            seams=self.seams,
            furniture=furniture,
        )


class PrintQuery(SheetQuery):
    """How a pad is painted; each form takes what concerns it."""

    ink: Ink = Field("rgb", description="How a PDF gives colours.")
    outline_mm: float = Field(0.0, ge=0, le=100, description="Line round the quiet margin.")
    header: str = Field("", max_length=200, description="Text in the upper quiet margin.")
    footer: str = Field("", max_length=200, description="Text in the lower quiet margin.")
    qr: Flag = Field(True, description="The pad's id and QR code.")
    assembly_map: Flag = Field(True, description="Begin with a map of the sheets.")
    dpi: float = Field(150.0, ge=1, le=2400, description="Of a PNG.")
    channel: Channel | None = Field(
        None, description="Layer of a CSV or NPY; a zip of all layers where none is named."
    )
    read_x_mm: float = Field(
        RULER_MM,
        ge=1,
        le=1000,
        description="What an earlier print's ruler of 200 mm along x reads.",
    )
    read_y_mm: float = Field(RULER_MM, ge=1, le=1000, description="The same along y.")

    def print_options(self) -> PrintOptions:
        """For the painters; raises `SpecError` where a value is wrong."""
        return PrintOptions(
            sheets=self.sheet_options(),
            dpi=self.dpi,
            ink=self.ink,
            outline_mm=self.outline_mm,
            header=self.header,
            footer=self.footer,
            qr=self.qr,
            assembly_map=self.assembly_map,
            measured=(
                print_scale(RULER_MM, self.read_x_mm),
                print_scale(RULER_MM, self.read_y_mm),
            ),
        )


class LayerShape(Asked):
    """A layer's cells, without their levels."""

    channel: Channel
    rows: int = Field(ge=2, le=MAX_CELLS)
    cols: int = Field(ge=2, le=MAX_CELLS)
    cell_mm: float = Field(ge=MIN_CELL_MM, le=MAX_CELL_MM)


class PadShape(Asked):
    """The sizes of a pad, stored or not: all that sheets and coverage depend on."""

    model_config = _example(_SHAPE_EXAMPLE)

    window: int = Field(5, ge=2, le=MAX_WINDOW)
    levels: int = Field(2, ge=2, le=MAX_LEVELS)
    quiet_mm: float = Field(0.0, ge=0, le=10_000)
    layers: list[LayerShape] = Field(min_length=1, max_length=3)

    def blank_pad(self) -> Pad:
        """A pad of these sizes whose cells are all dark.

        Raises
        ------
        SpecError
            If no such pad can be.
        """
        try:
            return Pad(
                layers=tuple(
                    Layer(la.channel, la.cell_mm, np.zeros((la.rows, la.cols), np.uint8))
                    for la in self.layers
                ),
                window=self.window,
                levels=self.levels,
                quiet_mm=self.quiet_mm,
            )
        except PadFormatError as error:
            raise SpecError(error.message) from error


class SheetChoice(Asked, SheetQuery):
    """The same in JSON."""

    furniture: bool | None = Field(None, description=_FURNITURE)


class SheetsRequest(Asked):
    """A pad's sizes and how to spread it."""

    model_config = _example({"pad": _SHAPE_EXAMPLE, "options": {"paper": "A4"}})

    pad: PadShape
    options: SheetChoice = Field(default_factory=SheetChoice.model_construct)


class SheetInfo(BaseModel):
    name: str = Field(description="Row letter and column number.")
    row: int
    col: int
    core_mm: tuple[float, float, float, float] = Field(
        description="The sheet's part of the page: left, top, right, bottom."
    )
    at_mm: tuple[float, float] = Field(description="Where that part begins on the sheet.")


class SheetPlanInfo(BaseModel):
    """A pad spread over sheets; lengths on the page from its top left, y down."""

    model_config = ConfigDict(json_schema_extra={"examples": [_PLAN_EXAMPLE]})

    paper: str
    orientation: Literal["portrait", "landscape"]
    paper_mm: tuple[float, float]
    page_mm: tuple[float, float] = Field(description="The pad with its quiet margin.")
    rows: int
    cols: int
    count: int
    paper_m2: float
    joint: Joint
    on_cells: bool = Field(description="No seam cuts a cell of the finest layer.")
    x_seams_mm: list[float]
    y_seams_mm: list[float]
    sheets: list[SheetInfo]


class MeasuredSize(Asked):
    """What a true ruler says of a print's rulers."""

    model_config = _example({"x_mm": 199.2, "y_mm": 200.4, "ruler_mm": 200.0})

    x_mm: float = Field(ge=1, le=10_000)
    y_mm: float = Field(ge=1, le=10_000)
    ruler_mm: float = Field(RULER_MM, ge=1, le=10_000, description="What the rulers should be.")


class CrosstalkInfo(PadCrosstalk):
    """What a photo of the test strip says of one printer and one camera."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "matrix": [[0.71, 0.05, 0.02], [0.06, 0.62, 0.04], [0.05, 0.11, 0.58]],
                    "offset": [0.03, 0.03, 0.04],
                    "residual": 0.02,
                    "red_separation": 0.55,
                    "blue_separation": 0.41,
                    "warnings": [],
                    "kept": True,
                }
            ]
        }
    )

    offset: list[float]
    residual: float
    kept: bool = Field(description="Frames of this pad are un-mixed by it from now on.")
