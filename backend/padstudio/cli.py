"""The command line: ``padstudio generate | print | detect | serve | …``.

Only typer is imported before a command runs, so that ``--help`` and completion are quick.
"""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import Annotated, Literal

import typer

from padstudio import cli_detect
from padstudio.cli_support import StudioGroup, check_output, note, progress_bar

app = typer.Typer(
    name="padstudio",
    cls=StudioGroup,
    help="Design, print and detect double-layer coded landing pads for drones.",
    epilog="Exit codes: 0 done, 1 done but nothing found, 2 wrong input, 3 search exhausted, "
    "70 a defect of the program.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    rich_markup_mode="rich",
)


def main() -> None:
    """Entry point of the ``padstudio`` program."""
    app()


def _show_version(wanted: bool) -> None:
    if wanted:
        from padstudio import __version__

        print(f"padstudio {__version__}")
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_show_version, is_eager=True, help="Show the version and exit."
        ),
    ] = False,
) -> None:
    pass


@app.command(
    epilog="Examples: [bold]padstudio generate -o pad.json[/] · "
    "[bold]padstudio generate --window 4 --cells 60 --ratio 1 -o small.json[/] · "
    "[bold]padstudio generate --cells 80x120 --cell-mm 8 --quiet-mm 20 -o wide.json[/]"
)
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
    unique: Annotated[
        Literal["rotation", "plain"],
        typer.Option(help="rotation: windows differ in all four turns; plain: as they stand."),
    ] = "rotation",
    distance: Annotated[
        int, typer.Option(help="Cells in which any two windows differ, at least.")
    ] = 3,
    method: Annotated[
        Literal["auto", "growth"], typer.Option(help="auto, or growth: the paper's.")
    ] = "auto",
    seed: Annotated[int, typer.Option(help="The same seed gives the same pad, everywhere.")] = 1,
    name: Annotated[str, typer.Option(help="The pad's name.")] = "pad",
    budget_s: Annotated[float, typer.Option(help="Seconds that the search may take.")] = 60.0,
    force: Annotated[bool, typer.Option("--force", help="Write over an existing file.")] = False,
) -> None:
    """Generate a pad and write it as a pad file."""
    from padstudio.pad.coding import generate_pad

    check_output(output, force=force)
    rows, cols = _cells(cells)
    with progress_bar(counted=False) as progress:
        task = progress.add_task("Searching", total=1.0)
        pad = generate_pad(
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
            method=method,
            seed=seed,
            budget_s=budget_s,
            progress=lambda share: progress.update(task, completed=share),
        )
    pad.save(output)
    layers = ", ".join(f"{la.channel} {la.rows} x {la.cols}" for la in pad.layers)
    note(f"{output}: {pad.width_mm:g} mm x {pad.height_mm:g} mm, {layers}")


def _cells(text: str) -> tuple[int, int]:
    parts = text.lower().split("x")
    if len(parts) > 2 or not all(part.isdecimal() for part in parts):
        raise typer.BadParameter(f"{text!r} is neither N nor ROWSxCOLUMNS", param_hint="--cells")
    return int(parts[0]), int(parts[-1])


@app.command()
def cameras() -> None:
    """List the nominal cameras that --camera takes in place of a file."""
    from rich.console import Console
    from rich.table import Table

    from padstudio.geometry import presets

    table = Table("camera", "size", "focal length", caption=presets.NOTE)
    # Never shortened, as it is there to be copied.
    table.add_column("id", no_wrap=True, min_width=max(map(len, presets.PRESETS)))
    for preset in presets.PRESETS.values():
        camera = preset.camera
        size = f"{camera.width} x {camera.height}"
        table.add_row(camera.name, size, f"{camera.focal_px:.0f} px", preset.id)
    Console().print(table)


@app.command(
    epilog="Examples: [bold]padstudio serve[/] · "
    "[bold]padstudio serve --port 9000 --data ~/pads[/] · "
    "[bold]padstudio serve --host 0.0.0.0[/] prints an address with a token."
)
def serve(
    host: Annotated[str | None, typer.Option(help="Address to listen on.")] = None,
    port: Annotated[
        int | None, typer.Option(min=0, max=65535, help="Port to listen on; 0 takes a free one.")
    ] = None,
    data: Annotated[
        Path | None,
        typer.Option(help="Data folder, else that of PADSTUDIO_DATA or the user's own."),
    ] = None,
) -> None:
    """Serve the studio's pages and its REST interface until Ctrl-C.

    On another address than the loopback ones, callers need a token: PADSTUDIO_TOKEN, or one that is
    made up and printed with the address.
    """
    from padstudio.web.serve import serve as run

    # The server has shut down in order by the time it passes Ctrl-C on.
    with contextlib.suppress(KeyboardInterrupt):
        run(host, port, data, announce=lambda url: note(f"Pad Studio: {url} (Ctrl-C ends it)"))


cli_detect.register(app)
