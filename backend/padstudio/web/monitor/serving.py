"""Runs the monitor beside a session, in a thread of its own."""

from __future__ import annotations

import secrets
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import uvicorn

from padstudio.live.outputs.watch import Watch
from padstudio.live.stream.packet_shelf import PacketShelf
from padstudio.vision.detector import Detector
from padstudio.web.http.connections import Connection
from padstudio.web.monitor.app import create_app
from padstudio.web.monitor.frames import LastFrames
from padstudio.web.serve import address_of, listen
from padstudio.web.server.settings import load_settings

_CLOSE_S = 5.0


@contextmanager
def monitored(
    address: tuple[str, int],
    watch: Watch,
    shelf: PacketShelf,
    detector: Detector,
    stats: Callable[[], dict[str, Any]],
) -> Iterator[str]:
    """Serve a session until the block ends.

    On another address than the loopback ones callers need a token, as of ``padstudio serve``:
    PADSTUDIO_TOKEN, or one that is made up.

    Parameters
    ----------
    address : (host, port)
        Port 0 takes a free one.
    watch : Watch
        One of the session's outputs.
    shelf : PacketShelf
        One of the stream's taps.
    detector : Detector
    stats : callable
        The session's figures as of now.

    Yields
    ------
    str
        The address, with the token.

    Raises
    ------
    StudioError
        If it cannot listen there.
    """
    settings = load_settings(host=address[0], port=address[1])
    if settings.lacks_token:
        settings = settings.model_copy(update={"token": secrets.token_urlsafe(32)})
    frames = LastFrames(watch, shelf, detector)
    try:
        with listen(settings, "--http") as listener:
            config = uvicorn.Config(
                create_app(settings, watch, frames, stats),
                http=Connection,
                ws="none",
                log_level="warning",
                access_log=False,
                server_header=False,
                proxy_headers=False,
                lifespan="off",
                timeout_graceful_shutdown=1,
            )
            server = uvicorn.Server(config)
            thread = threading.Thread(
                target=server.run, args=([listener],), name="monitor", daemon=True
            )
            thread.start()
            try:
                yield address_of(settings, listener.getsockname()[1])
            finally:
                watch.close()
                server.should_exit = True
                thread.join(_CLOSE_S)
                watch.on_change(None)
    finally:
        frames.close()
