"""Cells as a PDF form: vector rectangles, compressed while they are written."""

from __future__ import annotations

import zlib
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from reportlab.pdfbase import pdfdoc
from reportlab.pdfgen.canvas import Canvas

from padstudio.arrays import Array
from padstudio.pad.layout import Layout
from padstudio.render.painters.inks import Ink, fill_operator
from padstudio.render.painters.rectangles import iter_shapes

# Viewers and printers fill a path as a whole; long paths exceed what small printers hold.
_SHAPES_PER_PATH = 250
# Shapes turned into text at a time: bounds the memory in use.
_SHAPES_PER_BLOCK = 20_000
_BOX = "%s %s %s %s re\n"
_LOZENGE = "%s %s m %s %s l %s %s l %s %s l %s %s l %s %s l h\n"


def add_cells(canvas: Canvas, name: str, page: Layout, ink: Ink) -> None:
    """Register a layout's cells as a form of the canvas's document.

    The form's unit is 1 mm, y down, its origin the layout's. Only compressed data are kept in
    memory.
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
        for boxes, corners, pattern in (
            (shapes.wide_mm, _wide, _LOZENGE),
            (shapes.tall_mm, _tall, _LOZENGE),
            (shapes.boxes_mm, _box, _BOX),
        ):
            for start in range(0, len(boxes), _SHAPES_PER_BLOCK):
                words = _words(corners(boxes[start : start + _SHAPES_PER_BLOCK]))
                for first in range(0, len(words), _SHAPES_PER_PATH):
                    path = words[first : first + _SHAPES_PER_PATH]
                    yield (pattern * len(path) + "f\n") % tuple(path.ravel().tolist())


def _box(boxes: Array) -> Array:
    """(N, 4): corner and size."""
    return np.concatenate([boxes[:, :2], boxes[:, 2:] - boxes[:, :2]], axis=1)


def _wide(boxes: Array) -> Array:
    """(N, 12): the points of lozenges that lie along x."""
    x0, y0, x1, y1 = boxes.T
    middle, reach = (y0 + y1) / 2, (y1 - y0) / 2
    left, right = x0 + reach, x1 - reach
    return np.stack([x0, middle, left, y0, right, y0, x1, middle, right, y1, left, y1], axis=1)


def _tall(boxes: Array) -> Array:
    """(N, 12): the points of lozenges that lie along y."""
    x0, y0, x1, y1 = boxes.T
    middle, reach = (x0 + x1) / 2, (x1 - x0) / 2
    top, bottom = y0 + reach, y1 - reach
    return np.stack([middle, y0, x1, top, x1, bottom, middle, y1, x0, bottom, x0, top], axis=1)


def _words(lengths_mm: Array) -> NDArray[np.object_]:
    """Lengths as text to a tenth of a micrometre, as short as it can be; each kind made once."""
    kinds, kind_of = np.unique(np.round(lengths_mm, 4), return_inverse=True)
    texts = [f"{value:.4f}".rstrip("0").rstrip(".") for value in kinds.tolist()]
    return np.array(texts, object)[kind_of].reshape(lengths_mm.shape)
