"""A layout as a DXF drawing for cutters: closed outlines, one DXF layer a colour."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from padstudio.pad.layout import layout
from padstudio.pad.spec import Pad
from padstudio.render.painters.contours import iter_contours

# AutoCAD colour indices of the colours that have a name; others get the nearest.
_INDEX_COLORS = {
    1: (255, 0, 0),
    2: (255, 255, 0),
    3: (0, 255, 0),
    4: (0, 255, 255),
    5: (0, 0, 255),
    6: (255, 0, 255),
    7: (255, 255, 255),
    8: (128, 128, 128),
    250: (0, 0, 0),
}
# The drawing's layer of the sheet itself.
_SHEET = "SHEET"


def iter_dxf(pad: Pad) -> Iterator[str]:
    """The parts of a DXF drawing (release 12, ASCII) of a pad.

    Lengths are mm, the origin is the bottom left of the quiet margin, y up. Every region of one
    colour is a closed polyline on a layer named after the colour (``FF00FF``), holes as polylines
    of their own; the sheet with its quiet margin is on layer ``SHEET``.

    References
    ----------
    AutoCAD Release 12 Customization Manual, DXF group codes.
    """
    page = layout(pad)
    width, height = page.page_width_mm, page.page_height_mm
    packed = page.colors.astype(np.int64) @ np.array([1 << 16, 1 << 8, 1])
    colors = np.unique(packed).tolist()
    names = {_name(color): _index(color) for color in colors} | {_SHEET: 7}
    yield _head(names, width, height)
    right, top = _number(width), _number(height)
    yield _polyline(_SHEET, [("0", "0"), (right, "0"), (right, top), ("0", top)])
    x = [_number(value) for value in page.x_mm.tolist()]
    y = [_number(height - value) for value in page.y_mm.tolist()]
    for color in colors:
        for contour in iter_contours(packed == color):
            yield _polyline(_name(color), [(x[col], y[row]) for row, col in contour])
    yield _groups((0, "ENDSEC"), (0, "EOF"))


def _head(names: dict[str, int], width: float, height: float) -> str:
    text = _groups(
        *((0, "SECTION"), (2, "HEADER"), (9, "$ACADVER"), (1, "AC1009")),
        *((9, "$INSUNITS"), (70, 4), (9, "$MEASUREMENT"), (70, 1)),
        *((9, "$EXTMIN"), (10, 0.0), (20, 0.0), (9, "$EXTMAX"), (10, width), (20, height)),
        *((0, "ENDSEC"), (0, "SECTION"), (2, "TABLES")),
        *((0, "TABLE"), (2, "LAYER"), (70, len(names))),
    )
    for name, index in names.items():
        text += _groups((0, "LAYER"), (2, name), (70, 0), (62, index), (6, "CONTINUOUS"))
    return text + _groups((0, "ENDTAB"), (0, "ENDSEC"), (0, "SECTION"), (2, "ENTITIES"))


def _polyline(name: str, points: Sequence[tuple[str, str]]) -> str:
    head = f"0\nPOLYLINE\n8\n{name}\n66\n1\n10\n0\n20\n0\n30\n0\n70\n1\n"
    vertex = f"0\nVERTEX\n8\n{name}\n10\n%s\n20\n%s\n30\n0\n"
    return head + "".join([vertex % point for point in points]) + f"0\nSEQEND\n8\n{name}\n"


def _groups(*groups: tuple[int, object]) -> str:
    """Group codes with their values, a line each."""
    return "".join(
        f"{code}\n{_number(value) if isinstance(value, float) else value}\n"
        for code, value in groups
    )


def _number(value: float) -> str:
    return f"{value:.4f}"


def _name(color: int) -> str:
    return f"{color:06X}"


def _index(color: int) -> int:
    rgb = np.array([color >> 16, color >> 8 & 255, color & 255])
    distance = {
        index: int(((rgb - np.array(named)) ** 2).sum()) for index, named in _INDEX_COLORS.items()
    }
    return min(distance, key=lambda index: distance[index])
