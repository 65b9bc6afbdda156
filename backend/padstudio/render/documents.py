"""Every form that a pad can be had in, by name: what the command line and the server call."""

from __future__ import annotations

import re
import tempfile
import unicodedata
from collections.abc import Callable, Iterator
from typing import Any, BinaryIO, Literal, get_args

from padstudio.errors import SpecError, shown
from padstudio.pad.spec import Channel, Pad
from padstudio.render.painters.options import PrintOptions

Form = Literal["pdf", "svg", "png", "dxf", "csv", "npy", "strip"]
FORMS: tuple[Form, ...] = get_args(Form)

MEDIA_TYPES: dict[str, str] = {
    "pdf": "application/pdf",
    "svg": "image/svg+xml",
    "png": "image/png",
    "dxf": "image/vnd.dxf",
    "csv": "text/csv",
    "npy": "application/octet-stream",
    "zip": "application/zip",
}
# A piece handed to the network or the disk at a time.
_CHUNK_BYTES = 1 << 16
# Smaller documents stay in memory while they are handed over.
_SPOOL_BYTES = 8 << 20


def make(
    pad: Pad, form: Form, options: PrintOptions | None = None, *, channel: Channel | None = None
) -> tuple[Iterator[bytes], str, str]:
    """A pad in some form, ready to be sent or saved.

    Everything that can be wrong with the request is found here, before the first byte.

    Parameters
    ----------
    pad : Pad
    form : str
        One of `FORMS`: ``pdf`` is spread over `options.sheets`; ``png`` has `options.dpi`;
        ``strip`` is the colour test strip; ``csv`` and ``npy`` hold the fields.
    options : PrintOptions, optional
    channel : str, optional
        The layer that ``csv`` and ``npy`` are wanted of; a zip file holds all layers where there
        are more than one and none is named.

    Returns
    -------
    iterator of bytes, str, str
        The content, its media type and a file name in ASCII.

    Raises
    ------
    SpecError, LimitError
        If the form is unknown, or the pad does not go with the options.
    """
    options = options or PrintOptions()
    if form not in FORMS:
        raise SpecError(f"{shown(form)} is no form of a pad; use {', '.join(FORMS)}")
    suffix: str = "pdf" if form == "strip" else form
    if form == "csv" or form == "npy":
        write, suffix = _tables(pad, form, channel)
    else:
        write = _painter(pad, form, options)
    name = file_stem(pad.name) + ("-strip" if form == "strip" else "")
    return _spooled(write), MEDIA_TYPES[suffix], f"{name}.{suffix}"


def file_stem(name: str) -> str:
    """A file name without its suffix, in ASCII, from any pad's name."""
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
    return re.sub(r"[^A-Za-z0-9._-]+", "-", plain).strip("-.")[:80] or "pad"


def _painter(pad: Pad, form: str, options: PrintOptions) -> Callable[[BinaryIO], object]:
    # Imported here: each painter brings its own libraries.
    if form == "pdf":
        from padstudio.render.pdf.sheets import write_sheets

        return lambda out: write_sheets(pad, out, options)
    if form == "strip":
        from padstudio.render.pdf.strip import write_strip

        return lambda out: write_strip(out, options)
    if form == "png":
        from padstudio.render.painters.raster import write_png

        return lambda out: write_png(pad, out, dpi=options.dpi)
    if form == "svg":
        from padstudio.render.painters.svg import iter_svg

        return lambda out: out.writelines(part.encode() for part in iter_svg(pad))
    from padstudio.render.painters.dxf import iter_dxf

    return lambda out: out.writelines(part.encode() for part in iter_dxf(pad))


def _tables(
    pad: Pad, form: Literal["csv", "npy"], channel: Channel | None
) -> tuple[Callable[[BinaryIO], object], str]:
    from padstudio.render.painters.field_tables import write_table, write_tables

    layer = pad.layers[0] if channel is None else pad.layer(channel)
    if layer is None:
        raise SpecError(
            f"the pad has no {channel} layer; it has "
            f"{', '.join(layer.channel for layer in pad.layers)}"
        )
    if channel is None and len(pad.layers) > 1:
        return lambda out: out.write(write_tables(pad, form)), "zip"
    return lambda out: out.write(write_table(layer, form)), form


def _spooled(write: Callable[[BinaryIO], object]) -> Iterator[bytes]:
    """Write a document now, on disk where it is large, and hand it over in pieces."""
    spool: Any = tempfile.SpooledTemporaryFile(_SPOOL_BYTES)  # noqa: SIM115 - closed by the iterator
    try:
        write(spool)
    except BaseException:
        spool.close()
        raise
    spool.seek(0)

    def pieces() -> Iterator[bytes]:
        with spool:
            while piece := spool.read(_CHUNK_BYTES):
                yield piece

    return pieces()
