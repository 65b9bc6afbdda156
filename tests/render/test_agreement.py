"""One layout, many painters: every coordinate that is written is one of the layout's."""

from __future__ import annotations

import re
import zlib

import numpy as np
import pytest
from measure_print import document, make_pad

from padstudio.pad.layout import layout
from padstudio.pad.spec import Pad

# Far below the 0.01 mm that painters must agree to.
MOST_MM = 1e-3


@pytest.fixture(params=[3.7, 10.0, 25.4])
def pad(request: pytest.FixtureRequest) -> Pad:
    return make_pad(quiet_mm=2.2, cell_mm=request.param)


def test_svg(pad: Pad) -> None:
    page = layout(pad)
    # The first path is the page, the first box of the second the base inside the outer cells.
    boxes = re.findall(r"M([\d.]+) ([\d.]+)H([\d.]+)V([\d.]+)", document(pad, "svg").decode())[2:]
    x = [float(value) for x0, _, x1, _ in boxes for value in (x0, x1)]
    y = [float(value) for _, y0, _, y1 in boxes for value in (y0, y1)]
    assert off(x, page.x_mm) < MOST_MM
    assert off(y, page.y_mm) < MOST_MM


def test_dxf(pad: Pad) -> None:
    page = layout(pad)
    text = document(pad, "dxf").decode().split("SEQEND", 1)[1]
    points = re.findall(r"VERTEX\n8\n\w+\n10\n([\d.]+)\n20\n([\d.]+)\n", text)
    assert off([float(x) for x, _ in points], page.x_mm) < MOST_MM
    assert off([page.page_height_mm - float(y) for _, y in points], page.y_mm) < MOST_MM


def test_pdf(pad: Pad) -> None:
    page = layout(pad)
    data = document(pad, "pdf")
    form = next(part for part in data.split(b"stream\n")[1:] if part[:1] == b"\x78")
    content = zlib.decompressobj().decompress(form).decode()
    boxes = np.array(re.findall(r"(\S+) (\S+) (\S+) (\S+) re", content)[1:], float)
    assert off([*boxes[:, 0], *(boxes[:, 0] + boxes[:, 2])], page.x_mm) < MOST_MM
    assert off([*boxes[:, 1], *(boxes[:, 1] + boxes[:, 3])], page.y_mm) < MOST_MM


def off(values: list[float], edges: np.ndarray) -> float:
    """The farthest that any value is from the nearest edge; every edge must be met as well."""
    distance = np.abs(np.asarray(values)[:, None] - edges)
    assert distance.min(axis=0).max() < MOST_MM
    return float(distance.min(axis=1).max())
