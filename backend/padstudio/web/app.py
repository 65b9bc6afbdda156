"""The web application: REST under /api/v1, the pages, the pages' files."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from functools import partial

from fastapi import APIRouter, FastAPI

from padstudio import __version__
from padstudio.errors import SpecError
from padstudio.web.api import (
    calibrations,
    cameras,
    coverage,
    detect,
    live,
    pads,
    printing,
    uploads,
)
from padstudio.web.api.experiments import experiments
from padstudio.web.api.flights import (
    comparisons,
    exports,
    figures,
    flights,
    live_recordings,
    pictures,
    proxies,
    samples,
    simulations,
)
from padstudio.web.api.tuning import bundles, looks, presets, sweeps
from padstudio.web.http import errors
from padstudio.web.http.closing import Closing, ClosingGuard
from padstudio.web.http.methods import Methods
from padstudio.web.http.openapi import DescribedApp
from padstudio.web.http.security import Guard
from padstudio.web.pages import pages, static
from padstudio.web.schemas.base import Health
from padstudio.web.server.services import ERRORS, Analyze
from padstudio.web.server.settings import Settings, load_settings
from padstudio.web.server.studio import Studio
from padstudio.workers import detection

API = "/api/v1"
_DESCRIPTION = (
    "Design pads, and find them in pictures. Every error has one shape, `ErrorBody`. A server "
    "that asks for a token takes it as `Authorization: Bearer <token>` or `?token=<token>`."
)

#: In the order of the API's description.
_RESOURCES = (
    *(pads, cameras, calibrations, detect, samples, uploads, printing, coverage),
    *(flights, live_recordings, figures, comparisons, pictures, proxies, exports, simulations),
    *(experiments, looks, presets, sweeps, bundles, live),
)
_health = APIRouter(tags=["server"])


@_health.get(
    "/health",
    operation_id="getHealth",
    summary="Whether the server is up",
    openapi_extra={"security": []},
)
def get_health() -> Health:
    return Health(version=__version__)


def create_app(
    settings: Settings | None = None,
    *,
    analyze: Analyze = detection.analyze,
    studio: Studio | None = None,
) -> FastAPI:
    """Build the application; the data folder is opened when it starts to serve.

    Parameters
    ----------
    settings : Settings or None
        None reads the environment.
    analyze : callable
        Importable by name; runs in worker processes.
    studio : Studio or None
        Of these settings, where it is open already.

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

    def open_studio() -> Studio:
        return studio or Studio.open(settings, analyze)

    app = DescribedApp(
        title="Pad Studio",
        version=__version__,
        description=_DESCRIPTION,
        openapi_url=f"{API}/openapi.json",
        # FastAPI's own documentation pages load scripts from another host.
        docs_url=None,
        redoc_url=None,
        lifespan=partial(_serving, open_studio),
    )
    app.state.settings = settings
    errors.install(app)
    app.include_router(_health, prefix=API, responses=ERRORS)
    for resource in _RESOURCES:
        app.include_router(resource.router, prefix=API)
    app.include_router(pages.router)
    routers = (_health, *(resource.router for resource in _RESOURCES))
    routes = [(API, route) for router in routers for route in router.routes]
    routes += [("", route) for route in (*pages.router.routes, *static.router.routes)]
    app.add_middleware(Methods, routes=routes)
    app.add_middleware(Guard, settings=settings)
    app.state.closing = Closing()
    app.add_middleware(ClosingGuard, closing=app.state.closing)
    return app


@asynccontextmanager
async def _serving(open_studio: Callable[[], Studio], app: FastAPI) -> AsyncIterator[None]:
    """All that an app needs while it serves."""
    studio = open_studio()
    services = app.state.services = studio.services
    studio.start()
    expiry = asyncio.create_task(uploads.expire_uploads(services.store.uploads))
    try:
        yield
    finally:
        expiry.cancel()
        await studio.close()
