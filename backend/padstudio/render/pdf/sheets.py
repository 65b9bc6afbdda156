"""A pad as a PDF of sheets: an assembly map, then one page a sheet."""

from __future__ import annotations

from typing import BinaryIO

from padstudio.pad.layout import crop, layout
from padstudio.pad.sheets.tiling import SheetPlan, plan_sheets
from padstudio.pad.spec import Pad
from padstudio.render.painters.options import PrintOptions
from padstudio.render.pdf.assembly_map import draw_map
from padstudio.render.pdf.cells import add_cells
from padstudio.render.pdf.furniture import draw_furniture, draw_page
from padstudio.render.pdf.page import open_document


def write_sheets(pad: Pad, out: BinaryIO, options: PrintOptions | None = None) -> SheetPlan:
    """Write a pad spread over sheets as a PDF at true scale.

    Parameters
    ----------
    pad : Pad
    out : binary file open for writing
    options : PrintOptions, optional

    Returns
    -------
    SheetPlan
        What was printed, sheet by sheet, in the order of the pages after the map.

    Raises
    ------
    SpecError, LimitError
        If the pad does not go onto such sheets; see `plan_sheets` and `PrintOptions.check`.
    """
    options = options or PrintOptions()
    options.check(pad)
    plan = plan_sheets(pad, options.sheets)
    page = layout(pad)
    pen = open_document(pad, out, plan.paper.width_mm, plan.paper.height_mm, options.ink)
    if options.assembly_map and len(plan.sheets) > 1:
        pen.start_page(options.measured)
        draw_map(pen, pad, plan)
        pen.canvas.showPage()
    for sheet in plan.sheets:
        box = sheet.painted
        add_cells(pen.canvas, sheet.name, crop(page, box.x0, box.y0, box.x1, box.y1), options.ink)
        pen.start_page(options.measured)
        with pen.moved(sheet.x_mm - box.x0, sheet.y_mm - box.y0):
            pen.form(sheet.name)
            with pen.clipped(box):
                draw_page(pen, pad, options, page.page_width_mm, page.page_height_mm)
        if options.sheets.furniture:
            draw_furniture(pen, pad, plan, sheet, qr=options.qr)
        pen.canvas.showPage()
    pen.canvas.save()
    return plan
