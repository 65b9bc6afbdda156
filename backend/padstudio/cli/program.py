"""The command line: ``padstudio generate | print | detect | serve | …``.

Only typer is imported before a command runs, so that ``--help`` and completion are quick.
"""

from __future__ import annotations

from typing import Annotated

import typer

from padstudio.cli import (
    coverage,
    detect,
    export,
    generate,
    serve,
    simulate,
    worker,
)
from padstudio.cli import (
    print as cli_print,
)
from padstudio.cli.support import StudioGroup

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


for part in (
    generate,
    cli_print,
    detect,
    export,
    simulate,
    coverage,
    serve,
    worker,
):
    part.register(app)
