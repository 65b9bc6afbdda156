"""``padstudio crosstalk``: how printer and camera mix the colours, from a photo."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from padstudio.cli.support import note
from padstudio.errors import ImageError
from padstudio.media import images
from padstudio.pad.spec import Pad
from padstudio.vision.strip_photo import estimate_crosstalk

_EXAMPLES = (
    "Examples: [bold]padstudio crosstalk pad.json strip.jpg[/] · "
    "[bold]padstudio crosstalk pad.json --forget[/]"
)


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command(epilog=_EXAMPLES)(crosstalk)


def crosstalk(
    pad: Annotated[Path, typer.Argument(help="Pad file; its crosstalk is set.")],
    photo: Annotated[Path | None, typer.Argument(help="Photo of the printed test strip.")] = None,
    forget: Annotated[bool, typer.Option("--forget", help="Un-mix frames no longer.")] = False,
) -> None:
    """Read a photo of the test strip; frames are then un-mixed by what printer and camera do."""
    if (photo is None) != forget:
        raise typer.BadParameter("give a photo of the test strip, or --forget")
    design = Pad.load(pad)
    if photo is None:
        design.with_crosstalk(None).save(pad)
        note(f"{pad}: frames are not un-mixed")
        return
    found = estimate_crosstalk(images.read(photo))
    if not found.usable:
        raise ImageError("; ".join(found.warnings), code="unusable_strip")
    design.with_crosstalk(found.matrix).save(pad)
    for warning in found.warnings:
        note(f"warning: {warning}")
    note(
        f"{pad}: frames are un-mixed from now on; red stands out by {found.red_separation:.0%}, "
        f"blue by {found.blue_separation:.0%} of white"
    )
