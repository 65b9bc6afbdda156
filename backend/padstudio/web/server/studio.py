"""All that a server has open while it serves: the data folder, workers, flights, callbacks."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import dataclass

from fastapi.concurrency import run_in_threadpool

from padstudio.media.zip_stills import ZipLimits
from padstudio.store.store import Store
from padstudio.store.uploads.limits import UploadLimits
from padstudio.web.server.callbacks.service import CallbackService
from padstudio.web.server.flight_service import open_service
from padstudio.web.server.services import Analyze, Services
from padstudio.web.server.settings import Settings
from padstudio.workers.inside import Limits
from padstudio.workers.pool import WorkerPool

# Of the worker processes: between the server, at 0, and what runs when nothing else does.
_NICENESS = 10
# Nobody waits for the loops of pads and detectors where they can be ready before.
_WARMING = ("padstudio.pad.coding.warm", "padstudio.vision.warm")


@dataclass(frozen=True)
class Studio:
    """What was opened, and has to be closed.

    Attributes
    ----------
    services : Services
    calls : CallbackService
    """

    services: Services
    calls: CallbackService

    @classmethod
    def open(cls, settings: Settings, analyze: Analyze) -> Studio:
        """Open all of it, or nothing; nothing runs before `start`.

        Raises
        ------
        StorageError, ConflictError
            As `Store`.
        SpecError
            As `open_service`.
        """
        with ExitStack() as opened:
            store = _open_store(settings)
            opened.callback(store.close)
            limits = Limits(settings.worker_memory_bytes, _NICENESS)
            pool = WorkerPool(
                settings.workers,
                limits,
                settings.max_waiting,
                warming=_WARMING,
                idle_s=settings.worker_idle_seconds,
            )
            opened.callback(pool.close)
            service = open_service(settings, store, pool)
            services = Services(settings, store, pool, service, analyze)
            secret = settings.callback_secret or ""
            calls = CallbackService(service.callbacks, services.callback_hosts, secret)
            opened.pop_all()
        return cls(services, calls)

    def start(self) -> None:
        """Go on with what an earlier server left, and take work."""
        self.services.flights.start()
        self.calls.start()

    async def close(self) -> None:
        """End what runs, which goes on at the next start, and let go of the data folder."""
        services = self.services
        await services.simulations.close()
        await services.calibrations.close()
        await services.experiments.close()
        await services.sweeps.close()
        await services.live.close()
        await run_in_threadpool(self.calls.close)
        await run_in_threadpool(services.flights.close)
        services.pool.close()
        services.store.close()


def _open_store(settings: Settings) -> Store:
    return Store(
        settings.data,
        settings.database_url,
        keep_traces=settings.keep_traces,
        keep_trace_bytes=settings.keep_trace_bytes,
        keep_experiments=settings.keep_experiments,
        upload_limits=UploadLimits(
            file_bytes=settings.max_flight_bytes,
            total_bytes=settings.keep_upload_bytes,
            unfinished=settings.max_unfinished_uploads,
            expires_s=settings.upload_expires_seconds,
            telemetry_bytes=settings.max_telemetry_bytes,
            still_pixels=settings.max_image_pixels,
            zip=ZipLimits(settings.max_zip_files, settings.max_zip_bytes, settings.max_zip_ratio),
        ),
    )
