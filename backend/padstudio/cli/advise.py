"""``padstudio advise``: which sizes of a pad to choose."""

from __future__ import annotations

from typing import Annotated, Literal

import typer

from padstudio.cli.support import NoDistortion, note, open_camera
from padstudio.pad.coverage.advice import Envelope
from padstudio.pad.coverage.advice import advise as advice_for
from padstudio.pad.coverage.spans import METHOD_LIMITS
from padstudio.simulate.success_map import view_of


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command()(advise)


def advise(
    camera: Annotated[
        str, typer.Option(help="Camera file, or a preset's id (see: padstudio cameras).")
    ],
    low_mm: Annotated[float, typer.Option(help="Lowest height that must read, mm.")],
    high_mm: Annotated[float, typer.Option(help="Highest height that must read, mm.")],
    method: Annotated[
        Literal["dense", "paper"],
        typer.Option(help="dense: all that is in the picture; paper: the published method."),
    ] = "dense",
    window: Annotated[int, typer.Option(help="b: every b x b window occurs once.")] = 5,
    levels: Annotated[int, typer.Option(help="Y: levels a cell can take.")] = 2,
    tilt: Annotated[float, typer.Option(help="Largest lean of the camera, degrees.")] = 20.0,
    reach_mm: Annotated[
        float, typer.Option(help="How far off the pad's centre the camera may be at the lowest.")
    ] = 200.0,
    no_distortion: NoDistortion = False,
) -> None:
    """Advise cell size, ratio of the layers and pad size for a range of heights."""
    advice = advice_for(
        view_of(open_camera(camera, no_distortion=no_distortion)),
        Envelope(low_mm, high_mm, tilt, reach_mm),
        window=window,
        levels=levels,
        limits=METHOD_LIMITS[method],
    )
    print(
        f"padstudio generate --window {window} --levels {levels} --cells {advice.cells} "
        f"--ratio {advice.ratio} --cell-mm {advice.cell_mm:g}"
    )
    note(
        f"{advice.size_mm:.0f} mm square, reads from {advice.low_mm:.0f} to {advice.high_mm:.0f} mm"
    )
    for line in advice.notes:
        note(f"warning: {line}")
