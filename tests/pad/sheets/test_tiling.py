from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from measure_print import make_pad

from padstudio.errors import LimitError, SpecError
from padstudio.pad.sheets.paper import PAPERS_MM
from padstudio.pad.sheets.tiling import SheetOptions, plan_sheets, sheet_name


@given(
    rows=st.integers(15, 60),
    cols=st.integers(15, 60),
    cell_mm=st.floats(1.0, 60.0),
    quiet_mm=st.floats(0.0, 80.0),
    paper=st.sampled_from(sorted(PAPERS_MM)),
    joint=st.sampled_from(["butt", "overlap"]),
    seams=st.sampled_from(["cells", "anywhere"]),
)
def test_cores_cover_the_page_once_and_fit_their_sheets(
    rows: int, cols: int, cell_mm: float, quiet_mm: float, paper: str, joint: str, seams: str
) -> None:
    pad = make_pad(rows, cols, cell_mm=cell_mm, quiet_mm=quiet_mm)
    options = SheetOptions(paper=paper, joint=joint, seams=seams)  # type: ignore[arg-type]
    plan = plan_sheets(pad, options)
    area = sum(sheet.core.width * sheet.core.height for sheet in plan.sheets)
    assert area == pytest.approx(plan.page_width_mm * plan.page_height_mm)
    for sheet in plan.sheets:
        assert min(sheet.core.width, sheet.core.height) > 0
        assert sheet.x_mm >= options.margin_mm
        assert sheet.y_mm >= options.margin_mm
        right = sheet.x_mm + sheet.painted.width
        bottom = sheet.y_mm + sheet.painted.height
        assert right <= plan.paper.width_mm - options.margin_mm + 1e-5
        assert bottom <= plan.paper.height_mm - options.margin_mm + 1e-5
        under = options.overlap_mm if joint == "overlap" else 0.0
        assert sheet.painted.x1 == min(sheet.core.x1 + under, plan.page_width_mm)
        assert sheet.painted.y1 == min(sheet.core.y1 + under, plan.page_height_mm)


@given(cell_mm=st.floats(2.0, 50.0), quiet_mm=st.floats(0.0, 30.0))
def test_seams_lie_on_cell_edges(cell_mm: float, quiet_mm: float) -> None:
    pad = make_pad(40, 40, cell_mm=cell_mm, quiet_mm=quiet_mm)
    plan = plan_sheets(pad, SheetOptions(paper="A4"))
    assert plan.on_cells
    for seams in (plan.x_seams_mm, plan.y_seams_mm):
        inside = [s for s in seams if quiet_mm <= s <= plan.page_width_mm - quiet_mm]
        cells = (np.array(inside) - quiet_mm) / cell_mm
        np.testing.assert_allclose(cells, np.round(cells), atol=1e-6)


def test_seams_prefer_edges_of_coarse_cells() -> None:
    plan = plan_sheets(make_pad(125, 125), SheetOptions(paper="A3"))
    assert (plan.cols, plan.rows) == (5, 4)
    assert plan.x_seams_mm == (250.0, 500.0, 750.0, 1000.0)
    assert all(seam % 50 == 0 for seam in plan.y_seams_mm)


def test_cells_larger_than_a_sheet_are_cut_and_it_says_so() -> None:
    plan = plan_sheets(make_pad(15, 15, ratio=1, cell_mm=500.0), SheetOptions(paper="A4"))
    assert not plan.on_cells
    assert len(plan.sheets) > 15 * 15


def test_orientation_with_fewer_sheets_is_chosen() -> None:
    pad = make_pad(16, 52, ratio=1, cell_mm=5.0)
    auto = plan_sheets(pad, SheetOptions(paper="A4"))
    assert (auto.paper.orientation, len(auto.sheets)) == ("landscape", 1)
    upright = plan_sheets(pad, SheetOptions(paper="A4", orientation="portrait"))
    assert (upright.paper.orientation, len(upright.sheets)) == ("portrait", 2)


def test_own_size_is_one_sheet() -> None:
    plan = plan_sheets(make_pad(100, 100, quiet_mm=20.0), SheetOptions(paper="own"))
    assert len(plan.sheets) == 1
    assert plan.paper.width_mm > 1040
    bare = SheetOptions(paper="own", margin_mm=0.0, furniture=False)
    assert plan_sheets(make_pad(100, 100), bare).paper.width_mm == 1000.0


def test_plan_is_plain_data() -> None:
    plan = plan_sheets(make_pad(125, 125), SheetOptions(paper="A4"))
    data = json.loads(json.dumps(plan.to_dict()))
    assert data["count"] == 35 == len(data["sheets"])
    assert data["paper_m2"] == pytest.approx(35 * 0.21 * 0.297, abs=1e-4)
    assert data["sheets"][-1]["name"] == "E7"


@pytest.mark.parametrize(
    ("row", "col", "name"), [(0, 0, "A1"), (25, 8, "Z9"), (26, 0, "AA1"), (701, 11, "ZZ12")]
)
def test_sheet_names(row: int, col: int, name: str) -> None:
    assert sheet_name(row, col) == name


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"paper": "B9"}, "is no paper"),
        ({"paper": "0x300"}, "beyond"),
        ({"paper": "1e9x3"}, "is no paper"),
        ({"margin_mm": 120.0}, "smaller margins"),
        ({"margin_mm": -1.0}, "margin_mm"),
        ({"margin_mm": float("nan")}, "margin_mm"),
        ({"joint": "glue"}, "joint"),
        ({"orientation": "up"}, "orientation"),
        ({"seams": "maybe"}, "seams"),
        ({"overlap_mm": 0.0}, "overlap_mm"),
        ({"joint": "overlap", "overlap_mm": 190.0}, "smaller overlap"),
    ],
)
def test_bad_options_are_refused(options: dict[str, object], message: str) -> None:
    with pytest.raises(SpecError, match=message):
        plan_sheets(make_pad(125, 125), SheetOptions(**options))  # type: ignore[arg-type]


def test_too_many_sheets_are_refused() -> None:
    with pytest.raises(LimitError, match="larger paper"):
        plan_sheets(make_pad(200, 200, cell_mm=100.0), SheetOptions(paper="A4"))
