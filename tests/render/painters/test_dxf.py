from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from measure_print import document, make_pad

from padstudio.pad.layout import layout

Points = list[tuple[float, float]]


@pytest.mark.parametrize("options", [{}, {"levels": 4, "cell_mm": 3.3}])
def test_regions_cover_each_colour_and_no_more(options: dict[str, float]) -> None:
    pad = make_pad(quiet_mm=4.5, **options)  # type: ignore[arg-type]
    page = layout(pad)
    drawing = _read(document(pad, "dxf").decode())
    sheet = drawing.pop("SHEET")
    w, h = page.page_width_mm, page.page_height_mm
    assert sheet == [[(0, 0), (w, 0), (w, h), (0, h)]]
    area = np.outer(np.diff(page.y_mm), np.diff(page.x_mm))
    for name, outlines in drawing.items():
        color = np.frombuffer(bytes.fromhex(name), np.uint8)
        wanted = area[(page.colors == color).all(axis=2)].sum()
        # Outer outlines run clockwise, holes counter to it: signed areas add up.
        assert sum(map(_area, outlines)) == pytest.approx(wanted, rel=1e-6)


def test_outlines_run_along_cell_edges_from_the_bottom_left() -> None:
    pad = make_pad(quiet_mm=4.5)
    page = layout(pad)
    x_edges = page.x_mm
    y_edges = page.page_height_mm - page.y_mm
    for outlines in _read(document(pad, "dxf").decode()).values():
        for x, y in outlines[0]:
            on_page = x in (0, page.page_width_mm) and y in (0, page.page_height_mm)
            assert on_page or (
                np.abs(x_edges - x).min() < 1e-3 and np.abs(y_edges - y).min() < 1e-3
            )


def test_drawing_declares_millimetres_and_its_layers() -> None:
    text = document(make_pad(), "dxf").decode()
    assert "$INSUNITS\n70\n4\n" in text
    for name in ("SHEET", "000000", "FF0000", "0000FF", "FF00FF"):
        assert f"0\nLAYER\n2\n{name}\n" in text
    assert text.endswith("0\nENDSEC\n0\nEOF\n")


def _read(text: str) -> dict[str, list[Points]]:
    """Closed polylines by layer."""
    lines = text.split("\n")[:-1]
    groups = list(zip(map(int, lines[::2]), lines[1::2], strict=True))
    out: dict[str, list[Points]] = {}
    entity = ""
    for (code, value), (_, x) in pairwise([*groups, (0, "")]):
        if code == 0:
            entity = value
        elif code == 8 and entity == "POLYLINE":
            out.setdefault(value, []).append([])
            layer = value
        elif code == 10 and entity == "VERTEX":
            out[layer][-1].append((float(value), float(x)))
    return out


def _area(points: Points) -> float:
    x, y = np.array(points).T
    return float(((np.roll(x, -1) * y) - (x * np.roll(y, -1))).sum() / 2)
