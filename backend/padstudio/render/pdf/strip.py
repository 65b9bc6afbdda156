"""The colour test strip as a PDF sheet."""

from __future__ import annotations

from typing import BinaryIO

import cv2

from padstudio.errors import SpecError
from padstudio.pad.sheets import strip
from padstudio.pad.sheets.paper import Bands, Box, parse_paper
from padstudio.render.painters.options import PrintOptions
from padstudio.render.pdf.furniture import draw_rulers
from padstudio.render.pdf.page import open_canvas
from padstudio.render.pdf.pen import Pen

# Cells of a marker of DICT_4X4_50, its dark border included.
_MARKER_CELLS = 6
_TITLE = "Colour test strip"
_ADVICE = (
    "Print it like the pad: same printer, paper and settings.",
    "Photograph it flat, evenly lit, not too bright, with the camera that will fly.",
)


def write_strip(out: BinaryIO, options: PrintOptions | None = None) -> None:
    """Write the test strip as a PDF of one sheet at true scale; A4 unless a paper is named.

    Raises
    ------
    SpecError
        If the strip does not go onto the paper.
    """
    options = options or PrintOptions()
    wanted = options.sheets.paper.strip().lower()
    paper = parse_paper("A4" if wanted == "own" else wanted)
    margin = max(options.sheets.margin_mm, 5.0)
    left, top = margin + Bands().left, margin + 30.0
    if paper.width_mm < left + strip.WIDTH_MM + margin:
        paper = paper.turned()
    if (
        paper.width_mm < left + strip.WIDTH_MM + margin
        or paper.height_mm < top + strip.HEIGHT_MM + 20 + margin
    ):
        raise SpecError(
            f"the test strip needs {strip.WIDTH_MM:g} x {strip.HEIGHT_MM:g} mm beside rulers and "
            f"margins; {paper.name} is too small"
        )
    pen = open_canvas(out, paper.width_mm, paper.height_mm, options.ink)
    pen.canvas.setTitle(_TITLE)
    pen.start_page(options.measured)
    pen.text(left, margin + 8.0, _TITLE, 6.0)
    for number, line in enumerate(_ADVICE):
        pen.text(left, margin + 15.0 + 5.0 * number, line, 3.4)
    draw_rulers(pen, paper, margin)
    with pen.moved(left, top):
        draw_strip(pen)
    pen.canvas.showPage()
    pen.canvas.save()


def draw_strip(pen: Pen) -> None:
    """Markers, patches and their names; strip coordinates."""
    for number, (x, y) in enumerate(strip.MARKER_CORNERS_MM):
        _draw_marker(pen, number, x, y)
    for patch in strip.PATCHES:
        pen.fill(patch.box, patch.rgb)
        pen.text(patch.box.x0, patch.box.y1 + 3.0, patch.name, 2.4)


def _draw_marker(pen: Pen, number: int, x0: float, y0: float) -> None:
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    cells = cv2.aruco.generateImageMarker(dictionary, number, _MARKER_CELLS)
    side = strip.MARKER_MM / _MARKER_CELLS
    pen.fill(Box(x0, y0, x0 + strip.MARKER_MM, y0 + strip.MARKER_MM), (0, 0, 0))
    for row, line in enumerate(cells):
        for col, value in enumerate(line):
            if value:
                x, y = x0 + col * side, y0 + row * side
                pen.fill(Box(x, y, x + side, y + side), (255, 255, 255))
