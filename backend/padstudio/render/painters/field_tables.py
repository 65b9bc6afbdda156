"""The fields of a pad as tables: CSV and NumPy files."""

from __future__ import annotations

import io
import zipfile
from typing import Literal

import numpy as np

from padstudio.pad.spec import Layer, Pad

TableForm = Literal["csv", "npy"]
# Zip files hold a date; a fixed one makes equal pads give equal files.
_DATE = (1980, 1, 1, 0, 0, 0)


def write_table(layer: Layer, form: TableForm) -> bytes:
    """One layer's levels (rows, cols): lines of numbers with commas, or a NumPy array file."""
    out = io.BytesIO()
    if form == "npy":
        np.save(out, layer.field, allow_pickle=False)
    else:
        np.savetxt(out, layer.field, fmt="%d", delimiter=",")
    return out.getvalue()


def write_tables(pad: Pad, form: TableForm) -> bytes:
    """A zip file with one table a layer, named after its channel."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for layer in pad.layers:
            entry = zipfile.ZipInfo(f"{layer.channel}.{form}", _DATE)
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, write_table(layer, form))
    return out.getvalue()
