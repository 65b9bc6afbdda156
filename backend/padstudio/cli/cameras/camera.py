"""``padstudio camera``: what a camera file says, and the same camera in another form."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from padstudio.cli.support import NoDistortion, check_output, note, open_camera, show_table
from padstudio.geometry.camera import Camera

_EXAMPLES = (
    "Examples: [bold]padstudio camera cameras.txt#2[/] · "
    "[bold]padstudio camera ost.yaml --form kalibr -o camchain.yaml[/]"
)


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command(epilog=_EXAMPLES)(camera)


def camera(
    file: Annotated[
        str,
        typer.Argument(help="Camera file, FILE#NAME of several cameras, or a preset's id."),
    ],
    form: Annotated[
        Literal["ros", "opencv", "kalibr", "colmap"], typer.Option(help="The form to write.")
    ] = "ros",
    output: Annotated[
        str | None, typer.Option("-o", "--output", help="File to write; - is stdout.")
    ] = None,
    no_distortion: NoDistortion = False,
    force: Annotated[bool, typer.Option("--force", help="Write over an existing file.")] = False,
) -> None:
    """Show what a camera file says, or write the camera in another form."""
    if output not in (None, "-"):
        check_output(Path(str(output)), force=force)
    the_camera = open_camera(file, no_distortion=no_distortion)
    if output is None:
        _show(the_camera)
        return
    text = the_camera.to_form(form)
    if output == "-":
        typer.echo(text, nl=False)
    else:
        Path(output).write_text(text, encoding="utf-8")
        note(f"{output}: {the_camera.width} x {the_camera.height}, {the_camera.model}, as {form}")


def _show(camera: Camera) -> None:
    matrix = camera.matrix
    coefficients = " ".join(f"{value:.10g}" for value in camera.distortion)
    readout = "unknown" if camera.readout_ms is None else f"{camera.readout_ms:g} ms"
    show_table(
        ("of the camera", "value"),
        [
            ("name", camera.name),
            ("size", f"{camera.width} x {camera.height} px"),
            ("focal lengths", f"{matrix[0, 0]:.10g} {matrix[1, 1]:.10g} px"),
            ("principal point", f"{matrix[0, 2]:.10g} {matrix[1, 2]:.10g} px"),
            ("lens model", camera.model),
            ("distortion", coefficients or "none"),
            ("nominal", "yes, calibrate for accuracy" if camera.nominal else "no"),
            ("readout", readout),
        ],
        whole=("value",),
    )
