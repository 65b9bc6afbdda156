"""A layout as an SVG drawing in millimetres."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

from padstudio.pad.layout import layout
from padstudio.pad.spec import Pad
from padstudio.render.painters.rectangles import iter_shapes


def iter_svg(pad: Pad) -> Iterator[str]:
    """The parts of an SVG of a pad, quiet margin included, of its nominal size: one a colour."""
    page = layout(pad)
    width, height = _number(page.page_width_mm), _number(page.page_height_mm)
    yield (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}mm" height="{height}mm" '
        f'viewBox="0 0 {width} {height}" shape-rendering="crispEdges">\n'
        f"<title>{escape(_printable(pad.name))}</title>\n"
        f'<path fill="#ffffff" d="M0 0H{width}V{height}H0z"/>\n'
    )
    for shapes in iter_shapes(page, seams=False):
        path = "".join(_box(*box) for box in shapes.boxes_mm.tolist())
        yield '<path fill="#{:02x}{:02x}{:02x}" '.format(*shapes.color) + f'd="{path}"/>\n'
    yield "</svg>\n"


def _box(x0: float, y0: float, x1: float, y1: float) -> str:
    return f"M{_number(x0)} {_number(y0)}H{_number(x1)}V{_number(y1)}H{_number(x0)}z"


def _number(value: float) -> str:
    """A length in mm to a tenth of a micrometre, as short as it can be."""
    return f"{value:.4f}".rstrip("0").rstrip(".")


def _printable(text: str) -> str:
    """The text without control characters, which XML does not allow."""
    return "".join(char for char in text if char.isprintable())
