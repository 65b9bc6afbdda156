from __future__ import annotations

import re
from xml.etree import ElementTree

import numpy as np
import pytest
from measure_print import document, make_pad

from padstudio.pad.layout import layout

SVG = "{http://www.w3.org/2000/svg}"


@pytest.mark.parametrize("options", [{}, {"ratio": 1}, {"levels": 4, "cell_mm": 3.3}])
def test_boxes_paint_every_patch_in_its_colour(options: dict[str, float]) -> None:
    pad = make_pad(quiet_mm=4.5, **options)  # type: ignore[arg-type]
    page = layout(pad)
    root = ElementTree.fromstring(document(pad, "svg").decode())
    assert root.get("width") == f"{page.page_width_mm:g}mm"
    assert root.get("height") == f"{page.page_height_mm:g}mm"
    assert root.get("shape-rendering") == "crispEdges"
    middle_x, middle_y = (page.x_mm[:-1] + page.x_mm[1:]) / 2, (page.y_mm[:-1] + page.y_mm[1:]) / 2
    seen = np.zeros_like(page.colors)
    for path in root.iter(f"{SVG}path"):
        color = np.frombuffer(bytes.fromhex(path.get("fill", "")[1:]), np.uint8)
        for x0, y0, x1, y1 in _boxes(path.get("d", "")):
            rows = (middle_y > y0) & (middle_y < y1)
            cols = (middle_x > x0) & (middle_x < x1)
            seen[np.ix_(rows, cols)] = color
    np.testing.assert_array_equal(seen, page.colors)


def test_name_is_text_not_markup() -> None:
    pad = make_pad(name='<script>&" 🚁 עברית')
    root = ElementTree.fromstring(document(pad, "svg").decode())
    assert root.findtext(f"{SVG}title") == '<script>&" 🚁 עברית'


def _boxes(path: str) -> list[tuple[float, ...]]:
    found = re.findall(r"M(\S+) (\S+)H(\S+)V(\S+)H(\S+)z", path)
    assert all(box[0] == box[4] for box in found)
    return [tuple(map(float, box[:4])) for box in found]
