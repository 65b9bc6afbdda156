"""A pad as a PDF of one page of its own size."""

from __future__ import annotations

import io
import json
from typing import Any, BinaryIO

from reportlab.pdfgen.canvas import Canvas

from padstudio.pad.layout import layout
from padstudio.pad.spec import Pad
from padstudio.render.inks import Ink
from padstudio.render.pdf_cells import POINTS_PER_MM, add_cells, place_cells

# The largest page side that PDF readers accept at one point a unit; larger pages declare a
# larger unit (PDF 32000-1:2008, table C.1 and 14.11.2).
_MAX_SIDE_POINTS = 14_400


def paint_pdf(pad: Pad, *, ink: Ink = "rgb") -> bytes:
    """The pad as a PDF; see `write_pdf`."""
    out = io.BytesIO()
    write_pdf(pad, out, ink=ink)
    return out.getvalue()


def write_pdf(pad: Pad, out: BinaryIO, *, ink: Ink = "rgb") -> None:
    """Write the pad as one PDF page of its own size, quiet margin included, at true scale.

    The cells are vector rectangles, one a run of equal cells. Viewers are asked not to scale the
    page when printing; title, spec and seed stand in the metadata. Equal pads give equal files.

    Parameters
    ----------
    pad : Pad
    out : binary file open for writing
    ink : {"rgb", "cmyk"}
        What the colours are given in.
    """
    page = layout(pad)
    canvas, unit = open_canvas(pad, out, page.page_width_mm, page.page_height_mm)
    add_cells(canvas, "pad", page, ink)
    place_cells(canvas, "pad", 0.0, page.page_height_mm, unit)
    canvas.showPage()
    canvas.save()


def open_canvas(pad: Pad, out: BinaryIO, width_mm: float, height_mm: float) -> tuple[Canvas, float]:
    """A canvas for pages of one size, with the pad's metadata, and the page's unit in points."""
    side = max(width_mm, height_mm) * POINTS_PER_MM
    unit = max(1.0, -(-side // _MAX_SIDE_POINTS))
    size = (width_mm * POINTS_PER_MM / unit, height_mm * POINTS_PER_MM / unit)
    canvas = Canvas(out, pagesize=size, pageCompression=1, invariant=1, pdfVersion=(1, 7))
    canvas.setViewerPreference("PrintScaling", "None")
    canvas.setTitle(pad.name)
    canvas.setAuthor("Pad Studio")
    canvas.setCreator("Pad Studio")
    canvas.setSubject("Landing pad, true size: print without scaling")
    canvas.setKeywords(json.dumps(describe(pad)))
    return canvas, unit


def describe(pad: Pad) -> dict[str, Any]:
    """The pad's spec and seed, without its fields, JSON-serialisable."""
    spec: dict[str, Any] = {
        "name": pad.name,
        "window": pad.window,
        "levels": pad.levels,
        "quiet_mm": pad.quiet_mm,
    }
    optional = ("seed", "method", "unique", "distance")
    spec |= {key: getattr(pad, key) for key in optional if getattr(pad, key) is not None}
    spec["layers"] = [
        {
            "channel": layer.channel,
            "cell_mm": layer.cell_mm,
            "rows": layer.rows,
            "cols": layer.cols,
        }
        for layer in pad.layers
    ]
    return spec
