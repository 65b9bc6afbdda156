"""Opens the service of flights as the settings say."""

from __future__ import annotations

from padstudio.flights.cluster.engine import Cluster, ClusterEngine
from padstudio.flights.cluster.local import LocalEngine
from padstudio.flights.cluster.task import Engine
from padstudio.flights.service import FlightOptions, FlightService
from padstudio.flights.tasks.from_rows import WorkLimits
from padstudio.media.remote import Storage
from padstudio.store.store import Store
from padstudio.web.server.settings import Settings
from padstudio.workers.pool import WorkerPool


def open_service(settings: Settings, store: Store, pool: WorkerPool) -> FlightService:
    """The service of a server; nothing runs before `FlightService.start`.

    Raises
    ------
    SpecError
        If the scheduler's address is not encrypted.
    """
    return FlightService(
        store.session,
        store.uploads,
        _engine(settings, pool),
        Storage(settings.storage),
        FlightOptions(
            pictures=settings.data / "pictures",
            keep_picture_bytes=settings.keep_picture_bytes,
            proxies=settings.data / "proxies",
            keep_proxy_bytes=settings.keep_proxy_bytes,
            shelves=settings.data / "frames",
            keep_frame_bytes=settings.keep_frame_bytes,
            shares_disk=settings.scheduler is None,
            limits=WorkLimits(
                max_pixels=settings.max_image_pixels,
                max_frames=settings.max_frames,
                chunk_frames=settings.chunk_frames,
            ),
            max_open=settings.max_flights,
            attempts=settings.chunk_attempts,
            idle_s=settings.worker_idle_seconds,
        ),
    )


def _engine(settings: Settings, pool: WorkerPool) -> Engine:
    """The cluster's workers where there is a scheduler, else the server's own."""
    if settings.scheduler is None:
        return LocalEngine(pool)
    return ClusterEngine(
        Cluster(
            scheduler=settings.scheduler,
            tls_ca=settings.scheduler_ca,
            tls_cert=settings.scheduler_cert,
            tls_key=settings.scheduler_key,
        )
    )
