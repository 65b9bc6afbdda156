"""A server's flights in a process of its own, for tests that end it: service_process.py DATA."""

from __future__ import annotations

import signal
import sys
import threading
from pathlib import Path

from padstudio.flights.cluster.local import LocalEngine
from padstudio.flights.service import FlightOptions, FlightService
from padstudio.flights.tasks.from_rows import WorkLimits
from padstudio.media.remote import Storage
from padstudio.store.store import Store
from padstudio.workers.inside import Limits
from padstudio.workers.pool import WorkerPool


def open_pool() -> WorkerPool:
    """Two processes, of which none runs before there is work."""
    return WorkerPool(2, Limits(1_000_000_000), max_waiting=0)


def open_service(store: Store, data: Path, pool: WorkerPool, **options: int) -> FlightService:
    """A service whose tasks read three frames, and may cost many workers."""
    return FlightService(
        store.session,
        store.uploads,
        LocalEngine(pool),
        Storage(),
        FlightOptions(
            pictures=data / "pictures",
            limits=WorkLimits(chunk_frames=3),
            **({"attempts": 20} | options),
        ),
    )


def main() -> None:
    data = Path(sys.argv[1])
    ended = threading.Event()
    signal.signal(signal.SIGTERM, lambda *_: ended.set())
    store = Store(data)
    pool = open_pool()
    service = open_service(store, data, pool)
    service.start()
    ended.wait()
    service.close()
    pool.close()
    store.close()


if __name__ == "__main__":
    main()
