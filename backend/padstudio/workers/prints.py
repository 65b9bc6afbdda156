"""Paints a pad as a file, and reads a photo of the test strip: in a worker process."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from padstudio.errors import LimitError
from padstudio.media import images
from padstudio.pad.spec import Channel, Pad
from padstudio.render import documents
from padstudio.render.painters.options import PrintOptions

_MM_PER_INCH = 25.4


def paint(
    content: str,
    form: documents.Form,
    options: PrintOptions,
    channel: Channel | None,
    max_pixels: int,
    target: Path,
) -> str:
    """Paint a pad file's pad.

    Parameters
    ----------
    content : str
        The pad file.
    form : str
        One of `padstudio.render.documents.FORMS`.
    options : PrintOptions
    channel : str or None
        Of a table.
    max_pixels : int
        Limit on a PNG.
    target : Path
        The file to write.

    Returns
    -------
    str
        The media type.

    Raises
    ------
    LimitError
        If the PNG would have more pixels.
    SpecError
        As `padstudio.render.documents.make`.
    """
    pad = Pad.loads(content)
    if form == "png":
        _check_pixels(pad, options.dpi, max_pixels)
    pieces, media_type, _ = documents.make(pad, form, options, channel=channel)
    with target.open("wb") as out:
        out.writelines(pieces)
    return media_type


def read_strip(photo: bytes, max_pixels: int) -> dict[str, Any]:
    """The mixture of colours from a photo of the test strip, JSON-serialisable.

    With ``usable``: whether frames can be un-mixed by it.

    Raises
    ------
    ImageError, LimitError
        If the photo cannot be read, or the strip is not in it.
    """
    from padstudio.vision.strip_photo import estimate_crosstalk

    found = estimate_crosstalk(images.decode(photo, max_pixels))
    return {
        "matrix": found.matrix.round(5).tolist(),
        "offset": found.offset.round(5).tolist(),
        "residual": round(found.residual, 5),
        "red_separation": round(found.red_separation, 4),
        "blue_separation": round(found.blue_separation, 4),
        "warnings": list(found.warnings),
        "usable": found.usable,
    }


def _check_pixels(pad: Pad, dpi: float, max_pixels: int) -> None:
    sides_px = [
        (side + 2 * pad.quiet_mm) * dpi / _MM_PER_INCH for side in (pad.width_mm, pad.height_mm)
    ]
    pixels = sides_px[0] * sides_px[1]
    if pixels > max_pixels:
        most = dpi * (max_pixels / pixels) ** 0.5
        raise LimitError(
            f"at {dpi:g} dpi the PNG has {pixels / 1e6:.0f} megapixels, the limit is "
            f"{max_pixels / 1e6:g}: take at most {most:.0f} dpi, or the PDF or SVG",
            code="too_many_pixels",
        )
