"""The first page of a print of several sheets: where each goes, and how they are joined."""

from __future__ import annotations

import numpy as np
from PIL import Image
from reportlab.lib.utils import ImageReader

from padstudio.pad.identity import label_text, pad_id
from padstudio.pad.sheets.paper import Box
from padstudio.pad.sheets.tiling import SheetPlan
from padstudio.pad.spec import Pad
from padstudio.render.painters.raster import paint
from padstudio.render.pdf.furniture import draw_rulers
from padstudio.render.pdf.pen import Pen

# The longer side of the pad's picture on the map: fine enough to see how sheets lie.
_PREVIEW_PX = 400
_JOINING = {
    "butt": "Cut all four sides of every sheet along its cut marks; lay the sheets edge to edge.",
    "overlap": "Cut every sheet along its left and top cut marks and lay it over the strips that "
    "its neighbours print beyond their right and bottom marks.",
}


def draw_map(pen: Pen, pad: Pad, plan: SheetPlan) -> None:
    """Draw the assembly map; sheet coordinates."""
    margin = plan.options.margin_mm
    left, top = margin + 12.0, margin + 3.0
    right, bottom = plan.paper.width_mm - margin - 5.0, plan.paper.height_mm - margin - 12.0
    if plan.options.furniture:
        draw_rulers(pen, plan.paper, margin)
    qr = min(30.0, (right - left) / 5)
    pen.qr(Box(right - qr, top, right, top + qr), label_text(pad))
    y = top
    for size, line in _lines(pad, plan):
        y += size * 1.5
        pen.text(left, y, line, size, width=right - qr - 3.0 - left)
    _draw_sheets(pen, pad, plan, Box(left, max(y, top + qr) + 5.0, right, bottom))


def _lines(pad: Pad, plan: SheetPlan) -> list[tuple[float, str]]:
    """Letter sizes (mm) and lines of text."""
    size = f"{plan.page_width_mm:g} x {plan.page_height_mm:g} mm"
    return [
        (6.0, pad.name),
        (
            3.4,
            f"id {pad_id(pad)}  ·  {size}  ·  {len(plan.sheets)} sheets {plan.paper.name}, "
            f"{plan.rows} rows x {plan.cols} columns",
        ),
        (3.0, "Print at 100 %, without fitting to the page; measure the rulers on a sheet."),
        (3.0, _JOINING[plan.options.joint]),
    ]


def _draw_sheets(pen: Pen, pad: Pad, plan: SheetPlan, room: Box) -> None:
    """The pad, made small and pale, with the seams and the names of the sheets."""
    scale = min(room.width / plan.page_width_mm, room.height / plan.page_height_mm)
    if scale <= 0:
        return
    width, height = plan.page_width_mm * scale, plan.page_height_mm * scale
    x0, y0 = room.x0 + (room.width - width) / 2, room.y0
    pen.picture(Box(x0, y0, x0 + width, y0 + height), _preview(pad, plan))
    pen.frame(Box(x0, y0, x0 + width, y0 + height), 0.3)
    for x in plan.x_seams_mm:
        pen.line(x0 + x * scale, y0, x0 + x * scale, y0 + height, 0.3)
    for y in plan.y_seams_mm:
        pen.line(x0, y0 + y * scale, x0 + width, y0 + y * scale, 0.3)
    for sheet in plan.sheets:
        core = sheet.core
        size = min(core.width, core.height) * scale / 3
        x = x0 + (core.x0 + core.x1) / 2 * scale
        y = y0 + (core.y0 + core.y1) / 2 * scale
        pen.text(x, y + size / 3, sheet.name, size, align="center", width=core.width * scale)


def _preview(pad: Pad, plan: SheetPlan) -> ImageReader:
    """A pale picture of the pad, on which black letters can be read."""
    longest = max(plan.page_width_mm, plan.page_height_mm)
    image = paint(pad, _PREVIEW_PX / longest)
    pale = (255 - (255 - image.astype(np.uint16)) * 2 // 5).astype(np.uint8)
    return ImageReader(Image.fromarray(pale))
