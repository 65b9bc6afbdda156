"""What stands beside the pad on a sheet: rulers, cut marks, label; and what stands on its page."""

from __future__ import annotations

from padstudio.pad.identity import label_text, pad_id
from padstudio.pad.sheets.paper import Bands, Box, Paper
from padstudio.pad.sheets.tiling import Sheet, SheetPlan
from padstudio.pad.spec import Pad
from padstudio.render.painters.options import PrintOptions
from padstudio.render.pdf.pen import Pen

#: Lengths that a ruler may have, longest first; on smaller sheets the longest multiple of 10 mm.
RULERS_MM = (1000, 500, 200)
# What the bands round a sheet's core (`padstudio.pad.sheets.paper.Bands`) have room for.
_RULER_BAND_MM = 7.0
_MARK_GAP_MM = 1.0
_MARK_MM = 3.0
_LINE_MM = 0.15
_QR_MM = 9.5
_MARGIN_QR_MM = 15.0


def draw_furniture(pen: Pen, pad: Pad, plan: SheetPlan, sheet: Sheet, *, qr: bool) -> None:
    """Rulers, cut marks and label of one sheet; sheet coordinates."""
    draw_rulers(pen, plan.paper, plan.options.margin_mm)
    draw_cut_marks(pen, sheet)
    margin = plan.options.margin_mm
    x = margin + Bands().left + 1.0
    if qr:
        pen.qr(Box(x, margin, x + _QR_MM, margin + _QR_MM), label_text(pad))
        x += _QR_MM + 1.0
    right = plan.paper.width_mm - margin
    _draw_up_arrow(pen, right - 3.0, margin + 1.0)
    words = [f"Sheet {sheet.name} of {plan.sheets[-1].name}"] if len(plan.sheets) > 1 else []
    words += [f"row {sheet.row + 1}, column {sheet.col + 1}"] if len(plan.sheets) > 1 else []
    words += [pad.name, f"id {pad_id(pad)}"]
    pen.text(x, margin + 4.0, "  ·  ".join(words), 3.4, width=right - 8.0 - x)


def draw_cut_marks(pen: Pen, sheet: Sheet) -> None:
    """Eight lines that point along the core's sides, outside everything painted."""
    x0, y0 = sheet.x_mm, sheet.y_mm
    x1, y1 = x0 + sheet.core.width, y0 + sheet.core.height
    right, bottom = x0 + sheet.painted.width, y0 + sheet.painted.height
    half, gap, end = _LINE_MM / 2, _MARK_GAP_MM, _MARK_GAP_MM + _MARK_MM
    marks = []
    for x in (x0, x1):
        marks.append(Box(x - half, y0 - end, x + half, y0 - gap))
        marks.append(Box(x - half, bottom + gap, x + half, bottom + end))
    for y in (y0, y1):
        marks.append(Box(x0 - end, y - half, x0 - gap, y + half))
        marks.append(Box(right + gap, y - half, right + end, y + half))
    pen.bars(marks)


def draw_rulers(pen: Pen, paper: Paper, margin: float) -> None:
    """A ruler along the bottom and one along the left, as long as the sheet allows.

    Where they would cross, the longer side's gives way: the shorter side needs all its length.
    """
    width, height = paper.width_mm, paper.height_mm
    portrait = width <= height
    aside = _RULER_BAND_MM + 1.0
    x0 = margin if portrait else margin + aside
    y0 = height - margin - (aside if portrait else 0.0)
    if length := ruler_length_mm(width - margin - x0):
        with pen.moved(x0, height - margin - _RULER_BAND_MM):
            _draw_ruler(pen, length, "x")
    if length := ruler_length_mm(y0 - margin):
        with pen.moved(margin, y0, upward=True):
            _draw_ruler(pen, length, "y")


def ruler_length_mm(room_mm: float) -> int:
    """The length of the ruler that fits into some room; 0 where not even 50 mm do."""
    room_mm += 1e-6
    fitting = [length for length in RULERS_MM if length <= room_mm]
    if fitting:
        return fitting[0]
    return int(room_mm // 10 * 10) if room_mm >= 50 else 0


def draw_page(pen: Pen, pad: Pad, options: PrintOptions, width_mm: float, height_mm: float) -> None:
    """Outline, header, footer and QR code in the pad's quiet margin; page coordinates."""
    if options.outline_mm:
        pen.frame(Box(0.0, 0.0, width_mm, height_mm), options.outline_mm)
    quiet = pad.quiet_mm
    size = min(quiet * 0.4, 12.0)
    room = width_mm - 2 * quiet
    if options.header:
        pen.text(
            width_mm / 2, quiet / 2 + size * 0.35, options.header, size, width=room, align="center"
        )
    if options.footer:
        y = height_mm - quiet / 2 + size * 0.35
        pen.text(width_mm / 2, y, options.footer, size, width=room, align="center")
    if options.qr and quiet >= _MARGIN_QR_MM:
        side = min(quiet * 0.7, 60.0)
        left, top = width_mm - (quiet + side) / 2, height_mm - (quiet + side) / 2
        pen.qr(Box(left, top, left + side, top + side), label_text(pad))
        pen.text(left - 1.0, top + side / 2 + 1.0, pad_id(pad), side / 6, align="right")


def _draw_ruler(pen: Pen, length: int, axis: str) -> None:
    """A ruler from the origin along x, its ticks below, within the ruler band."""
    ticks = [Box(0.0, 0.0, length, _LINE_MM)]
    for mm in range(length + 1):
        tall = 2.4 if mm % 10 == 0 else 1.7 if mm % 5 == 0 else 1.1
        ticks.append(Box(mm - _LINE_MM / 2, 0.0, mm + _LINE_MM / 2, tall))
    pen.bars(ticks)
    for mm in range(0, length + 1, 50 if length > 200 else 20):
        align = "left" if mm == 0 else "right" if mm == length else "center"
        pen.text(mm, 4.3, f"{mm}", 2.0, align=align)  # type: ignore[arg-type]
    pen.text(
        length / 2,
        6.5,
        f"{axis}: measure this: if it is not {length} mm, enter what you read",
        2.2,
        align="center",
        width=length,
    )


def _draw_up_arrow(pen: Pen, x: float, y: float) -> None:
    pen.polygon((x, y), (x + 1.5, y + 2.0), (x - 1.5, y + 2.0))
    pen.line(x, y + 2.0, x, y + 4.0, 0.8)
