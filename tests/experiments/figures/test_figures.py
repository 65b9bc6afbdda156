"""Charts and cones: what is drawn lies where its values say."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET

import pytest

from padstudio.experiments.figures.chart import Axis, Band, Marks, chart
from padstudio.experiments.figures.space import Cone, Path3, space

SVG = "{http://www.w3.org/2000/svg}"


def dots(data: bytes) -> list[tuple[float, float]]:
    circles = ET.fromstring(data).iter(f"{SVG}circle")
    return [(float(each.get("cx", "")), float(each.get("cy", ""))) for each in circles]


def test_dots_stand_where_their_values_are() -> None:
    marks = Marks("a & b", ((0.0, 0.0), (5.0, 1.0), (10.0, 2.0)))
    found = dots(chart(Axis("x", 0, 10), Axis("y", 0, 2), [marks], [Band(2, 4, "band")]))
    (x0, y0), (x1, y1), (x2, y2) = found
    assert (x1, y1) == pytest.approx(((x0 + x2) / 2, (y0 + y2) / 2), abs=0.11)
    assert x2 > x0
    assert y2 < y0


def test_a_logarithmic_axis_makes_even_ratios_even_lengths() -> None:
    axis = Axis("x", 1, 100, log=True)
    assert axis.share(10) == pytest.approx(0.5)
    assert axis.marked == (1, 2, 5, 10, 20, 50, 100)


@pytest.mark.parametrize(
    ("low", "high", "expected"),
    [(0, 10, (0, 2, 4, 6, 8, 10)), (-0.3, 0.3, (-0.3, -0.2, -0.1, 0, 0.1, 0.2, 0.3))],
)
def test_ticks_are_round(low: float, high: float, expected: tuple[float, ...]) -> None:
    assert Axis("x", low, high).marked == pytest.approx(expected)


def test_what_is_not_there_parts_the_line() -> None:
    points = ((0.0, 1.0), (1.0, 1.0), (2.0, math.nan), (3.0, 1.0), (4.0, 1.0))
    data = chart(Axis("x", 0, 4), Axis("y", 0, 2), [Marks("", points)])
    assert len(dots(data)) == 4
    assert len(list(ET.fromstring(data).iter(f"{SVG}polyline"))) == 2
    assert b"nan" not in data


def test_figures_hold_no_styles_and_no_scripts() -> None:
    cone = Cone((0.0, 0.0, 900.0), (0.0, 0.0, -1.0), 200.0)
    paths = [Path3("<true>", ((0, 0, 900.0), (50, 20, 300.0)))]
    for data in (space(paths, [cone], 1000.0), chart(Axis("<x>", 0, 1), Axis("y", 0, 1), [])):
        names = {element.tag.removeprefix(SVG) for element in ET.fromstring(data).iter()}
        assert names <= {"svg", "rect", "g", "line", "polyline", "polygon", "circle", "text"}
        assert not re.search(rb"style=|href|nan", data)


def test_space_keeps_up_up_and_fits_the_picture() -> None:
    path = Path3("", ((0, 0, 1500.0), (0, 0, 700.0), (0, 0, 100.0)))
    (x0, y0), (x1, y1), (x2, y2) = dots(space([path], square=1250.0))
    assert y0 < y1 < y2
    assert x0 == pytest.approx(x2)
    assert (y1 - y0) / (y2 - y1) == pytest.approx(800 / 600, rel=0.01)
    assert all(0 <= y <= 420 for y in (y0, y1, y2))
    assert 0 <= x1 <= 720
