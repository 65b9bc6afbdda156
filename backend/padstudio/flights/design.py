"""Makes and reads pads in a worker process."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from padstudio.pad import coding, verify
from padstudio.pad import files as pad_files
from padstudio.pad.spec import Pad


@dataclass(frozen=True)
class Design:
    """A pad, ready to be stored or shown.

    Attributes
    ----------
    content : str
        The pad file.
    summary : mapping
        What lists show of it.
    verification : mapping or None
        What `padstudio.pad.verify` found of the finest layer; None where nobody asked.
    """

    content: str
    summary: Mapping[str, Any]
    verification: Mapping[str, Any] | None = None


def generate(spec: Mapping[str, Any], budget_s: float) -> Design:
    """Generate a pad.

    Parameters
    ----------
    spec : mapping
        Arguments of `padstudio.pad.coding.generate_pad`.
    budget_s : float
        Time for the search, s.

    Raises
    ------
    SpecError, SearchExhaustedError
        As `generate_pad`.
    """
    pad = coding.generate_pad(**spec, budget_s=budget_s)
    finest = max(pad.layers, key=lambda layer: layer.field.size)
    found = verify.verify_field(finest.field, pad.window, pad.levels)
    return Design(pad_files.dumps(pad), summarize(pad), found.to_dict())


def read(content: bytes) -> Design:
    """Read an imported pad file; raises `PadFormatError` with the place and the reason."""
    pad = pad_files.loads(content)
    return Design(pad_files.dumps(pad), summarize(pad))


def summarize(pad: Pad) -> dict[str, Any]:
    """What lists show of a pad, JSON-serialisable."""
    return {
        "name": pad.name,
        "window": pad.window,
        "levels": pad.levels,
        "size_mm": list(pad.size_mm),
        "layers": [
            {
                "channel": layer.channel,
                "rows": layer.rows,
                "cols": layer.cols,
                "cell_mm": layer.cell_mm,
            }
            for layer in pad.layers
        ],
        "seed": pad.seed,
        "method": pad.method,
        "unique": pad.unique,
        "distance": pad.distance,
    }
