"""``padstudio serve``: the studio's pages and its REST interface."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import Annotated

import typer

from padstudio.cli.support import note
from padstudio.web import serve as server

_EXAMPLES = (
    "Examples: [bold]padstudio serve[/] · [bold]padstudio serve --port 9000 --data ~/pads[/] · "
    "[bold]padstudio serve --host 0.0.0.0[/] prints an address with a token."
)


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command(epilog=_EXAMPLES)(serve)


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
    # The server has shut down in order by the time it passes Ctrl-C on.
    with contextlib.suppress(KeyboardInterrupt):
        server.serve(
            host, port, data, announce=lambda url: note(f"Pad Studio: {url} (Ctrl-C ends it)")
        )
