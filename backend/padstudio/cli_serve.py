"""``padstudio serve``: the studio's pages and its REST interface."""

from __future__ import annotations

import os
import secrets
import socket
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from padstudio.cli_support import note

if TYPE_CHECKING:
    from padstudio.web.settings import Settings

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
    """Serve the studio's pages and its REST interface.

    On another address than the loopback ones, callers need a token: PADSTUDIO_TOKEN, or one that is
    made up and printed with the address.
    """
    import uvicorn

    from padstudio.web.app import create_app
    from padstudio.web.settings import load_settings

    settings = load_settings(host=host, port=port, data=data, token=_new_token(host))
    listener = _listen(settings.host, settings.port)
    server = uvicorn.Server(uvicorn.Config(create_app(settings), log_level="warning"))
    note(f"Pad Studio: {_address(settings, listener)}  (Ctrl-C ends it)")
    try:
        server.run(sockets=[listener])
    except KeyboardInterrupt:
        # The server has shut down by now; how it was asked to is not an error.
        return


def _new_token(host: str | None) -> str | None:
    """A token where one is needed and none is set."""
    from padstudio.web.settings import is_loopback

    host = host or os.environ.get("PADSTUDIO_HOST", "127.0.0.1")
    guarded = "PADSTUDIO_TOKEN" in os.environ or "PADSTUDIO_ALLOWED_HOSTS" in os.environ
    return None if is_loopback(host) or guarded else secrets.token_urlsafe(24)


def _listen(host: str, port: int) -> socket.socket:
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        return socket.create_server((host.strip("[]"), port), family=family)
    except OSError as error:
        raise OSError(
            error.errno,
            f"cannot listen there ({error.strerror}); try another --port",
            f"{host}:{port}",
        ) from error


def _address(settings: Settings, listener: socket.socket) -> str:
    host = settings.host
    if host in ("0.0.0.0", "::"):
        host = socket.gethostname()
    host = f"[{host}]" if ":" in host and not host.startswith("[") else host
    query = f"/?token={settings.token}" if settings.token else "/"
    return f"http://{host}:{listener.getsockname()[1]}{query}"
