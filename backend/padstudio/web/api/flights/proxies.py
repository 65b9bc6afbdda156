"""Small pictures of a flight's frames in groups, and where the pad lies in them."""

from __future__ import annotations

from concurrent.futures import Future
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query
from fastapi import Path as PathParameter
from fastapi.responses import Response
from pydantic import BaseModel, ConfigDict

from padstudio.flights.pictures import proxies
from padstudio.flights.pictures.outlines import outline_of
from padstudio.flights.results.frames import FrameFilter
from padstudio.flights.tasks.from_rows import recipe_of
from padstudio.store.database.flight_tables import OPEN, FlightRow
from padstudio.web.server.services import ERRORS, ItemId, Services, Shared, file_answer

router = APIRouter(prefix="/flights", tags=["flights"], responses=ERRORS)

_MOST_OUTLINES = 200
_KEPT = {"Cache-Control": "private, max-age=3600"}
_NOT_KEPT = {"Cache-Control": "no-store"}
_BINARY = file_answer(
    "The length of a JSON object (uint32, little-endian), the object, and the JPEGs that its "
    "`frames` list, one behind the other.",
    "application/octet-stream",
)
_OUTLINES: dict[str, Any] = {
    "items": [{"frame": 412, "lines": [{"role": "side", "points": [[0.31, 0.2], [0.7, 0.21]]}]}]
}


class OutlineLine(BaseModel):
    """A side of the pad, or one of its axes."""

    role: Literal["side", "x", "y", "z"]
    points: list[tuple[float, float]]


class Outline(BaseModel):
    frame: int
    lines: list[OutlineLine]


class Outlines(BaseModel):
    """Lines in shares of a frame's width and height, (0, 0) its upper left corner."""

    model_config = ConfigDict(json_schema_extra={"examples": [_OUTLINES]})

    items: list[Outline]


@router.get(
    "/{flight_id}/outlines",
    operation_id="getFrameOutlines",
    summary="Where the pad lies in frames, as lines to draw over them",
)
def get_frame_outlines(
    flight_id: ItemId,
    shared: Shared,
    first_frame: Annotated[int, Query(ge=0, le=2**31 - 1)] = 0,
    limit: Annotated[int, Query(ge=1, le=_MOST_OUTLINES, description="Most frames.")] = 16,
) -> Outlines:
    flight = shared.flights.flights.get(flight_id, texts=True)
    records = shared.flights.results.page(flight, FrameFilter(), limit, first_frame - 1)
    recipe = recipe_of(flight)
    found = [{"frame": each["frame"], "lines": outline_of(recipe, each)} for each in records]
    return Outlines.model_validate({"items": found})


@router.get(
    "/{flight_id}/proxies/{group}",
    operation_id="getFrameProxies",
    summary="Small pictures of the frames of a group; where they lack, their making begins",
    response_class=Response,
    responses=_BINARY,
)
def get_frame_proxies(
    flight_id: ItemId,
    group: Annotated[int, PathParameter(ge=0, le=2**31 - 1, examples=[25])],
    shared: Shared,
) -> Response:
    store = shared.flights.proxies
    flight = shared.flights.pictured(shared.flights.flights.get(flight_id, texts=True))
    found, is_complete, making = {}, bool(flight.request.get("only")), None
    if flight.sources and not is_complete:
        target = store.target(flight)
        found = store.group(target, group)
        missing = [frame for frame in _wanted(flight, target.frames(group)) if frame not in found]
        is_complete = not missing
        if missing:
            making = _making(shared, flight, missing[0])
    return Response(
        proxies.answer(found, complete=is_complete, making=making),
        media_type="application/octet-stream",
        headers=_KEPT if is_complete else _NOT_KEPT,
    )


def _wanted(flight: FlightRow, frames: range) -> list[int]:
    """Those of a group's frames that the flight reads."""
    first, end = flight.request["first_frame"], flight.request["end_frame"]
    total = sum(source["frames"] for source in flight.sources)
    stop = total if end is None else min(end, total)
    return [frame for frame in frames if first <= frame < stop]


def _making(shared: Services, flight: FlightRow, frame: int) -> dict[str, int] | None:
    """How far the making of a frame's proxy is, which begins with this; None where its chunk is at
    work and brings it.

    Raises
    ------
    StudioError
        Once, where it failed; the next call has it made again.
    """
    job, chunk = shared.flights.proxy_job(flight, frame)
    if chunk.state in OPEN and shared.settings.scheduler is None:
        return None
    key = f"{job.target.folder}/{job.first_frame}"
    made: Future[None] | None = shared.making.get(key)
    if made is not None and made.done():
        del shared.making[key]
        made.result()
        made = None
    if made is None:
        shared.flights.proxies.trim()
        shared.making[key] = shared.pool.start(proxies.make, job).future
    frames = range(chunk.first_frame, frame + 1, job.target.stride)
    return {"done": shared.flights.proxies.count(job.target, frames), "total": len(frames)}
