"""Cells as a PDF form: vector rectangles, compressed while they are written."""

from __future__ import annotations

import zlib
from collections.abc import Iterator

from reportlab.pdfbase import pdfdoc
from reportlab.pdfgen.canvas import Canvas

from padstudio.pad.layout import Layout
from padstudio.render.inks import Ink, fill_operator
from padstudio.render.runs import iter_shapes

# Viewers and printers fill a path as a whole; long paths exceed what small printers hold.
_SHAPES_PER_PATH = 250


def add_cells(canvas: Canvas, name: str, page: Layout, ink: Ink) -> None:
    """Register a layout's cells as a form of the canvas's document.

    The form's unit is 1 mm, y down, its origin the layout's. Only
    compressed data are kept in memory.
    """
    packer = zlib.compressobj(6)
    pieces = [packer.compress(text.encode()) for text in _operators(page, ink)]
    form = pdfdoc.PDFStream(content=b"".join([*pieces, packer.flush()]))
    form.dictionary["Type"] = pdfdoc.PDFName("XObject")
    form.dictionary["Subtype"] = pdfdoc.PDFName("Form")
    form.dictionary["FormType"] = 1
    # The box clips: wider than the cells, it cannot soften their outer edges.
    left, right = page.x_mm[0] - 1, page.x_mm[-1] + 1
    top, bottom = page.y_mm[0] - 1, page.y_mm[-1] + 1
    form.dictionary["BBox"] = pdfdoc.PDFArray([left, top, right, bottom])
    form.dictionary["Resources"] = pdfdoc.PDFDictionary({})
    form.dictionary["Filter"] = pdfdoc.PDFName("FlateDecode")
    canvas._doc.Reference(form, pdfdoc.xObjectName(name))


def _operators(page: Layout, ink: Ink) -> Iterator[str]:
    """Content stream text, block by block."""
    for shapes in iter_shapes(page):
        yield fill_operator(shapes.color, ink) + "\n"
        for boxes, write in (
            (shapes.wide_mm, _wide),
            (shapes.tall_mm, _tall),
            (shapes.boxes_mm, _box),
        ):
            for start in range(0, len(boxes), _SHAPES_PER_PATH):
                block = boxes[start : start + _SHAPES_PER_PATH].tolist()
                yield "".join(write(*box) for box in block) + "f\n"


def _box(x0: float, y0: float, x1: float, y1: float) -> str:
    return f"{_number(x0)} {_number(y0)} {_number(x1 - x0)} {_number(y1 - y0)} re\n"


def _wide(x0: float, y0: float, x1: float, y1: float) -> str:
    middle, reach = (y0 + y1) / 2, (y1 - y0) / 2
    left, right = x0 + reach, x1 - reach
    return _polygon(x0, middle, left, y0, right, y0, x1, middle, right, y1, left, y1)


def _tall(x0: float, y0: float, x1: float, y1: float) -> str:
    middle, reach = (x0 + x1) / 2, (x1 - x0) / 2
    top, bottom = y0 + reach, y1 - reach
    return _polygon(middle, y0, x1, top, x1, bottom, middle, y1, x0, bottom, x0, top)


def _polygon(*coordinates: float) -> str:
    words = [_number(value) for value in coordinates]
    points = [f"{x} {y}" for x, y in zip(words[::2], words[1::2], strict=True)]
    return f"{points[0]} m " + " ".join(f"{point} l" for point in points[1:]) + " h\n"


def _number(value: float) -> str:
    """A length in mm to a tenth of a micrometre, as short as it can be."""
    return f"{value:.4f}".rstrip("0").rstrip(".")
