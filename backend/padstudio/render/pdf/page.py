"""A pad as a PDF of one page of its own size."""

from __future__ import annotations

import io
import json
from typing import BinaryIO

from reportlab.pdfgen.canvas import Canvas

from padstudio.pad.identity import describe
from padstudio.pad.layout import layout
from padstudio.pad.spec import Pad
from padstudio.render.painters.inks import Ink
from padstudio.render.pdf.cells import add_cells
from padstudio.render.pdf.pen import Pen

_POINTS_PER_MM = 72 / 25.4


def paint_pdf(pad: Pad, *, ink: Ink = "rgb") -> bytes:
    """The pad as a PDF; see `write_pdf`."""
    out = io.BytesIO()
    write_pdf(pad, out, ink=ink)
    return out.getvalue()


def write_pdf(pad: Pad, out: BinaryIO, *, ink: Ink = "rgb") -> None:
    """Write the pad as one PDF page of its own size, quiet margin included, at true scale.

    The cells are vector rectangles, one a run of equal cells. Viewers are asked not to scale the
    page when printing; title, spec and seed stand in the metadata. Equal pads give equal files.

    A page beyond 5080 mm keeps its true size in points. Adobe's readers refuse such a page; in
    larger units (UserUnit) it would come out too small, without a word, where these are ignored.

    Parameters
    ----------
    pad : Pad
    out : binary file open for writing
    ink : {"rgb", "cmyk"}
        What the colours are given in.
    """
    page = layout(pad)
    pen = open_document(pad, out, page.page_width_mm, page.page_height_mm, ink)
    add_cells(pen.canvas, "pad", page, ink)
    pen.start_page((1.0, 1.0))
    pen.form("pad")
    pen.canvas.showPage()
    pen.canvas.save()


def open_document(pad: Pad, out: BinaryIO, width_mm: float, height_mm: float, ink: Ink) -> Pen:
    """A document with pages of one size and the pad's metadata, and the pen that draws on them."""
    pen = open_canvas(out, width_mm, height_mm, ink)
    # JSON allows half a surrogate pair, which no text in a PDF can hold.
    pen.canvas.setTitle(pad.name.encode("utf-8", "replace").decode())
    pen.canvas.setSubject("Landing pad, true size: print without scaling")
    pen.canvas.setKeywords(json.dumps(describe(pad)))
    return pen


def open_canvas(out: BinaryIO, width_mm: float, height_mm: float, ink: Ink) -> Pen:
    """A document with pages of one size that asks not to be scaled."""
    canvas = Canvas(
        out,
        pagesize=(width_mm * _POINTS_PER_MM, height_mm * _POINTS_PER_MM),
        pageCompression=1,
        invariant=1,
        pdfVersion=(1, 7),
    )
    canvas.setViewerPreference("PrintScaling", "None")
    canvas.setAuthor("Pad Studio")
    canvas.setCreator("Pad Studio")
    return Pen(canvas, _POINTS_PER_MM, height_mm, ink)
