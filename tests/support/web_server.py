"""A real server on a free port."""

from __future__ import annotations

import contextlib
import socket
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import httpx
import uvicorn

from padstudio.web.app import create_app
from padstudio.web.http.connections import Connection
from padstudio.web.server.settings import Settings

SMALL_SPEC = {"name": "small", "rows": 12, "cols": 10, "ratio": 2, "seed": 7}
#: Read in milliseconds, while generating one costs a new worker its compiled loops.
PAD_FILE = (
    '{"format": "padstudio.pad", "version": 1, "name": "tiny", "window": 2, "levels": 2, '
    '"layers": [{"channel": "red", "cell_mm": 10.0, "codes": ["001", "011", "110"]}]}'
)
PRESET = "preset-webcam-c270"
PRESET_SIZE = (1280, 720)


@contextlib.contextmanager
def running(
    settings: Settings, *, faults: Mapping[str, Exception] | None = None, **options: Any
) -> Iterator[httpx.Client]:
    """A client of a server that runs in a thread until the context ends.

    Parameters
    ----------
    settings : Settings
    faults : mapping, optional
        What is raised at addresses besides the server's own.
    **options
        Of `create_app`.
    """
    # As the command does: without the protocol asyncio leaves TCP_NODELAY off, and each answer on a
    # kept connection waits for 40 ms.
    listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    listener.bind(("127.0.0.1", 0))
    listener.listen()
    app = create_app(settings, **options)
    for path, fault in (faults or {}).items():
        app.add_api_route(path, partial(_fail, fault))
    config = uvicorn.Config(
        app,
        http=Connection,
        log_level="critical",
        lifespan="on",
        ws="none",
        # A client that a test left behind does not hold up the end of all.
        timeout_graceful_shutdown=10,
    )
    server = uvicorn.Server(config)
    thread = threading.Thread(target=server.run, args=([listener],))
    thread.start()
    while not server.started:
        assert thread.is_alive(), "the server did not start"
        time.sleep(0.005)
    try:
        with httpx.Client(
            base_url=f"http://127.0.0.1:{listener.getsockname()[1]}", timeout=120, trust_env=False
        ) as client:
            yield client
    finally:
        server.should_exit = True
        thread.join()
        listener.close()


async def _fail(fault: Exception) -> None:
    raise fault


def settings_for(data: Path, **values: Any) -> Settings:
    """Settings that do not depend on the environment's, with small limits."""
    small: dict[str, Any] = {
        "workers": 1,
        "max_image_pixels": 4_000_000,
        "max_upload_bytes": 2_000_000,
        "max_request_bytes": 10_000,
        "detect_seconds": 20,
    }
    return Settings(data=data, **(small | values))


def store_pad(client: httpx.Client) -> dict[str, Any]:
    """Store a tiny pad; its summary."""
    answer = client.post("/api/v1/pads/import", files={"file": ("pad.json", PAD_FILE)})
    return dict(answer.raise_for_status().json())


def wait_until(holds: Callable[[], bool], most_s: float = 120) -> None:
    """Look again and again until something holds; fails rather than hang."""
    end = time.monotonic() + most_s
    while not holds():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.02)
