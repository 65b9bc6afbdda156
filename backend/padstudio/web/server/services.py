"""What the routers share: the settings, the store, the workers."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass, field
from functools import cached_property
from typing import Annotated, Any, TypeVar
from urllib.parse import quote

from fastapi import Depends, Path, Request, Response
from pydantic import BaseModel

from padstudio.errors import LimitError
from padstudio.flights.pictures.shelves import ShelfJob
from padstudio.flights.service import FlightService
from padstudio.live.stream.allowed import AllowedSources
from padstudio.store.store import Store, Stored
from padstudio.web.schemas.base import ErrorBody
from padstudio.web.server.calibration_service import CalibrationJob
from padstudio.web.server.callbacks.hosts import CallbackHosts
from padstudio.web.server.experiment_service import ExperimentJob
from padstudio.web.server.flight_watch import FlightWatch
from padstudio.web.server.folder_jobs import FolderJob, FolderJobs
from padstudio.web.server.grown_pads import GrownPads
from padstudio.web.server.live.service import LiveService
from padstudio.web.server.places import Places
from padstudio.web.server.settings import Settings
from padstudio.web.server.simulation_service import SimulationJob
from padstudio.web.server.sweep_service import Sweep, SweepService
from padstudio.web.server.turns import Turns
from padstudio.workers import detection
from padstudio.workers.pool import WorkerPool
from padstudio.workers.process import Call

ResultT = TypeVar("ResultT")
ModelT = TypeVar("ModelT", bound=BaseModel)
Analyze = Callable[[detection.Job], dict[str, Any]]


@dataclass(frozen=True)
class Shelving:
    """Frames that are being laid ready, and the task that is at it."""

    job: ShelfJob
    call: Call


@dataclass(frozen=True)
class Services:
    """What a running server has.

    Attributes
    ----------
    settings : Settings
    store : Store
    pool : WorkerPool
    flights : FlightService
    analyze : callable
        `padstudio.workers.detection.analyze`, or what stands in for it.
    turns : Turns
        At uploads.
    simulations : FolderJobs of SimulationJob
    calibrations : FolderJobs of CalibrationJob
    experiments : FolderJobs of ExperimentJob
        Those that are not kept yet.
    sweeps : SweepService
    grown : GrownPads
    painting : dict
        Pictures of frames that are being made, by name.
    making : dict
        Proxies of frames that are being made, by chunk.
    shelving : dict
        Decoded frames that are being laid ready, by video.
    flight_watch : FlightWatch
    """

    settings: Settings
    store: Store
    pool: WorkerPool
    flights: FlightService
    analyze: Analyze
    turns: Turns = field(default_factory=Turns)
    simulations: FolderJobs[SimulationJob] = field(
        default_factory=lambda: FolderJobs(
            "simulated flight", "simulated flights", "too_many_flights"
        )
    )
    calibrations: FolderJobs[CalibrationJob] = field(
        default_factory=lambda: FolderJobs("calibration", "calibrations", "too_many_calibrations")
    )
    experiments: FolderJobs[ExperimentJob] = field(
        default_factory=lambda: FolderJobs("experiment", "experiments", "too_many_experiments")
    )
    sweeps: SweepService = field(default_factory=SweepService)
    grown: GrownPads = field(default_factory=GrownPads)
    painting: dict[str, asyncio.Future[dict[str, Any]]] = field(default_factory=dict)
    making: dict[str, Future[None]] = field(default_factory=dict)
    shelving: dict[str, Shelving] = field(default_factory=dict)
    flight_watch: FlightWatch = field(default_factory=FlightWatch)

    async def run(self, function: Callable[..., ResultT], *args: Any, timeout_s: float) -> ResultT:
        """Call a function in a worker process; raises as `WorkerPool.submit` and its future."""
        return await asyncio.wrap_future(self.pool.submit(function, *args, timeout_s=timeout_s))

    async def run_at(
        self, home: str, function: Callable[..., ResultT], *args: Any, timeout_s: float
    ) -> ResultT:
        """As `run`, in the process that was last at the same thing, unless that is busy."""
        return await asyncio.wrap_future(
            self.pool.submit(function, *args, timeout_s=timeout_s, home=home)
        )

    async def work(self, function: Callable[..., ResultT], *args: Any, timeout_s: float) -> ResultT:
        """Call a function that takes its time, and lets requests go first; as `run`."""
        return await asyncio.wrap_future(
            self.pool.start(function, *args, timeout_s=timeout_s).future
        )

    @cached_property
    def streams(self) -> Places:
        """The event streams that may be open."""
        return Places(self.settings.max_streams)

    @cached_property
    def live(self) -> LiveService:
        """The live sessions."""
        given = self.settings
        return LiveService(given.max_live, given.live_idle_seconds, given.worker_memory_bytes)

    @cached_property
    def live_sources(self) -> AllowedSources:
        """Which streams may be opened."""
        given = self.settings
        return AllowedSources(given.live_sources, given.live_devices, given.live_files)

    @cached_property
    def callback_hosts(self) -> CallbackHosts:
        """Who may be called when a flight has ended."""
        return CallbackHosts(self.settings.callback_hosts)


def services(request: Request) -> Services:
    """The services of the app that a request came to."""
    value: Services = request.app.state.services
    return value


Shared = Annotated[Services, Depends(services)]
ItemId = Annotated[str, Path(pattern=r"^[A-Za-z0-9-]{1,64}$", examples=["3f0c5a9e1b7d2468"])]

_RETRY: dict[str, Any] = {"Retry-After": {"description": "Seconds.", "schema": {"type": "integer"}}}
_ERROR_HEADERS: dict[int, dict[str, Any]] = {
    401: {"WWW-Authenticate": {"description": "`Bearer`.", "schema": {"type": "string"}}},
    405: {"Allow": {"description": "What it takes.", "schema": {"type": "string"}}},
    503: _RETRY,
}
#: Errors that any route may answer with.
ERRORS: dict[int | str, dict[str, Any]] = {
    status: {
        "model": ErrorBody,
        "description": description,
        **({"headers": _ERROR_HEADERS[status]} if status in _ERROR_HEADERS else {}),
    }
    for status, description in {
        400: "The request cannot be read.",
        401: "The token is missing or wrong.",
        403: "From another site or under another host name.",
        404: "There is no such thing.",
        405: "The address does not take that method.",
        408: "The rest of the request did not come.",
        409: "Contradicts what is stored.",
        413: "Beyond a limit.",
        422: "A value or file is wrong.",
        500: "A fault of the program.",
        503: "Busy; try again.",
        507: "There is no room.",
    }.items()
}


#: Of an answer to something that was to be stored.
KNOWN: dict[int | str, dict[str, Any]] = {
    200: {"description": "The same was stored already; this is it, and nothing was added."}
}
#: Of an answer that is a file on the disk, of which a part can be asked for (RFC 9110).
PARTS: dict[int | str, dict[str, Any]] = {
    206: {"description": "The part of it that the header `Range` asks for."},
    416: {"model": ErrorBody, "description": "There is no such part."},
}
_BINARY: dict[str, Any] = {"type": "string", "format": "binary"}
# Whoever reads these by their type has values in hand, not bytes.
_TREES: dict[str, dict[str, Any]] = {"application/json": {"type": "object"}, "application/yaml": {}}


def file_answer(
    description: str, *media_types: str, example: str = "(the bytes of the file)"
) -> dict[int | str, dict[str, Any]]:
    """The answer of a route that gives a file, for the API's description.

    Parameters
    ----------
    description : str
    *media_types : str
        All that it may be sent as.
    example : str
    """
    content = {
        media: {"schema": _TREES.get(media, _BINARY), "example": example} for media in media_types
    }
    return {200: {"description": description, "content": content}}


#: A picture that changes only with what it shows; a list that opens again has it at once.
A_WHILE = {"Cache-Control": "private, max-age=300"}


def tell_known(stored: Stored, response: Response) -> None:
    """Answer 200 rather than 201 where nothing was added."""
    if stored.was_known:
        response.status_code = 200


def attachment(name: str, suffix: str) -> dict[str, str]:
    """The header that makes a browser save an answer under a name (RFC 6266)."""
    full = "".join(c if c.isalnum() or c in " -_" else "_" for c in name).strip() or "pad"
    plain = full.encode("ascii", "replace").decode().replace("?", "_")
    value = f"attachment; filename=\"{plain}{suffix}\"; filename*=UTF-8''{quote(full + suffix)}"
    return {"Content-Disposition": value}


def accepted(
    response: Response, listing: str, job: Sweep | FolderJob, model: type[ModelT]
) -> ModelT:
    """Describe a job that was taken on, and say where it is asked for.

    Parameters
    ----------
    response : Response
        Gets the header ``Location``.
    listing : str
        Where such jobs are, below ``/api/v1/``.
    job : Sweep or FolderJob
    model : type of BaseModel
        What describes it.
    """
    response.headers["Location"] = f"/api/v1/{listing}/{job.id}"
    return model.model_validate(job)


def check_size(size: int | None, limit: int, word: str) -> None:
    """Raise `LimitError` where a file is beyond its limit."""
    if size is not None and size > limit:
        raise LimitError(f"the {word} is {size / 1e6:.1f} MB; the limit is {limit / 1e6:g} MB")
