"""A layout as pixels: an RGB array, or a PNG file that knows its size on paper."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from padstudio.arrays import Array, Image
from padstudio.errors import LimitError, SpecError
from padstudio.pad.layout import Layout, layout
from padstudio.pad.spec import Pad

#: The most pixels of a picture that is held in memory, and of one that is written band by band.
MAX_ARRAY_PIXELS = 200_000_000
MAX_FILE_PIXELS = 1_000_000_000
# Of the picture in memory at a time.
_BAND_BYTES = 4_000_000


def paint(pad: Pad, px_per_mm: float) -> Image:
    """Paint a pad, quiet margin included.

    A pixel holds the mean colour of its area, so that an edge between two pixels keeps its place;
    edges on pixel boundaries are crisp.

    Parameters
    ----------
    pad : Pad
    px_per_mm : float
        Pixels a millimetre of the nominal size.

    Returns
    -------
    (H, W, 3) uint8
        RGB; pixel (0, 0) covers the page's top left corner. A last pixel that the page only
        partly fills is white for the rest.

    Raises
    ------
    SpecError, LimitError
        If the resolution is not positive, or the picture beyond `MAX_ARRAY_PIXELS`.
    """
    page = layout(pad)
    width, height = _size_px(page, px_per_mm, MAX_ARRAY_PIXELS)
    out = np.empty((height, width, 3), np.uint8)
    top = 0
    for band in _bands(page, px_per_mm, width, height):
        out[top : top + len(band)] = band
        top += len(band)
    return out


def write_png(pad: Pad, out: BinaryIO, *, dpi: float) -> None:
    """Write the pad as an RGB PNG, band by band, with the resolution in its pHYs chunk.

    PNG counts whole pixels a metre; the picture is painted at that rounded resolution, so that
    size in pixels and pHYs give the true size.

    Parameters
    ----------
    pad : Pad
    out : binary file open for writing
    dpi : float
        Pixels an inch.

    Raises
    ------
    SpecError, LimitError
        If `dpi` is not positive, or the picture beyond `MAX_FILE_PIXELS`.

    References
    ----------
    Portable Network Graphics (PNG) Specification, ISO/IEC 15948:2004.
    """
    per_metre = _pixels_per_metre(dpi)
    page = layout(pad)
    width, height = _size_px(page, per_metre / 1000, MAX_FILE_PIXELS)
    out.write(b"\x89PNG\r\n\x1a\n")
    _chunk(out, b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
    _chunk(out, b"sRGB", b"\0")
    _chunk(out, b"pHYs", struct.pack(">IIB", per_metre, per_metre, 1))
    packer = zlib.compressobj(6)
    above = np.zeros((1, width * 3), np.uint8)
    for band in _bands(page, per_metre / 1000, width, height):
        rows = band.reshape(len(band), -1)
        # Filter "up": most rows equal the one above them and become zeros.
        filtered = np.empty((len(rows), 1 + rows.shape[1]), np.uint8)
        filtered[:, 0] = 2
        filtered[:, 1:] = rows - np.concatenate([above, rows[:-1]])
        above = rows[-1:]
        if data := packer.compress(filtered.tobytes()):
            _chunk(out, b"IDAT", data)
    _chunk(out, b"IDAT", packer.flush())
    _chunk(out, b"IEND", b"")


def _pixels_per_metre(dpi: float) -> int:
    if not (np.isfinite(dpi) and 1 <= dpi <= 100_000):
        raise SpecError(f"dpi is {dpi}; give a resolution of 1 … 100000 pixels an inch")
    return round(dpi / 0.0254)


def _size_px(page: Layout, px_per_mm: float, limit: int) -> tuple[int, int]:
    """Width and height in pixels that hold the page."""
    if not (np.isfinite(px_per_mm) and px_per_mm > 0):
        raise SpecError(f"px_per_mm is {px_per_mm}; give a resolution above 0")
    size = np.array([page.page_width_mm, page.page_height_mm]) * px_per_mm
    width, height = np.maximum(np.ceil(size - 1e-6), 1)
    if width * height > limit:
        raise LimitError(
            f"{width:.0f} x {height:.0f} pixels are beyond the limit of {limit}; lower the "
            "resolution, or take a vector form (PDF, SVG)"
        )
    return int(width), int(height)


def _chunk(out: BinaryIO, kind: bytes, data: bytes) -> None:
    out.write(struct.pack(">I", len(data)) + kind + data)
    out.write(struct.pack(">I", zlib.crc32(kind + data)))


def _bands(page: Layout, px_per_mm: float, width: int, height: int) -> Iterator[Image]:
    """The picture from top to bottom in bands (h, W, 3) uint8 of bounded size."""
    # The quiet margin, and what lies beyond the page in the last pixel, are white patches.
    colors = np.pad(page.colors, ((1, 1), (1, 1), (0, 0)), constant_values=255)
    x = np.concatenate([[0.0], page.x_mm * px_per_mm, [width + 1.0]])
    y = np.concatenate([[0.0], page.y_mm * px_per_mm, [height + 1.0]])
    rows = max(1, _BAND_BYTES // (width * 3))
    for top in range(0, height, rows):
        bottom = min(top + rows, height)
        first = max(int(np.searchsorted(y, top)) - 1, 0)
        last = int(np.searchsorted(y, bottom))
        weights = _overlap(np.arange(top, bottom), y[first : last + 1])
        # Pixel rows inside one row of patches are alike: paint each kind once.
        kinds, kind_of = np.unique(weights, axis=0, return_inverse=True)
        lines = np.tensordot(kinds, colors[first:last].astype(float), axes=1)
        yield _paint_lines(lines, x, width)[kind_of.reshape(-1)]


def _overlap(pixels: NDArray[np.int_], edges: Array) -> Array:
    """(h, R): the part of each pixel [p, p + 1] that each patch between two edges covers."""
    start = np.maximum(pixels[:, None], edges[None, :-1])
    end = np.minimum(pixels[:, None] + 1, edges[None, 1:])
    # Rounded, so that edges which meet a pixel's boundary but for the last bits are crisp.
    covered: Array = np.round(np.maximum(end - start, 0.0), 9)
    return covered


def _paint_lines(lines: Array, edges: Array, width: int) -> Image:
    """Mean colours (h, W, 3) uint8 of pixels along lines (h, C, 3) of patches."""
    area = np.zeros((lines.shape[0], lines.shape[1] + 1, 3))
    np.cumsum(lines * np.diff(edges)[None, :, None], axis=1, out=area[:, 1:])
    at = np.arange(width + 1.0)
    patch = np.searchsorted(edges, at, side="right") - 1
    passed = area[:, patch] + (at - edges[patch])[None, :, None] * lines[:, patch]
    return np.round(np.diff(passed, axis=1)).astype(np.uint8)
