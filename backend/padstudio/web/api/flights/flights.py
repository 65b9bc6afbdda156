"""Flights: analyses of uploaded videos and stills, their progress and their results."""

from __future__ import annotations

from collections.abc import AsyncIterator
from dataclasses import fields, replace
from functools import partial
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Header, Path, Query, Response
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import StreamingResponse

from padstudio.errors import NotFoundError, SpecError
from padstudio.flights.jobs import FlightOrder
from padstudio.flights.results.frames import FrameFilter
from padstudio.pad.identity import pad_id
from padstudio.pad.spec import Pad
from padstudio.store.database.flight_tables import OPEN, FlightRow
from padstudio.store.store import Store
from padstudio.web.api.cameras import find_camera
from padstudio.web.api.flights.recordings import with_recordings
from padstudio.web.http.event_stream import EventStream, event
from padstudio.web.schemas.base import NewName
from padstudio.web.schemas.flights import (
    Flight,
    FlightDetail,
    FlightList,
    FlightSettings,
    FlightSummary,
    FramePage,
    FrameQuery,
    FrameResult,
    NewFlight,
    PadIds,
    RerunSettings,
    TelemetryColumns,
)
from padstudio.web.server.services import ERRORS, ItemId, Services, Shared

router = APIRouter(prefix="/flights", tags=["flights"], responses=ERRORS)

OrderKey = Annotated[
    str | None,
    Header(
        alias="Idempotency-Key",
        pattern=r"^[A-Za-z0-9_-]{16,64}$",
        description="An order that is sent again under the same key makes no second flight.",
    ),
]
FrameNumber = Annotated[int, Path(ge=0, le=2**31 - 1, examples=[412])]
_FILTERS = {field.name for field in fields(FrameFilter)}
#: How frames are read unless something else is asked for.
DEFAULTS: dict[str, Any] = {
    "method": "dense",
    "params": {},
    "first_frame": 0,
    "end_frame": None,
    "stride": 1,
    "apply_rotation": True,
    "fuse": True,
    "smooth": False,
    "topic": None,
    "only": None,
}
_EVENTS: dict[int | str, dict[str, Any]] = {
    200: {
        "description": "Server-Sent Events `flight`, each with a flight as JSON; the stream ends "
        "with the flight.",
        "content": {
            "text/event-stream": {
                "schema": {},
                "example": 'event: flight\r\ndata: {"id": "5d2f0a91c3b7e846", "state": "done"}\r\n',
            }
        },
    }
}


@router.post(
    "",
    operation_id="createFlight",
    summary="Analyse uploads",
    status_code=202,
    responses={200: {"description": "A flight was ordered under this key already; this is it."}},
)
def create_flight(
    new: NewFlight, shared: Shared, response: Response, key: OrderKey = None
) -> FlightDetail:
    flight = None if key is None else shared.flights.flights.of_key(key)
    if flight is None:
        flight = order_flight(new, shared, key)
    else:
        response.status_code = 200
    response.headers["Location"] = f"/api/v1/flights/{flight.id}"
    return describe_detail(shared, shared.flights.flights.get(flight.id, texts=True))


@router.get("", operation_id="listFlights", summary="The flights, newest first")
def list_flights(
    shared: Shared,
    limit: Annotated[int, Query(ge=1, le=200)] = 50,
    offset: Annotated[int, Query(ge=0, le=2**31)] = 0,
    state: Literal["queued", "running", "done", "failed", "cancelled"] | None = None,
) -> FlightList:
    rows, total = shared.flights.flights.list(limit, offset, state)
    return FlightList(items=[describe(shared, row) for row in rows], total=total)


@router.get("/{flight_id}", operation_id="getFlight", summary="A flight and how far it is")
def get_flight(flight_id: ItemId, shared: Shared) -> FlightDetail:
    return describe_detail(shared, shared.flights.flights.get(flight_id, texts=True))


@router.patch("/{flight_id}", operation_id="renameFlight", summary="Call a flight otherwise")
def rename_flight(flight_id: ItemId, new: NewName, shared: Shared) -> Flight:
    return describe(shared, shared.flights.flights.rename(flight_id, new.name.strip()))


@router.delete(
    "/{flight_id}", operation_id="deleteFlight", summary="Remove a flight", status_code=204
)
def delete_flight(flight_id: ItemId, shared: Shared) -> None:
    shared.flights.delete(flight_id)


@router.post("/{flight_id}/cancel", operation_id="cancelFlight", summary="Stop a flight")
def cancel_flight(flight_id: ItemId, shared: Shared) -> Flight:
    return describe(shared, shared.flights.cancel(flight_id))


@router.post(
    "/{flight_id}/retry",
    operation_id="retryFlight",
    summary="Do again what failed or was cancelled",
    status_code=202,
)
def retry_flight(flight_id: ItemId, shared: Shared) -> Flight:
    return describe(shared, shared.flights.retry(flight_id))


@router.post(
    "/{flight_id}/rerun",
    operation_id="rerunFlight",
    summary="Run it again otherwise, beside the first run",
    status_code=202,
)
def rerun_flight(
    flight_id: ItemId, changes: RerunSettings, shared: Shared, response: Response
) -> FlightDetail:
    def change(order: FlightOrder) -> FlightOrder:
        order = with_recordings(_changed(order, changes, shared), changes, shared)
        if changes.only is None:
            return order
        only = {"flight": flight_id, "reason": changes.only.reason}
        return replace(order, request=dict(order.request) | {"only": only})

    flight = shared.flights.rerun(flight_id, change)
    response.headers["Location"] = f"/api/v1/flights/{flight.id}"
    return describe_detail(shared, shared.flights.flights.get(flight.id, texts=True))


@router.get(
    "/{flight_id}/events",
    operation_id="watchFlight",
    summary="Progress as it happens",
    response_class=StreamingResponse,
    responses=_EVENTS,
)
async def watch_flight(flight_id: ItemId, shared: Shared) -> EventStream:
    # Raises where there is none.
    await run_in_threadpool(shared.flights.flights.get, flight_id)
    return EventStream(_events(shared, flight_id), shared.streams)


@router.get("/{flight_id}/frames", operation_id="listFrames", summary="Frames, page by page")
def list_frames(
    flight_id: ItemId, shared: Shared, query: Annotated[FrameQuery, Query()]
) -> FramePage:
    flight = shared.flights.flights.get(flight_id)
    wanted = FrameFilter(**query.model_dump(include=_FILTERS))
    records = shared.flights.results.page(flight, wanted, query.limit, query.after, query.before)
    full = len(records) == query.limit and (query.before is None or query.after is not None)
    return FramePage(
        items=[FrameResult.model_validate(record) for record in records],
        next_after=records[-1]["frame"] if full else None,
    )


@router.get("/{flight_id}/frames/{number}", operation_id="getFrame", summary="One frame's result")
def get_frame(flight_id: ItemId, number: FrameNumber, shared: Shared) -> FrameResult:
    flight = shared.flights.flights.get(flight_id)
    return FrameResult.model_validate(shared.flights.results.frame(flight, number))


@router.get("/{flight_id}/summary", operation_id="getFlightSummary", summary="Figures of a flight")
def get_flight_summary(flight_id: ItemId, shared: Shared) -> FlightSummary:
    flight = shared.flights.flights.get(flight_id)
    return FlightSummary.model_validate(shared.flights.summaries.of(flight))


@router.get(
    "/{flight_id}/telemetry",
    operation_id="getFlightTelemetry",
    summary="What the camera wrote of the flight",
)
def get_flight_telemetry(flight_id: ItemId, shared: Shared) -> TelemetryColumns:
    flight = shared.flights.flights.get(flight_id, texts=True)
    if flight.telemetry is None:
        raise NotFoundError(
            "this flight has no telemetry; upload the SRT file beside the video",
            code="no_telemetry",
        )
    return TelemetryColumns.model_validate(flight.telemetry)


def order_flight(new: NewFlight, shared: Services, key: str | None = None) -> FlightRow:
    """Queue an analysis; raises as `FlightService.order`.

    Parameters
    ----------
    new : NewFlight
    shared : Services
    key : str or None
        A flight that is ordered under the same one is the one that is there.
    """
    order = FlightOrder("", new.uploads, "", "", DEFAULTS, key=key)
    order = _changed(order, new, shared)
    return shared.flights.order(with_recordings(order, new, shared))


def describe(shared: Services, row: FlightRow) -> Flight:
    """A flight as it is shown in lists."""
    return Flight.model_validate(_fields(shared, row))


def describe_detail(shared: Services, row: FlightRow) -> FlightDetail:
    """A flight as it is shown alone; loaded with its texts."""
    # Where workers find a file is none of the caller's business, and a zip may hold thousands.
    hidden = {"url", "members", "poses"}
    sources = [
        {name: value for name, value in source.items() if name not in hidden}
        for source in row.sources
    ]
    return FlightDetail.model_validate(
        _fields(shared, row)
        | {
            "sources": sources,
            "telemetry": row.telemetry is not None,
            "callback": shared.flights.callbacks.of(row),
        }
    )


def _fields(shared: Services, row: FlightRow) -> dict[str, Any]:
    names = (
        "id",
        "name",
        "state",
        "created_at",
        "started_at",
        "finished_at",
        "frames_total",
        "frames_done",
        "frames_ok",
        "error",
        "rerun_of",
        "request",
    )
    done = row.frames_done / row.frames_total if row.frames_total else 0.0
    notice = shared.flights.trouble if row.state in OPEN else None
    shown = {name: getattr(row, name) for name in names}
    return shown | {"progress": round(done, 4), "notice": notice}


def _changed(order: FlightOrder, given: FlightSettings, shared: Services) -> FlightOrder:
    """An order with what was given in place of what it had."""
    store = shared.store
    if given.callback is not None:
        order = replace(order, callback=str(shared.callback_hosts.check(given.callback)))
    values = given.model_dump(exclude_unset=True)
    request = DEFAULTS | dict(order.request)
    request |= {name: values[name] for name in DEFAULTS if name in values}
    request = {
        name: DEFAULTS[name] if value is None and name in DEFAULTS else value
        for name, value in request.items()
    }
    end = request["end_frame"]
    if end is not None and end <= request["first_frame"]:
        raise SpecError(
            f"end_frame {end} must be above first_frame {request['first_frame']}",
            code="invalid_range",
        )
    if given.pad is not None:
        order = _with_pads(order, given.pad, request, store)
    if given.camera is not None:
        camera = find_camera(store, given.camera)
        order = replace(order, camera=camera.content or "")
        request |= {"camera_id": camera.id, "camera_name": camera.summary.get("name", "")}
    name = given.name or order.name
    if not name:
        name = store.uploads.get(order.uploads[0]).name
    return replace(order, name=name, request=request)


def _with_pads(
    order: FlightOrder, given: PadIds, request: dict[str, Any], store: Store
) -> FlightOrder:
    """An order with other pads; they are named in its request."""
    stored = [store.pads.get(pad) for pad in ([given] if isinstance(given, str) else given)]
    first, *others = (pad.content or "" for pad in stored)
    named = [
        {
            "id": pad.id,
            "name": pad.summary.get("name", ""),
            "pad_id": pad_id(Pad.loads(pad.content or "")),
        }
        for pad in stored
    ]
    request["pads"] = named
    request["pad_id"] = named[0]["id"]
    request["pad_name"] = ", ".join(pad["name"] for pad in named)
    return replace(order, pad=first, other_pads=others)


async def _events(shared: Services, flight_id: str) -> AsyncIterator[bytes]:
    """The flight now, and after every change, until it is over."""
    async for data in shared.flight_watch.watch(flight_id, partial(_look, shared)):
        yield event("flight", data)


def _look(shared: Services, flight_id: str) -> tuple[str, bool]:
    """What a flight's watchers are told, and whether it is over."""
    flight = shared.flights.flights.get(flight_id)
    return describe(shared, flight).model_dump_json(), flight.state not in OPEN
