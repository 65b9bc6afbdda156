"""Measuring printed pages: an independent renderer, and cell edges located to a part of a pixel."""

from __future__ import annotations

import subprocess
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array
from padstudio.pad.layout import Layout
from padstudio.pad.sheets.tiling import Sheet, SheetPlan
from padstudio.pad.spec import Layer, Pad
from padstudio.render import documents
from padstudio.render.painters.options import PrintOptions


def make_pad(
    rows: int = 20, cols: int = 25, *, ratio: int = 5, cell_mm: float = 10.0, **options: object
) -> Pad:
    """A pad of random fields; `ratio` 1 gives one layer only."""
    rng = np.random.default_rng(7)
    levels = int(options.get("levels", 2))  # type: ignore[call-overload]
    layers = [Layer("red", cell_mm, rng.integers(0, levels, (rows, cols)).astype(np.uint8))]
    if ratio > 1:
        coarse = rng.integers(0, levels, (rows // ratio, cols // ratio)).astype(np.uint8)
        layers.append(Layer("blue", cell_mm * ratio, coarse))
    return Pad(tuple(layers), window=3, **options)  # type: ignore[arg-type]


def document(pad: Pad, form: documents.Form, **options: object) -> bytes:
    """A pad in some form, without its label."""
    asked = PrintOptions(qr=False, **options)  # type: ignore[arg-type]
    return b"".join(documents.make(pad, form, asked)[0])


def pages(pdf: bytes, folder: Path, dpi: float) -> list[NDArray[np.uint8]]:
    """Every page of a PDF as RGB (H, W, 3), rendered by poppler."""
    path = folder / "print.pdf"
    path.write_bytes(pdf)
    command = ["pdftoppm", "-r", str(dpi), str(path), str(folder / "page")]
    subprocess.run(command, check=True, capture_output=True)
    files = sorted(folder.glob("page-*.ppm"))
    out = [_read_ppm(file) for file in files]
    for file in files:
        file.unlink()
    return out


def pdf_info(pdf: bytes, folder: Path, *options: str) -> str:
    """What poppler's pdfinfo says of a PDF."""
    path = folder / "info.pdf"
    path.write_bytes(pdf)
    done = subprocess.run(["pdfinfo", *options, str(path)], check=True, capture_output=True)
    return done.stdout.decode()


def pdf_text(pdf: bytes, folder: Path) -> str:
    """The words of a PDF, as poppler's pdftotext finds them."""
    path = folder / "text.pdf"
    path.write_bytes(pdf)
    done = subprocess.run(["pdftotext", "-layout", str(path), "-"], check=True, capture_output=True)
    return done.stdout.decode()


def edge_errors_mm(image: NDArray[np.uint8], page: Layout, px_per_mm: float) -> Array:
    """Signed errors of every cell edge in a picture of the whole page, both axes, mm.

    Between the middles of two neighbouring patches of levels L and R the integral of the picture
    is L (e - a) + R (b - e), which gives the edge e to a small part of a pixel.
    """
    across = _axis_errors(image, page.x_mm, page.y_mm, page.colors, px_per_mm)
    turned = image.transpose(1, 0, 2), page.y_mm, page.x_mm, page.colors.transpose(1, 0, 2)
    return np.concatenate([across, _axis_errors(*turned, px_per_mm)])


def cut_marks(
    tile: NDArray[np.uint8], sheet: Sheet, px_per_mm: float
) -> tuple[float, float, float, float]:
    """Left, top, right and bottom of a sheet's core, mm, from the marks' dark middles alone."""
    dark = 255.0 - tile.min(axis=2)
    x0, y0 = sheet.x_mm, sheet.y_mm
    x1, y1 = x0 + sheet.core.width, y0 + sheet.core.height
    beyond_x, beyond_y = x0 + sheet.painted.width, y0 + sheet.painted.height

    def middle(x: float, y: float, axis: int) -> float:
        """Centre of darkness along an axis in a window of 2 mm round a point."""
        top, left = round((y - 1) * px_per_mm), round((x - 1) * px_per_mm)
        side = round(2 * px_per_mm)
        profile = dark[top : top + side, left : left + side].sum(axis=1 - axis)
        centre = (np.arange(len(profile)) + 0.5) @ profile / profile.sum()
        return float(centre + (top, left)[axis]) / px_per_mm

    left = (middle(x0, y0 - 2.5, 1) + middle(x0, beyond_y + 2.5, 1)) / 2
    right = (middle(x1, y0 - 2.5, 1) + middle(x1, beyond_y + 2.5, 1)) / 2
    top = (middle(x0 - 2.5, y0, 0) + middle(beyond_x + 2.5, y0, 0)) / 2
    bottom = (middle(x0 - 2.5, y1, 0) + middle(beyond_x + 2.5, y1, 0)) / 2
    return left, top, right, bottom


def assemble(
    plan: SheetPlan, tiles: list[NDArray[np.uint8]], px_per_mm: float
) -> NDArray[np.uint8]:
    """The whole page from pictures of its sheets, cut at their marks and laid side by side."""
    width, height = (round(side * px_per_mm) for side in (plan.page_width_mm, plan.page_height_mm))
    out = np.full((height, width, 3), 255, np.uint8)
    across, down = [0.0] * plan.rows, [0.0] * plan.cols
    for sheet, tile in zip(plan.sheets, tiles, strict=True):
        left, top, right, bottom = cut_marks(tile, sheet, px_per_mm)
        x, y = across[sheet.row], down[sheet.col]
        across[sheet.row], down[sheet.col] = x + right - left, y + bottom - top
        x0, y0 = round(x * px_per_mm), round(y * px_per_mm)
        size = (
            round(across[sheet.row] * px_per_mm) - x0,
            round(down[sheet.col] * px_per_mm) - y0,
        )
        shift = np.array([[1, 0, (x - left) * px_per_mm - x0], [0, 1, (y - top) * px_per_mm - y0]])
        part = cv2.warpAffine(tile, shift, size)[: height - y0, : width - x0]
        out[y0 : y0 + part.shape[0], x0 : x0 + part.shape[1]] = part
    return out


def _axis_errors(
    image: NDArray[np.uint8], x_mm: Array, y_mm: Array, colors: NDArray[np.uint8], scale: float
) -> Array:
    middle_y = (y_mm[:-1] + y_mm[1:]) / 2 * scale
    middle_x = (x_mm[:-1] + x_mm[1:]) / 2 * scale
    lines = image[np.clip(middle_y.astype(int), 0, image.shape[0] - 1)].astype(float)
    area = np.zeros((len(lines), lines.shape[1] + 1, 3))
    np.cumsum(lines, axis=1, out=area[:, 1:])
    whole = np.minimum(middle_x.astype(int), lines.shape[1] - 1)
    at = area[:, whole] + (middle_x - whole)[None, :, None] * lines[:, whole]
    integral = np.diff(at, axis=1)
    left, right = colors[:, :-1].astype(float), colors[:, 1:].astype(float)
    a, b = middle_x[None, :-1, None], middle_x[None, 1:, None]
    differ = np.abs(left - right) > 100
    with np.errstate(divide="ignore", invalid="ignore"):
        edge = (integral - right * b + left * a) / (left - right)
    truth = (x_mm[1:-1] * scale)[None, :, None]
    return np.asarray(((edge - truth) / scale)[differ])


def _read_ppm(path: Path) -> NDArray[np.uint8]:
    data = path.read_bytes()
    magic, width, height, most = data.split(maxsplit=4)[:4]
    assert (magic, most) == (b"P6", b"255")
    size = int(width) * int(height) * 3
    return np.frombuffer(data[-size:], np.uint8).reshape(int(height), int(width), 3)
