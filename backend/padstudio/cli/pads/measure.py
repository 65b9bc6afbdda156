"""``padstudio measure``: the size that a print came out at."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from padstudio.cli.support import note
from padstudio.pad.print_scale import with_measured_size
from padstudio.pad.spec import Pad

_EXAMPLE = "Example: [bold]padstudio measure pad.json 199.2 200.4[/]"


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command(epilog=_EXAMPLE)(measure)


def measure(
    pad: Annotated[Path, typer.Argument(help="Pad file; its scale is set.")],
    x_mm: Annotated[float, typer.Argument(help="What the printed ruler along x reads, mm.")],
    y_mm: Annotated[float, typer.Argument(help="What the printed ruler along y reads, mm.")],
    ruler_mm: Annotated[float, typer.Option(help="Nominal length of the printed rulers.")] = 200.0,
) -> None:
    """Enter the size that a print came out at; poses then use it, without printing again."""
    design = with_measured_size(Pad.load(pad), ruler_mm=ruler_mm, x_mm=x_mm, y_mm=y_mm)
    design.save(pad)
    note(f"{pad}: scale {design.scale[0]:.5f} in x, {design.scale[1]:.5f} in y")
