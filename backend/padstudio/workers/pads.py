"""Makes and reads pads in a worker process."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from padstudio.pad.coding import field_tables, verify
from padstudio.pad.coding.generate import PadSpec, any_seed, generate_pad
from padstudio.pad.crosstalk import Matrix, separation, separation_warnings
from padstudio.pad.spec import Layer, Pad


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
        What `padstudio.pad.coding.verify` found of the finest layer, with its ``channel``; in
        ``others`` whether the other layers are unique. None where nobody asked.
    """

    content: str
    summary: Mapping[str, Any]
    verification: Mapping[str, Any] | None = None


def generate(spec: Mapping[str, Any], budget_s: float) -> Design:
    """Generate a pad.

    Parameters
    ----------
    spec : mapping
        Attributes of a `padstudio.pad.coding.generate.PadSpec`; without a seed, one is drawn.
    budget_s : float
        Time for the search, s.

    Raises
    ------
    SpecError, SearchExhaustedError
        As `generate_pad`.
    """
    asked = PadSpec(**{**spec, "seed": any_seed(spec.get("seed"))})
    pad = generate_pad(asked, budget_s=budget_s)
    return Design(pad.dumps(), summarize(pad), _verify(pad))


def verify_content(content: str) -> dict[str, Any]:
    """What holds for a pad file's layers, as `Design.verification`."""
    return _verify(Pad.loads(content))


@dataclass(frozen=True)
class TableSizes:
    """What a table or a picture of one pixel a cell does not say of its pad.

    Attributes
    ----------
    name : str
    window : int
    levels : int or None
        None takes as many as occur.
    cell_mm : float
    ratio : int
        As of `padstudio.pad.coding.generate.PadSpec`.
    quiet_mm : float
    """

    name: str = "pad"
    window: int = 5
    levels: int | None = None
    cell_mm: float = 10.0
    ratio: int = 1
    quiet_mm: float = 0.0


def read(content: bytes, suffix: str = ".json", sizes: TableSizes | None = None) -> Design:
    """Read an imported file: a pad file, or by its suffix a table or picture of the red layer.

    Parameters
    ----------
    content : bytes
    suffix : str
        Of the file's name, in small letters; none is taken for a pad file's.
    sizes : TableSizes, optional
        Of a table or picture.

    Raises
    ------
    PadFormatError
        With the place and the reason.
    """
    if suffix in ("", ".json"):
        pad = Pad.loads(content)
    else:
        pad = _of_table(content, suffix, sizes or TableSizes())
    return Design(pad.dumps(), summarize(pad))


def _of_table(content: bytes, suffix: str, sizes: TableSizes) -> Pad:
    field = field_tables.read_field(content, suffix, levels=sizes.levels)
    levels = sizes.levels or max(2, int(field.max()) + 1)
    layers = [Layer("red", sizes.cell_mm, field)]
    if sizes.ratio > 1:
        blue = field[: field.shape[0] // sizes.ratio, : field.shape[1] // sizes.ratio]
        layers.append(Layer("blue", sizes.ratio * sizes.cell_mm, blue))
    pad = Pad(
        layers=tuple(layers),
        window=sizes.window,
        levels=levels,
        quiet_mm=sizes.quiet_mm,
        name=sizes.name,
    )
    found = verify.verify_field(field, sizes.window, levels)
    if not found.unique:
        return pad
    if found.unique_under_rotation:
        return replace(pad, unique="rotation", distance=found.min_distance_under_rotation)
    return replace(pad, unique="plain", distance=found.min_distance)


def _verify(pad: Pad) -> dict[str, Any]:
    """All that was found of the finest layer, and of the others whether they are unique."""
    finest, *others = sorted(pad.layers, key=lambda layer: layer.cell_mm)
    found = verify.verify_field(finest.field, pad.window, pad.levels).to_dict()
    keys = ("unique", "unique_under_rotation", "min_distance", "min_distance_under_rotation")
    record = {"channel": finest.channel, **found, "others": []}
    for layer in others:
        other = verify.verify_field(layer.field, pad.window, pad.levels).to_dict()
        record["others"].append({"channel": layer.channel} | {key: other[key] for key in keys})
    return record


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
        "scale": list(pad.scale),
        "crosstalk": None if pad.crosstalk is None else summarize_crosstalk(pad.crosstalk),
    }


def summarize_crosstalk(matrix: Matrix) -> dict[str, Any]:
    """What lists show of the mixture by which a pad's frames are un-mixed."""
    red, blue = separation(matrix)
    return {
        "matrix": [list(row) for row in matrix],
        "red_separation": round(red, 4),
        "blue_separation": round(blue, 4),
        "warnings": separation_warnings(red, blue),
    }
