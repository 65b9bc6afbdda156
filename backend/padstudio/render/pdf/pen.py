"""Drawing on a PDF page in millimetres from its top left, y down."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Literal

import segno
from reportlab.lib.utils import ImageReader
from reportlab.pdfgen.canvas import Canvas

from padstudio.pad.sheets.paper import Box
from padstudio.render.painters.inks import Ink, fill_operator, stroke_operator
from padstudio.render.pdf.text import FONT, fit

Align = Literal["left", "center", "right"]
BLACK = (0, 0, 0)


class Pen:
    """A canvas whose unit is 1 mm, y down, with its origin where it was moved to.

    Parameters
    ----------
    canvas : reportlab.pdfgen.canvas.Canvas
    points : float
        The canvas's units in a millimetre.
    height_mm : float
        The page's height.
    ink : {"rgb", "cmyk"}
    """

    def __init__(self, canvas: Canvas, points: float, height_mm: float, ink: Ink) -> None:
        self.canvas = canvas
        self._points = points
        self._height_mm = height_mm
        self._ink = ink

    def start_page(self, measured: tuple[float, float]) -> None:
        """Set the units of a new page, and its size against what the printer makes of it."""
        sx, sy = (1 / part for part in measured)
        top = self._height_mm * self._points
        # Written out: the canvas's own `transform` rounds to six decimals. Scaled from the top
        # left, where every sheet's pad begins.
        scale = self._points
        self.canvas._code.append(f"{scale * sx:.12f} 0 0 {-scale * sy:.12f} 0 {top:.9f} cm")

    @contextmanager
    def moved(self, x: float, y: float, *, upward: bool = False) -> Iterator[None]:
        """A frame with its origin at (x, y); `upward` turns its x axis up the page."""
        self.canvas.saveState()
        turn = "0 -1 1 0" if upward else "1 0 0 1"
        self.canvas._code.append(f"{turn} {x:.6f} {y:.6f} cm")
        yield
        self.canvas.restoreState()

    @contextmanager
    def clipped(self, box: Box) -> Iterator[None]:
        """Paint only inside a box."""
        self.canvas.saveState()
        self.canvas._code.append(f"{_rectangle(box)} W n")
        yield
        self.canvas.restoreState()

    def form(self, name: str) -> None:
        """Paint a form of `pdf_cells.add_cells`."""
        self.canvas.doForm(name)

    def line(self, x0: float, y0: float, x1: float, y1: float, width: float = 0.2) -> None:
        """A black line."""
        self.canvas._code.append(
            f"{stroke_operator(BLACK, self._ink)} {width:.4f} w "
            f"{x0:.4f} {y0:.4f} m {x1:.4f} {y1:.4f} l S"
        )

    def frame(self, box: Box, width: float) -> None:
        """A black line along the inside of a box."""
        inner = Box(box.x0 + width / 2, box.y0 + width / 2, box.x1 - width / 2, box.y1 - width / 2)
        self.canvas._code.append(
            f"{stroke_operator(BLACK, self._ink)} {width:.4f} w {_rectangle(inner)} S"
        )

    def fill(self, box: Box, rgb: tuple[int, int, int]) -> None:
        """A box in one colour."""
        self.canvas._code.append(f"{fill_operator(rgb, self._ink)} {_rectangle(box)} f")

    def bars(self, boxes: Iterable[Box]) -> None:
        """Black boxes in one path: viewers move a single box to whole pixels, but not these."""
        path = " ".join(map(_rectangle, boxes))
        self.canvas._code.append(f"{fill_operator(BLACK, self._ink)} {path} f")

    def polygon(self, *points: tuple[float, float]) -> None:
        """A black polygon."""
        path = " l ".join(f"{x:.4f} {y:.4f}" for x, y in points[1:])
        self.canvas._code.append(
            f"{fill_operator(BLACK, self._ink)} {points[0][0]:.4f} {points[0][1]:.4f} m {path} l f"
        )

    def text(
        self,
        x: float,
        y: float,
        text: str,
        size: float,
        *,
        width: float = 1e9,
        align: Align = "left",
    ) -> None:
        """Black text with its baseline at y, made to fit a width; see `pdf_text.fit`."""
        shown, size = fit(text, size, width)
        canvas = self.canvas
        canvas.saveState()
        # Letters stand upright in a frame whose y runs up.
        canvas._code.append(f"1 0 0 -1 {x:.4f} {y:.4f} cm {fill_operator(BLACK, self._ink)}")
        canvas.setFont(FONT, size)
        draw = {
            "left": canvas.drawString,
            "center": canvas.drawCentredString,
            "right": canvas.drawRightString,
        }[align]
        draw(0, 0, shown)
        canvas.restoreState()

    def picture(self, box: Box, image: ImageReader) -> None:
        """A picture that fills a box."""
        self.canvas.saveState()
        self.canvas._code.append(f"1 0 0 -1 {box.x0:.4f} {box.y1:.4f} cm")
        self.canvas.drawImage(image, 0, 0, box.width, box.height)
        self.canvas.restoreState()

    def qr(self, box: Box, text: str) -> None:
        """A QR code with its quiet zone, filling a square box."""
        code = segno.make(text, error="m", micro=False)
        rows = [bytes(row) for row in code.matrix_iter(border=4)]
        module = box.width / len(rows)
        path = []
        for number, row in enumerate(rows):
            for col, dark in enumerate(row):
                if dark:
                    x, y = box.x0 + col * module, box.y0 + number * module
                    path.append(f"{x:.5f} {y:.5f} {module:.5f} {module:.5f} re")
        self.fill(box, (255, 255, 255))
        self.canvas._code.append(f"{fill_operator(BLACK, self._ink)} {' '.join(path)} f")


def _rectangle(box: Box) -> str:
    return f"{box.x0:.4f} {box.y0:.4f} {box.width:.4f} {box.height:.4f} re"
