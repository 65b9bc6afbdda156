"""The web application: REST under /api/v1, the pages, the pages' files."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from functools import partial

from fastapi import APIRouter, FastAPI
from fastapi.concurrency import run_in_threadpool

from padstudio import __version__
from padstudio.errors import SpecError
from padstudio.media.zip_stills import ZipLimits
from padstudio.store.store import Store
from padstudio.store.uploads.limits import UploadLimits
from padstudio.web.api import (
    calibrations,
    cameras,
    coverage,
    detect,
    pads,
    printing,
    uploads,
)
from padstudio.web.api.flights import (
    comparisons,
    exports,
    figures,
    flights,
    pictures,
    proxies,
    samples,
    simulations,
)
from padstudio.web.api.tuning import bundles, looks, presets, sweeps
from padstudio.web.http import errors
from padstudio.web.http.security import Guard
from padstudio.web.pages import pages
from padstudio.web.schemas.base import Health
from padstudio.web.server.callbacks.service import CallbackService
from padstudio.web.server.flight_service import open_service
from padstudio.web.server.services import Analyze, Services
from padstudio.web.server.settings import Settings, load_settings
from padstudio.workers import detection
from padstudio.workers.inside import Limits
from padstudio.workers.pool import WorkerPool

API = "/api/v1"
# Of the worker processes: between the server, at 0, and what runs when nothing else does.
_NICENESS = 10
_DESCRIPTION = (
    "Design pads, and find them in pictures. Every error has one shape, `ErrorBody`. A server "
    "that asks for a token takes it as `Authorization: Bearer <token>` or `?token=<token>`."
)

#: In the order of the API's description.
_RESOURCES = (
    *(pads, cameras, calibrations, detect, samples, uploads, printing, coverage),
    *(flights, figures, comparisons, pictures, proxies, exports, simulations),
    *(looks, presets, sweeps, bundles),
)
_health = APIRouter(tags=["server"])


@_health.get("/health", operation_id="getHealth", summary="Whether the server is up")
def get_health() -> Health:
    return Health(version=__version__)


def create_app(
    settings: Settings | None = None, *, analyze: Analyze = detection.analyze
) -> FastAPI:
    """Build the application; the data folder is opened when it starts to serve.

    Parameters
    ----------
    settings : Settings or None
        None reads the environment.
    analyze : callable
        Importable by name; runs in worker processes.

    Raises
    ------
    SpecError
        If the settings open the server to the network without a token.
    """
    settings = settings or load_settings()
    if settings.lacks_token:
        raise SpecError(
            f"host {settings.host} can be reached from outside: set a token (PADSTUDIO_TOKEN), or "
            "listen on 127.0.0.1",
            code="invalid_setting",
        )

    app = FastAPI(
        title="Pad Studio",
        version=__version__,
        description=_DESCRIPTION,
        openapi_url=f"{API}/openapi.json",
        # FastAPI's own documentation pages load scripts from another host.
        docs_url=None,
        redoc_url=None,
        lifespan=partial(_serving, settings, analyze),
    )
    app.state.settings = settings
    errors.install(app)
    app.add_middleware(Guard, settings=settings)
    app.include_router(_health, prefix=API)
    for resource in _RESOURCES:
        app.include_router(resource.router, prefix=API)
    app.include_router(pages.router)
    return app


@asynccontextmanager
async def _serving(settings: Settings, analyze: Analyze, app: FastAPI) -> AsyncIterator[None]:
    """All that an app needs while it serves: the data folder, workers, flights."""
    store = Store(
        settings.data,
        settings.database_url,
        keep_traces=settings.keep_traces,
        keep_trace_bytes=settings.keep_trace_bytes,
        upload_limits=_upload_limits(settings),
    )
    limits = Limits(settings.worker_memory_bytes, _NICENESS)
    pool = WorkerPool(settings.workers, limits, settings.max_waiting)
    service = open_service(settings, store, pool)
    services = app.state.services = Services(settings, store, pool, service, analyze)
    calls = CallbackService(
        service.callbacks, services.callback_hosts, settings.callback_secret or ""
    )
    service.start()
    calls.start()
    expiry = asyncio.create_task(uploads.expire_uploads(store.uploads))
    try:
        yield
    finally:
        expiry.cancel()
        await services.simulations.close()
        await services.calibrations.close()
        await services.sweeps.close()
        await run_in_threadpool(calls.close)
        await run_in_threadpool(service.close)
        pool.close()
        store.close()


def _upload_limits(settings: Settings) -> UploadLimits:
    return UploadLimits(
        file_bytes=settings.max_flight_bytes,
        total_bytes=settings.keep_upload_bytes,
        unfinished=settings.max_unfinished_uploads,
        expires_s=settings.upload_expires_seconds,
        telemetry_bytes=settings.max_telemetry_bytes,
        still_pixels=settings.max_image_pixels,
        zip=ZipLimits(settings.max_zip_files, settings.max_zip_bytes, settings.max_zip_ratio),
    )
