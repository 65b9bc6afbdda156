from __future__ import annotations

import dataclasses
import io
from pathlib import Path

import cv2
import numpy as np
import pytest
from measure_print import Array, cut_marks, edge_errors_mm, make_pad, pages, pdf_info, pdf_text

from padstudio.arrays import Image
from padstudio.errors import SpecError
from padstudio.pad.identity import label_text, pad_id
from padstudio.pad.layout import Layout, crop, layout
from padstudio.pad.sheets.tiling import SheetOptions, SheetPlan
from padstudio.pad.spec import Pad
from padstudio.render.painters.options import PrintOptions
from padstudio.render.pdf.sheets import write_sheets

DPI = 200
SCALE = DPI / 25.4


def printed(
    pad: Pad, folder: Path, *, dpi: float = DPI, **options: object
) -> tuple[SheetPlan, list[Image]]:
    """The plan, and every page as poppler renders it."""
    plan, data = written(pad, **options)
    return plan, pages(data, folder, dpi)


def written(pad: Pad, **options: object) -> tuple[SheetPlan, bytes]:
    out = io.BytesIO()
    plan = write_sheets(pad, out, PrintOptions(**options))  # type: ignore[arg-type]
    return plan, out.getvalue()


@pytest.mark.parametrize(
    ("sheets", "quiet_mm", "dpi"),
    [
        (SheetOptions(paper="A4"), 0.0, 200),
        (SheetOptions(paper="A4"), 0.0, 300),
        (SheetOptions(paper="Letter", joint="overlap", overlap_mm=8.0), 13.3, 200),
        (SheetOptions(paper="230x310", seams="anywhere"), 4.0, 240),
    ],
)
def test_cut_and_joined_sheets_make_the_pad(
    sheets: SheetOptions, quiet_mm: float, dpi: float, tmp_path: Path
) -> None:
    """Every cell edge is where the layout says, measured from the cut marks alone."""
    pad = make_pad(40, 40, quiet_mm=quiet_mm)
    plan, (_, *tiles) = printed(pad, tmp_path, dpi=dpi, sheets=sheets)
    assert len(tiles) == len(plan.sheets) >= 6
    page = layout(pad)
    origin_x = dict.fromkeys(range(plan.rows), 0.0)
    origin_y = dict.fromkeys(range(plan.cols), 0.0)
    for sheet, tile in zip(plan.sheets, tiles, strict=True):
        left, top, right, bottom = cut_marks(tile, sheet, dpi / 25.4)
        # Laid against its neighbours, the sheet's cut corner is where theirs end.
        at_x, at_y = origin_x[sheet.row], origin_y[sheet.col]
        origin_x[sheet.row] += right - left
        origin_y[sheet.col] += bottom - top
        part = crop(page, sheet.core.x0, sheet.core.y0, sheet.core.x1, sheet.core.y1)
        shift = np.array([left - at_x, top - at_y])
        errors = tile_errors(tile, part, shift, dpi / 25.4)
        assert len(errors) > 100
        assert np.abs(errors).max() < 0.05
    for total in (*origin_x.values(), *origin_y.values()):
        assert total == pytest.approx(plan.page_width_mm, abs=0.05)


def test_overlap_shows_what_the_next_sheet_shows(tmp_path: Path) -> None:
    pad = make_pad(40, 40)
    options = SheetOptions(paper="A4", joint="overlap", overlap_mm=8.0)
    plan, (_, first, second, *_) = printed(pad, tmp_path, sheets=options)
    a, b = plan.sheets[:2]
    strip = _cut(first, a.x_mm + a.core.width + 0.5, a.y_mm + 1, 7.0, 100.0)
    under = _cut(second, b.x_mm + 0.5, b.y_mm + 1, 7.0, 100.0)
    different = np.abs(strip.astype(int) - under).max(axis=2) > 128
    assert different.mean() < 0.03


def test_rulers_measure_true_on_every_sheet(tmp_path: Path) -> None:
    plan, (_, *tiles) = printed(make_pad(40, 40), tmp_path, sheets=SheetOptions(paper="A4"))
    for tile in tiles:
        dark = 255.0 - tile.min(axis=2)
        height = plan.paper.height_mm
        # Between the numbers and the base line: ticks of 10 mm alone.
        across = dark[_px(height - 5 - 7 + 1.9) : _px(height - 5 - 7 + 2.3)].mean(axis=0)
        np.testing.assert_allclose(_ticks(across), 5 + 10 * np.arange(21), atol=0.05)
        down = dark[:, _px(5 + 1.9) : _px(5 + 2.3)].mean(axis=1)
        wanted = height - 5 - 8 - 10 * np.arange(21)[::-1]
        # Below them follows the base line of the ruler along x.
        np.testing.assert_allclose(_ticks(down)[-22:-1], wanted, atol=0.05)


@pytest.mark.parametrize("paper", ["A4", "A3", "Letter", "Legal", "Tabloid"])
@pytest.mark.parametrize("orientation", ["portrait", "landscape"])
def test_every_sheet_has_both_rulers_of_200_mm(
    paper: str, orientation: str, tmp_path: Path
) -> None:
    options = SheetOptions(paper=paper, orientation=orientation)  # type: ignore[arg-type]
    plan, data = written(make_pad(60, 60), sheets=options)
    words = pdf_text(data, tmp_path)
    for axis in "xy":
        found = words.count(f"{axis}: measure this: if it is not 200 mm, enter what you read")
        assert found == len(plan.sheets) + 1


def test_labels_map_and_metadata(tmp_path: Path) -> None:
    pad = make_pad(60, 60, name="Hof 3 🚁 שלום", seed=5)
    plan, data = written(pad, sheets=SheetOptions(paper="A4"))
    words = pdf_text(data, tmp_path)
    last = plan.sheets[-1].name
    for sheet in plan.sheets:
        assert f"Sheet {sheet.name} of {last}" in words
    assert words.count(f"id {pad_id(pad)}") == len(plan.sheets) + 1
    assert "Hof 3 [helicopter]" in words
    assert f"Pages:           {len(plan.sheets) + 1}" in pdf_info(data, tmp_path)
    assert b"/PrintScaling /None" in data


def test_qr_codes_hold_the_spec(tmp_path: Path) -> None:
    pad = make_pad(40, 40, seed=5, quiet_mm=40.0)
    plan, data = written(pad, sheets=SheetOptions(paper="A3"))
    images = pages(data, tmp_path, 300)
    # On the map, beside the pad on every sheet, and in the margin of the last one.
    sheet = plan.sheets[-1]
    corner_x = sheet.x_mm + sheet.core.width - 40.0
    corner_y = sheet.y_mm + sheet.core.height - 40.0
    places = [(0, plan.paper.width_mm - 45.0, 5.0, 40.0), (len(images) - 1, corner_x, corner_y, 40)]
    places += [(number, 17.5, 4.5, 10.5) for number in range(1, len(images))]
    assert len(places) == len(plan.sheets) + 2
    for number, x, y, side in places:
        top, left, extent = (round(mm * 300 / 25.4) for mm in (y, x, side))
        part = images[number][top : top + extent, left : left + extent]
        enlarged = cv2.resize(part, None, fx=4, fy=4, interpolation=cv2.INTER_CUBIC)
        assert cv2.QRCodeDetector().detectAndDecode(enlarged)[0] == label_text(pad)


def test_correction_makes_the_print_larger_where_the_printer_makes_it_smaller(
    tmp_path: Path,
) -> None:
    pad = make_pad(15, 15)
    sheets = SheetOptions(paper="A4")
    plan, (image,) = printed(pad, tmp_path, sheets=sheets, measured=(0.98, 0.99))
    sheet = plan.sheets[0]
    # What the printer would make of it: smaller by the same share.
    size = (round(image.shape[1] * 0.98), round(image.shape[0] * 0.99))
    came_out = cv2.resize(image, size, interpolation=cv2.INTER_AREA)
    shift = np.array([sheet.x_mm, sheet.y_mm])
    assert np.abs(tile_errors(came_out, layout(pad), shift)).max() < 0.1


def test_header_without_room_is_refused() -> None:
    with pytest.raises(SpecError, match="quiet margin"):
        written(make_pad(quiet_mm=3.0), header="Hof")


@pytest.mark.parametrize("text", ["🚁" * 60, "שלום " * 30, "中" * 90, "W" * 200, ""])
def test_any_name_prints_within_the_sheet(text: str, tmp_path: Path) -> None:
    pad = make_pad(15, 15, name=text, quiet_mm=10.0)
    _, data = written(pad, sheets=SheetOptions(paper="A4"), header=text, footer=text)
    (image,) = pages(data, tmp_path, 50)
    margin = round(4 * 50 / 25.4)
    assert (image[:, -margin:] == 255).all()
    assert (image[:, :margin] == 255).all()


def tile_errors(tile: Image, part: Layout, shift: Array, px_per_mm: float = SCALE) -> Array:
    """Errors of a layout's cell edges on a sheet where the page's origin is at `shift`, mm."""
    on_sheet = dataclasses.replace(part, x_mm=part.x_mm + shift[0], y_mm=part.y_mm + shift[1])
    return edge_errors_mm(tile, on_sheet, px_per_mm)


def _ticks(profile: Array) -> Array:
    """Middles of dark strokes along a line, mm."""
    dark = np.flatnonzero(profile > 40)
    groups = np.split(dark, np.flatnonzero(np.diff(dark) > 1) + 1)
    return np.array([(profile[g] @ (g + 0.5)) / profile[g].sum() / SCALE for g in groups])


def _cut(image: Image, x: float, y: float, width: float, height: float) -> Image:
    return image[_px(y) : _px(y) + _px(height), _px(x) : _px(x) + _px(width)]


def _px(mm: float) -> int:
    return round(mm * SCALE)
