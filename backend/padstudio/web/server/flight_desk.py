"""Opens the desk for flights as the settings say."""

from __future__ import annotations

from padstudio.flights.cluster.engine import EngineOptions
from padstudio.flights.desk import FlightDesk
from padstudio.flights.tasks.from_rows import WorkLimits
from padstudio.media.remote import Storage
from padstudio.store.store import Store
from padstudio.web.server.settings import Settings


def open_desk(settings: Settings, store: Store) -> FlightDesk:
    """The desk of a server; nothing runs before `FlightDesk.start`.

    Raises
    ------
    SpecError
        If the scheduler's address is not encrypted.
    """
    return FlightDesk(
        store.session,
        store.uploads,
        EngineOptions(
            scheduler=settings.scheduler,
            tls_ca=settings.scheduler_ca,
            tls_cert=settings.scheduler_cert,
            tls_key=settings.scheduler_key,
            workers=settings.workers,
            worker_memory_bytes=settings.worker_memory_bytes,
        ),
        WorkLimits(
            max_pixels=settings.max_image_pixels,
            max_frames=settings.max_frames,
            chunk_frames=settings.chunk_frames,
        ),
        Storage(settings.storage),
        pictures=settings.data / "pictures",
        keep_picture_bytes=settings.keep_picture_bytes,
        max_open=settings.max_flights,
        attempts=settings.chunk_attempts,
    )
