"""Paints a pad as a file, in a worker process."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from padstudio.errors import LimitError
from padstudio.pad import files as pad_files
from padstudio.pad.spec import Pad

Kind = Literal["pdf", "svg", "png"]
MEDIA_TYPES = {"pdf": "application/pdf", "svg": "image/svg+xml", "png": "image/png"}
DEFAULT_DPI = 96.0
_MM_PER_INCH = 25.4


def paint(content: str, kind: Kind, dpi: float, max_pixels: int, target: Path) -> None:
    """Paint a pad file's pad at its true size.

    Parameters
    ----------
    content : str
        The pad file.
    kind : {"pdf", "svg", "png"}
    dpi : float
        Resolution of a PNG.
    max_pixels : int
        Limit on a PNG.
    target : Path
        The file to write.

    Raises
    ------
    LimitError
        If the PNG would have more pixels.
    """
    pad = pad_files.loads(content)
    if kind == "png":
        _check_pixels(pad, dpi, max_pixels)
    with target.open("wb") as out:
        if kind == "pdf":
            from padstudio.render.pdf import write_pdf

            write_pdf(pad, out)
        elif kind == "svg":
            from padstudio.render.svg import iter_svg

            out.writelines(part.encode() for part in iter_svg(pad))
        else:
            from padstudio.render.raster import write_png

            write_png(pad, out, dpi=dpi)


def _check_pixels(pad: Pad, dpi: float, max_pixels: int) -> None:
    sides_px = [(side + 2 * pad.quiet_mm) * dpi / _MM_PER_INCH for side in pad.size_mm]
    pixels = sides_px[0] * sides_px[1]
    if pixels > max_pixels:
        most = dpi * (max_pixels / pixels) ** 0.5
        raise LimitError(
            f"at {dpi:g} dpi the PNG has {pixels / 1e6:.0f} megapixels, the limit is "
            f"{max_pixels / 1e6:g}: take at most {most:.0f} dpi, or the PDF or SVG",
            code="too_many_pixels",
        )
