"""How a pad is spread over sheets: pure data, which painters paint and the page previews.

Lengths are mm. *Page* coordinates are those of `padstudio.pad.layout`: origin at the top left of
the pad's quiet margin, y down. *Sheet* coordinates have their origin at the sheet's top left.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal, get_args

from padstudio.errors import LimitError, SpecError, shown
from padstudio.pad.sheets.paper import (
    NO_BANDS,
    Bands,
    Box,
    Paper,
    parse_paper,
    usable_box,
)
from padstudio.pad.sheets.seams import find_seams
from padstudio.pad.spec import Pad

Orientation = Literal["auto", "portrait", "landscape"]
Joint = Literal["butt", "overlap"]
Seams = Literal["cells", "anywhere"]

# More sheets than anybody lays out; bounds the size of the document.
MAX_SHEETS = 2000


@dataclass(frozen=True, kw_only=True)
class SheetOptions:
    """How to spread a pad over sheets.

    Attributes
    ----------
    paper : str
        A paper's name, ``WIDTHxHEIGHT`` in mm, or ``own``: one sheet that fits the pad.
    orientation : {"auto", "portrait", "landscape"}
        ``auto`` takes whichever needs fewer sheets.
    margin_mm : float
        What the printer leaves blank on every side.
    joint : {"butt", "overlap"}
        Sheets are cut at the seams and laid edge to edge, or lie over each other.
    overlap_mm : float
        How far a sheet's print goes on under the next one, for overlap joints.
    seams : {"cells", "anywhere"}
        ``cells`` puts seams on cell edges, unless a cell is larger than a sheet.
    furniture : bool
        Rulers, labels and cut marks, in bands beside the pad.
    """

    paper: str = "A4"
    orientation: Orientation = "auto"
    margin_mm: float = 5.0
    joint: Joint = "butt"
    overlap_mm: float = 10.0
    seams: Seams = "cells"
    furniture: bool = True

    def __post_init__(self) -> None:
        for name, kind in (("orientation", Orientation), ("joint", Joint), ("seams", Seams)):
            if getattr(self, name) not in get_args(kind):
                raise SpecError(
                    f"{name} is {shown(getattr(self, name))}; use {', '.join(get_args(kind))}"
                )
        if not (math.isfinite(self.overlap_mm) and 0 < self.overlap_mm <= 1000):
            raise SpecError(f"overlap_mm is {self.overlap_mm}; give more than 0, at most 1000 mm")

    @classmethod
    def bare(cls) -> SheetOptions:
        """One page of the pad's own size, with nothing beside the pad."""
        return cls(paper="own", margin_mm=0.0, furniture=False)

    @property
    def bands(self) -> Bands:
        """What furniture takes of each side."""
        return Bands() if self.furniture else NO_BANDS


@dataclass(frozen=True)
class Sheet:
    """One sheet of a plan.

    Attributes
    ----------
    row, col : int
        Place in the assembly, from its top left.
    name : str
        Row letter and column number, such as ``B3``.
    core : Box
        The sheet's own part of the page: cut and joined along its sides; page coordinates.
    painted : Box
        What is printed: the core and what goes on under the next sheets; page coordinates.
    x_mm, y_mm : float
        The core's top left, sheet coordinates.
    """

    row: int
    col: int
    name: str
    core: Box
    painted: Box
    x_mm: float
    y_mm: float


@dataclass(frozen=True)
class SheetPlan:
    """A pad spread over sheets.

    Attributes
    ----------
    options : SheetOptions
    paper : Paper
        As it lies in the printer, turned where that fits better.
    page_width_mm, page_height_mm : float
        The pad with its quiet margin.
    x_seams_mm, y_seams_mm : tuple of float
        Seams across x and y, page coordinates; the page's own sides are not among them.
    on_cells : bool
        Whether no seam cuts a cell of the finest layer.
    sheets : tuple of Sheet
        Row by row.
    """

    options: SheetOptions
    paper: Paper
    page_width_mm: float
    page_height_mm: float
    x_seams_mm: tuple[float, ...]
    y_seams_mm: tuple[float, ...]
    on_cells: bool
    sheets: tuple[Sheet, ...]

    @property
    def rows(self) -> int:
        """Rows of sheets."""
        return len(self.y_seams_mm) + 1

    @property
    def cols(self) -> int:
        """Columns of sheets."""
        return len(self.x_seams_mm) + 1

    @property
    def paper_m2(self) -> float:
        """Area of all sheets, m²."""
        return len(self.sheets) * self.paper.width_mm * self.paper.height_mm / 1e6

    def to_dict(self) -> dict[str, Any]:
        """The plan as JSON-serialisable data, for previews."""
        return {
            "paper": self.paper.name,
            "orientation": self.paper.orientation,
            "paper_mm": [self.paper.width_mm, self.paper.height_mm],
            "page_mm": [self.page_width_mm, self.page_height_mm],
            "rows": self.rows,
            "cols": self.cols,
            "count": len(self.sheets),
            "paper_m2": round(self.paper_m2, 4),
            "joint": self.options.joint,
            "on_cells": self.on_cells,
            "x_seams_mm": list(self.x_seams_mm),
            "y_seams_mm": list(self.y_seams_mm),
            "sheets": [
                {
                    "name": sheet.name,
                    "row": sheet.row,
                    "col": sheet.col,
                    "core_mm": [sheet.core.x0, sheet.core.y0, sheet.core.x1, sheet.core.y1],
                    "at_mm": [sheet.x_mm, sheet.y_mm],
                }
                for sheet in self.sheets
            ],
        }


def plan_sheets(pad: Pad, options: SheetOptions | None = None) -> SheetPlan:
    """Spread a pad over sheets.

    Seams take the fewest sheets and spread evenly; they lie on edges of the coarsest layer's cells
    where that needs no more sheets than the finest layer's.

    Raises
    ------
    SpecError
        If the paper is unknown, or too small for its margins.
    LimitError
        If more than `MAX_SHEETS` sheets were needed.
    """
    options = options or SheetOptions()
    page = (pad.width_mm + 2 * pad.quiet_mm, pad.height_mm + 2 * pad.quiet_mm)
    if options.paper.strip().lower() == "own":
        return _arrange(pad, page, _own_paper(page, options), options)
    paper = parse_paper(options.paper)
    papers = [paper, paper.turned()]
    if options.orientation != "auto":
        papers = [paper for paper in papers if paper.orientation == options.orientation]
    plans = [_arrange(pad, page, paper, options) for paper in papers]
    return min(plans, key=lambda plan: len(plan.sheets))


def sheet_name(row: int, col: int) -> str:
    """Row letter and column number of a sheet, as in spreadsheets: A1 … Z9, AA1 …"""
    letters = ""
    number = row + 1
    while number:
        number, digit = divmod(number - 1, 26)
        letters = chr(ord("A") + digit) + letters
    return f"{letters}{col + 1}"


def _own_paper(page: tuple[float, float], options: SheetOptions) -> Paper:
    """A sheet that fits the page, its bands and the printer's margins."""
    bands, margin = options.bands, 2 * options.margin_mm
    # Room for a 200 mm ruler, where there are rulers.
    least = 200.0 + margin if options.furniture else 0.0
    width = max(page[0] + bands.left + bands.right + margin, least)
    height = max(page[1] + bands.top + bands.bottom + margin, least)
    return Paper("own size", width, height)


def _arrange(pad: Pad, page: tuple[float, float], paper: Paper, options: SheetOptions) -> SheetPlan:
    box = usable_box(paper, options.margin_mm, options.bands)
    under = options.overlap_mm if options.joint == "overlap" else 0.0
    (x, x_on_cells), (y, y_on_cells) = (
        find_seams(
            length,
            usable,
            under_mm=under,
            quiet_mm=pad.quiet_mm,
            cells_mm=[layer.cell_mm for layer in pad.layers],
            on_cells=options.seams == "cells",
        )
        for length, usable in (
            (page[0], box.width),
            (page[1], box.height),
        )
    )
    count = (len(x) + 1) * (len(y) + 1)
    if count > MAX_SHEETS:
        raise LimitError(
            f"the pad would take {count} sheets of {paper.name}; the limit is {MAX_SHEETS}: take a "
            "larger paper, or one page of the pad's own size"
        )
    columns = [0.0, *x, page[0]]
    lines = [0.0, *y, page[1]]
    return SheetPlan(
        options=options,
        paper=paper,
        page_width_mm=page[0],
        page_height_mm=page[1],
        x_seams_mm=tuple(x),
        y_seams_mm=tuple(y),
        on_cells=x_on_cells and y_on_cells,
        sheets=tuple(
            _sheet(row, col, columns, lines, under, box)
            for row in range(len(y) + 1)
            for col in range(len(x) + 1)
        ),
    )


def _sheet(
    row: int, col: int, columns: list[float], lines: list[float], under: float, box: Box
) -> Sheet:
    core = Box(columns[col], lines[row], columns[col + 1], lines[row + 1])
    painted = Box(
        core.x0, core.y0, min(core.x1 + under, columns[-1]), min(core.y1 + under, lines[-1])
    )
    # All cores start at one place, so that a stack of sheets is cut in one go.
    return Sheet(row, col, sheet_name(row, col), core, painted, box.x0, box.y0)
