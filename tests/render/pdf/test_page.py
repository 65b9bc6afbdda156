from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest
from measure_print import document, edge_errors_mm, make_pad, pages, pdf_info
from numpy.typing import NDArray

from padstudio.pad.identity import describe
from padstudio.pad.layout import layout
from padstudio.render.painters import raster


@pytest.mark.parametrize(("dpi", "most_mm"), [(72, 0.09), (150, 0.05), (203.2, 0.05)])
def test_cell_edges_are_where_the_layout_says(dpi: float, most_mm: float, tmp_path: Path) -> None:
    pad = make_pad(30, 40, quiet_mm=7.3)
    (image,) = pages(document(pad, "pdf"), tmp_path, dpi)
    errors = edge_errors_mm(image, layout(pad), dpi / 25.4)
    assert len(errors) > 1200
    assert np.abs(errors).max() < most_mm


@pytest.mark.parametrize("levels", [2, 5])
@pytest.mark.parametrize("dpi", [31.7, 47.3])
def test_no_seam_shows_between_cells(levels: int, dpi: float, tmp_path: Path) -> None:
    """Every pixel lies between the extreme colours of the cells that it touches."""
    pad = make_pad(20, 25, levels=levels, quiet_mm=5.3)
    (image,) = pages(document(pad, "pdf"), tmp_path, dpi)
    fine = raster.paint(pad, dpi / 25.4 * 8)
    # Poppler paints edges to a quarter of a pixel.
    quarter = np.ones((5, 5), np.uint8)
    low, high = _per_pixel(cv2.erode(fine, quarter)), _per_pixel(cv2.dilate(fine, quarter))
    shown = image[: len(low), : len(low[0]), None, :]
    seams = (shown < low.min(axis=2, keepdims=True) - 2) | (
        shown > high.max(axis=2, keepdims=True) + 2
    )
    # Where four cells meet, a single pixel may miss by a little.
    assert seams.mean() < 2e-3


def _per_pixel(fine: NDArray[np.uint8]) -> NDArray[np.int64]:
    """The 64 sub-pixels of each pixel, (H, W, 64, 3)."""
    height, width = fine.shape[0] // 8, fine.shape[1] // 8
    blocks = fine[: height * 8, : width * 8].reshape(height, 8, width, 8, 3)
    return blocks.transpose(0, 2, 1, 3, 4).reshape(height, width, 64, 3).astype(np.int64)


def test_page_has_the_pads_size_and_metadata(tmp_path: Path) -> None:
    pad = make_pad(seed=42, name="Hof 3 🚁", quiet_mm=10.0)
    data = document(pad, "pdf")
    info = pdf_info(data, tmp_path)
    assert "Hof 3 🚁" in info
    keywords = next(line for line in info.splitlines() if line.startswith("Keywords:"))
    spec = json.loads(keywords.removeprefix("Keywords:"))
    assert spec == describe(pad)
    assert spec["seed"] == 42
    width, height = (float(word) for word in info.split("Page size:")[1].split()[0:3:2])
    assert width == pytest.approx(270 / 25.4 * 72, abs=0.01)
    assert height == pytest.approx(220 / 25.4 * 72, abs=0.01)
    assert b"/PrintScaling /None" in data


def test_equal_pads_give_equal_files() -> None:
    assert document(make_pad(), "pdf") == document(make_pad(), "pdf")


def test_inks_are_cmyk_on_request(tmp_path: Path) -> None:
    pad = make_pad(15, 15)
    (image,) = pages(document(pad, "pdf", ink="cmyk"), tmp_path, 25.4)
    page = layout(pad)
    for row, col in np.ndindex(page.colors.shape[:2]):
        printed = image[row * 10 + 5, col * 10 + 5].astype(int)
        wanted = page.colors[row, col] > 127
        assert (printed[wanted] > 30).all()
        assert (printed[wanted].min(initial=255) > printed[~wanted].max(initial=0)) or not (
            wanted.any()
        )
