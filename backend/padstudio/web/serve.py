"""Runs the server: the address to open, a graceful end."""

from __future__ import annotations

import contextlib
import errno
import secrets
import socket
import sys
from collections.abc import Callable
from pathlib import Path

from padstudio.errors import StudioError
from padstudio.web.server.settings import Settings, load_settings

# Open requests get this long after Ctrl-C; `ClosingGuard` lets go of them earlier.
_GRACE_S = 3
_OTHER_FILES = 1000


class ServeError(StudioError):
    """The server cannot listen where it was told to."""

    code = "cannot_listen"


def serve(
    host: str | None = None,
    port: int | None = None,
    data: Path | None = None,
    token: str | None = None,
    *,
    announce: Callable[[str], None] = print,
) -> None:
    """Serve until interrupted.

    Parameters
    ----------
    host, port, data, token
        Instead of the environment's or the default settings; without a token, one is made up
        where the host is not loopback.
    announce : callable
        Called with the address to open, once the server listens.

    Raises
    ------
    StudioError
        If a setting is wrong, the port is taken, or the data folder cannot be used.
    """
    settings = load_settings(host=host, port=port, data=data, token=token)
    if settings.lacks_token:
        settings = settings.model_copy(update={"token": secrets.token_urlsafe(32)})
    with listen(settings) as listener:
        _run(settings, listener, announce)


def listen(settings: Settings, option: str = "--port") -> socket.socket:
    """A socket that is bound to the settings' host and port.

    Parameters
    ----------
    settings : Settings
    option : str
        By which another port may be chosen.

    Raises
    ------
    ServeError
    """
    try:
        info = socket.getaddrinfo(
            settings.host, settings.port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )[0]
        # With the protocol named, asyncio turns off Nagle's algorithm, which makes answers that are
        # sent in two parts wait for the peer's delayed acknowledgement: 40 ms each.
        listener = socket.socket(*info[:3])
        try:
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            listener.bind(info[4])
        except OSError:
            listener.close()
            raise
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            raise ServeError(
                f"port {settings.port} is in use; stop what listens there, or choose another with "
                f"{option} (0 takes a free one)",
                code="port_in_use",
            ) from error
        raise ServeError(
            f"cannot listen on {settings.host} port {settings.port}: {error.strerror or error}"
        ) from error
    return listener


def _run(settings: Settings, listener: socket.socket, announce: Callable[[str], None]) -> None:
    import uvicorn

    from padstudio.web.app import create_app
    from padstudio.web.http.connections import Connection
    from padstudio.web.server.studio import Studio
    from padstudio.workers import detection

    address = address_of(settings, listener.getsockname()[1])
    # Before the server runs, whose own word on what fails at its start is a traceback.
    studio = Studio.open(settings, detection.analyze)
    app = create_app(settings, studio=studio)

    class Server(uvicorn.Server):
        async def startup(self, sockets: list[socket.socket] | None = None) -> None:
            await super().startup(sockets)
            if self.started and not self.should_exit:
                announce(address)
                studio.services.pool.warm_up()

        async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
            app.state.closing.begin()
            await super().shutdown(sockets)

    config = uvicorn.Config(
        app,
        http=Connection,
        ws="none",
        log_level="warning",
        # An access log would hold the token of the first address.
        access_log=False,
        server_header=False,
        proxy_headers=False,
        lifespan="on",
        timeout_graceful_shutdown=_GRACE_S,
    )
    _allow_connections(settings.max_streams)
    Server(config).run(sockets=[listener])


def _allow_connections(streams: int) -> None:
    """Raise the limit of open files, often 1024, to what so many streams and all else take."""
    if sys.platform == "linux" or sys.platform == "darwin":
        import resource

        soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        wanted = 2 * streams + _OTHER_FILES
        if hard != resource.RLIM_INFINITY:
            wanted = min(wanted, hard)
        # What cannot be raised stays as it is.
        if soft != resource.RLIM_INFINITY and soft < wanted:
            with contextlib.suppress(OSError, ValueError):
                resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))


def address_of(settings: Settings, port: int) -> str:
    """What to open in a browser on this machine."""
    host = settings.host
    if host in ("0.0.0.0", "::"):
        host = "127.0.0.1"
    shown = f"[{host}]" if ":" in host else host
    query = f"/?token={settings.token}" if settings.token else ""
    return f"http://{shown}:{port}{query}"
