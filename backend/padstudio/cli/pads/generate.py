"""``padstudio generate``: a new pad as a pad file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from padstudio.cli.support import check_output, note, progress_bar
from padstudio.pad.coding import generate as coding
from padstudio.pad.coding.pad_spec import PAPER_COST

_EXAMPLES = (
    "Examples: [bold]padstudio generate -o pad.json[/] · "
    "[bold]padstudio generate --window 4 --cells 60 --ratio 1 -o small.json[/] · "
    "[bold]padstudio generate --cells 80x120 --cell-mm 8 --quiet-mm 20 -o wide.json[/]"
)
_Unique = Annotated[
    Literal["rotation", "plain"],
    typer.Option(help="rotation: windows differ in all four turns; plain: as they stand."),
]
_Distance = Annotated[int, typer.Option(help="Cells in which any two windows differ, at least.")]
_VisibleLines = Annotated[
    bool,
    typer.Option(
        "--visible-lines", help="Every window has a level change across each of its inner lines."
    ),
]
_Layers = Annotated[
    Literal["independent", "paper"],
    typer.Option(
        help="independent: windows of one layer differ from those of the other, too, in every "
        f"turn; paper: the blue layer is a copy of the red one's corner, so that {PAPER_COST}."
    ),
]
_Method = Annotated[Literal["auto", "growth"], typer.Option(help="auto, or growth: the paper's.")]


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command(epilog=_EXAMPLES)(generate)


def generate(
    output: Annotated[Path, typer.Option("-o", "--output", help="Pad file to write.")],
    window: Annotated[int, typer.Option(help="b: every b x b window occurs once.")] = 5,
    levels: Annotated[int, typer.Option(help="Y: levels a cell can take.")] = 2,
    cells: Annotated[str, typer.Option(help="Red cells: N for a square, or ROWSxCOLUMNS.")] = "125",
    ratio: Annotated[
        int, typer.Option(help="Red cells along a blue one; 1 leaves the blue layer out.")
    ] = 5,
    cell_mm: Annotated[float, typer.Option(help="Side of a red cell, mm.")] = 10.0,
    quiet_mm: Annotated[float, typer.Option(help="White margin round the pad, mm.")] = 0.0,
    unique: _Unique = "rotation",
    distance: _Distance = 3,
    layers: _Layers = "independent",
    visible_lines: _VisibleLines = False,
    method: _Method = "auto",
    seed: Annotated[int, typer.Option(help="The same seed gives the same pad, everywhere.")] = 1,
    name: Annotated[str, typer.Option(help="The pad's name.")] = "pad",
    budget_s: Annotated[float, typer.Option(help="Seconds that the search may take.")] = 60.0,
    force: Annotated[bool, typer.Option("--force", help="Write over an existing file.")] = False,
) -> None:
    """Generate a pad and write it as a pad file."""
    check_output(output, force=force)
    rows, cols = _cells(cells)
    spec = coding.PadSpec(
        name=name,
        window=window,
        levels=levels,
        rows=rows,
        cols=cols,
        ratio=ratio,
        cell_mm=cell_mm,
        quiet_mm=quiet_mm,
        unique=unique,
        distance=distance,
        layers=layers,
        visible_lines=visible_lines,
        method=method,
        seed=seed,
    )
    with progress_bar("Searching", 1.0, counted=False) as progress:
        pad = coding.generate_pad(
            spec,
            budget_s=budget_s,
            progress=progress,
        )
    pad.save(output)
    sizes = ", ".join(f"{la.channel} {la.rows} x {la.cols}" for la in pad.layers)
    note(f"{output}: {pad.width_mm:g} mm x {pad.height_mm:g} mm, {sizes}")
    if pad.layer_fields == "paper":
        note(f"layers that share a code: {PAPER_COST}")


def _cells(text: str) -> tuple[int, int]:
    parts = text.lower().split("x")
    if len(parts) > 2 or not all(part.isdecimal() and len(part) < 10 for part in parts):
        raise typer.BadParameter(f"{text!r} is neither N nor ROWSxCOLUMNS", param_hint="--cells")
    return int(parts[0]), int(parts[-1])
