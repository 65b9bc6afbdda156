"""A server's desk in a process of its own, for tests that end it: desk_process.py DATA."""

from __future__ import annotations

import signal
import sys
import threading
from pathlib import Path

from padstudio.flights.cluster.engine import EngineOptions
from padstudio.flights.desk import FlightDesk
from padstudio.flights.tasks.from_rows import WorkLimits
from padstudio.media.remote import Storage
from padstudio.store.store import Store


def open_desk(store: Store, data: Path, **options: int) -> FlightDesk:
    """A desk whose tasks read three frames, and may cost many workers."""
    return FlightDesk(
        store.session,
        store.uploads,
        EngineOptions(workers=2, worker_memory_bytes=1_000_000_000),
        WorkLimits(chunk_frames=3),
        Storage(),
        pictures=data / "pictures",
        **({"attempts": 20} | options),
    )


def main() -> None:
    data = Path(sys.argv[1])
    ended = threading.Event()
    signal.signal(signal.SIGTERM, lambda *_: ended.set())
    store = Store(data)
    desk = open_desk(store, data)
    desk.start()
    ended.wait()
    desk.close()
    store.close()


if __name__ == "__main__":
    main()
