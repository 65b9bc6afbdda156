"""A PDF's pages, all of one size, at true scale."""

from __future__ import annotations

import json
from typing import BinaryIO

from reportlab.pdfgen.canvas import Canvas

from padstudio.pad.identity import describe
from padstudio.pad.spec import Pad
from padstudio.render.painters.inks import Ink
from padstudio.render.pdf.pen import Pen

_POINTS_PER_MM = 72 / 25.4


def open_document(pad: Pad, out: BinaryIO, width_mm: float, height_mm: float, ink: Ink) -> Pen:
    """A document with pages of one size and the pad's metadata, and the pen that draws on them.

    Viewers are asked not to scale pages when printing; title, spec and seed stand in the metadata.
    Equal pads give equal files.

    A page beyond 5080 mm keeps its true size in points. Adobe's readers refuse such a page; in
    larger units (UserUnit) it would come out too small, without a word, where these are ignored.
    """
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
