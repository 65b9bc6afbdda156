"""Makes and reads pads in a worker process."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from padstudio.pad.coding import field_tables, verify
from padstudio.pad.coding.generate import PadSpec, any_seed, blue_beside, generate_pad
from padstudio.pad.coding.verify_pad import verify_pad
from padstudio.pad.crosstalk import Matrix, separation, separation_warnings
from padstudio.pad.spec import Layer, LayerFields, Pad


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
        What `padstudio.pad.coding.verify_pad` found, as its ``to_dict``. None where nobody asked.
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
    return Design(pad.dumps(), summarize(pad), verify_pad(pad).to_dict())


def resize(made: Design, name: str, cell_mm: float, quiet_mm: float) -> Design:
    """The same code under another name and at another size, as `generate` would make it.

    Parameters
    ----------
    made : Design
    name : str
    cell_mm : float
        Side of the finest layer's cell.
    quiet_mm : float
    """
    pad = Pad.loads(made.content)
    finest = min(layer.cell_mm for layer in pad.layers)
    layers = tuple(
        replace(layer, cell_mm=round(layer.cell_mm / finest) * cell_mm) for layer in pad.layers
    )
    pad = replace(pad, layers=layers, quiet_mm=quiet_mm, name=name)
    return Design(pad.dumps(), summarize(pad), made.verification)


def rename(content: str, name: str) -> Design:
    """A pad file under another name."""
    pad = replace(Pad.loads(content), name=name)
    return Design(pad.dumps(), summarize(pad))


def verify_content(content: str) -> dict[str, Any]:
    """What holds for a pad file's layers, as `Design.verification`."""
    return verify_pad(Pad.loads(content)).to_dict()


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
    layers : {"independent", "paper"}
        As of a `PadSpec`: how a blue layer is made, where the ratio adds one.
    """

    name: str = "pad"
    window: int = 5
    levels: int | None = None
    cell_mm: float = 10.0
    ratio: int = 1
    quiet_mm: float = 0.0
    layers: LayerFields = "independent"


def read(
    content: bytes,
    suffix: str = ".json",
    sizes: TableSizes | None = None,
    budget_s: float = 60.0,
) -> Design:
    """Read an imported file: a pad file, or by its suffix a table or picture of the red layer.

    Parameters
    ----------
    content : bytes
    suffix : str
        Of the file's name, in small letters; none is taken for a pad file's.
    sizes : TableSizes, optional
        Of a table or picture.
    budget_s : float
        Time for the search of a blue layer beside a table's, s.

    Raises
    ------
    PadFormatError
        With the place and the reason.
    SpecError, SearchExhaustedError
        Where no blue layer is found beside a table's.
    """
    if suffix in ("", ".json"):
        pad = Pad.loads(content)
    else:
        sizes = sizes or TableSizes()
        pad = _of_table(content, suffix, sizes)
        if sizes.ratio > 1:
            pad = _with_blue(pad, sizes, budget_s)
    return Design(pad.dumps(), summarize(pad))


def _of_table(content: bytes, suffix: str, sizes: TableSizes) -> Pad:
    """A pad of the red layer alone."""
    field = field_tables.read_field(content, suffix, levels=sizes.levels)
    pad = Pad(
        layers=(Layer("red", sizes.cell_mm, field),),
        window=sizes.window,
        levels=sizes.levels or max(2, int(field.max()) + 1),
        quiet_mm=sizes.quiet_mm,
        name=sizes.name,
    )
    found = verify.verify_field(field, pad.window, pad.levels)
    if not found.unique:
        return pad
    if found.unique_under_rotation:
        return replace(pad, unique="rotation", distance=found.min_distance_under_rotation)
    return replace(pad, unique="plain", distance=found.min_distance)


def _with_blue(pad: Pad, sizes: TableSizes, budget_s: float) -> Pad:
    """A pad with a blue layer added, at the red one's distance or that of new pads, if less."""
    (red,) = pad.layers
    spec = PadSpec(
        rows=red.rows,
        cols=red.cols,
        window=pad.window,
        levels=pad.levels,
        unique=pad.unique or "rotation",
        distance=min(pad.distance or 1, PadSpec.distance),
        ratio=sizes.ratio,
        layers=sizes.layers,
    )
    if spec.has_two_fields:
        field = blue_beside(spec, red.field, budget_s=budget_s)
        pad = replace(pad, distance=pad.distance and spec.distance)
    else:
        field = red.field[: red.rows // sizes.ratio, : red.cols // sizes.ratio]
    blue = Layer("blue", sizes.ratio * red.cell_mm, field)
    return replace(pad, layers=(red, blue), layer_fields=sizes.layers)


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
        "layer_fields": pad.layer_fields,
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
