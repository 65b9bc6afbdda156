"""Live sessions: a camera's stream, or the browser's own camera, read as it comes."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator
from typing import Annotated, Any

from fastapi import APIRouter, File, Path, Query, Response, UploadFile
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import StreamingResponse

from padstudio.errors import NotFoundError, SpecError
from padstudio.live.stream.addresses import StreamAddress, parse_address
from padstudio.live.watched.order import BROWSER, LiveOrder
from padstudio.store.database.data_folder import new_id
from padstudio.web.api.cameras import find_camera
from padstudio.web.api.detect import Wanted, detected
from padstudio.web.http.event_stream import EventStream, event
from padstudio.web.schemas.base import DetectionAnswer
from padstudio.web.schemas.live import (
    LiveFrame,
    LiveFrames,
    LiveInfo,
    LiveList,
    LiveRecording,
    NewLive,
)
from padstudio.web.server.live.service import LiveSession
from padstudio.web.server.services import ERRORS, ItemId, Services, Shared, check_size

router = APIRouter(prefix="/live", tags=["live"], responses=ERRORS)

FrameNumber = Annotated[int, Path(ge=0, le=2**53, examples=[412])]
# So long a request waits for the next frame.
_WAIT_S = 2.0
# A session's state is told at most so often, s.
_TELL_EVERY_S = 0.1
_EVENTS: dict[int | str, dict[str, Any]] = {
    200: {
        "description": "Server-Sent Events: `session`, with a session as JSON, and `pose`, with a "
        "frame's number and record, ten a second at the most. The stream ends with the session.",
        "content": {
            "text/event-stream": {
                "schema": {"type": "string"},
                "example": 'event: pose\r\ndata: {"number": 412, "record": {"status": "ok"}}\r\n',
            }
        },
    }
}
_PICTURE: dict[int | str, dict[str, Any]] = {
    200: {
        "description": "The picture, as it was sent or as JPEG.",
        "content": {
            kind: {
                "schema": {"type": "string", "format": "binary"},
                "example": "(the bytes of a picture)",
            }
            for kind in ("image/jpeg", "image/png", "image/webp")
        },
    }
}


@router.post("", operation_id="startLive", summary="Start a live session", status_code=201)
async def start_live(new: NewLive, shared: Shared, response: Response) -> LiveInfo:
    store = shared.store
    address = None
    if new.source != BROWSER:
        address = await run_in_threadpool(_checked, shared, new.source)
    pads = [await run_in_threadpool(store.pads.get, pad) for pad in new.pads]
    camera = await run_in_threadpool(find_camera, store, new.camera)
    order = LiveOrder(
        source=address.shown if address else BROWSER,
        pads=tuple(pad.content or "" for pad in pads),
        camera=camera.content or "",
        max_pixels=shared.settings.max_image_pixels,
        recordings=store.folder.live,
        address=address,
    )
    session = LiveSession(
        source=order.source,
        pads=[{"id": pad.id, "name": pad.summary.get("name", "")} for pad in pads],
        camera={"id": camera.id, "name": camera.summary.get("name", "")},
    )
    shared.live.start(session, order)
    response.headers["Location"] = f"/api/v1/live/{session.id}"
    return _info(session)


@router.get("", operation_id="listLive", summary="The live sessions, newest first")
async def list_live(shared: Shared) -> LiveList:
    items = [_info(session) for session in shared.live.list()]
    return LiveList(items=items, total=len(items))


@router.get("/{session_id}", operation_id="getLive", summary="How a live session fares")
async def get_live(session_id: ItemId, shared: Shared) -> LiveInfo:
    return _info(shared.live.get(session_id))


@router.delete(
    "/{session_id}", operation_id="stopLive", summary="End a live session", status_code=204
)
async def stop_live(session_id: ItemId, shared: Shared) -> None:
    await shared.live.stop(session_id)


@router.get(
    "/{session_id}/events",
    operation_id="watchLive",
    summary="Follow a live session",
    response_class=StreamingResponse,
    responses=_EVENTS,
)
async def watch_live(session_id: ItemId, shared: Shared) -> EventStream:
    session = shared.live.get(session_id)
    return EventStream(_events(shared, session), shared.streams)


@router.get(
    "/{session_id}/frames", operation_id="listLiveFrames", summary="Frames of the last ten seconds"
)
async def list_live_frames(session_id: ItemId, shared: Shared) -> LiveFrames:
    items = await shared.live.get(session_id).call("frames")
    return LiveFrames(items=items, total=len(items))


@router.post(
    "/{session_id}/frames",
    operation_id="readLiveFrame",
    summary="Read a frame of the browser's camera; one at a time",
)
async def read_live_frame(
    session_id: ItemId,
    image: Annotated[UploadFile, File(description="JPEG, PNG or WebP.")],
    shared: Shared,
) -> LiveFrame:
    session = shared.live.get(session_id)
    check_size(image.size, shared.settings.max_upload_bytes, "frame")
    return LiveFrame.model_validate(await session.call("push", await image.read()))


@router.post(
    "/{session_id}/recording",
    operation_id="recordLive",
    summary="Begin to record: the stream as it comes, and the poses",
    status_code=201,
)
async def record_live(session_id: ItemId, shared: Shared) -> LiveRecording:
    session = shared.live.get(session_id)
    return LiveRecording.model_validate(await session.call("record", new_id()))


@router.delete(
    "/{session_id}/recording",
    operation_id="stopLiveRecording",
    summary="End the recording",
    # Not 204: who ends it wants to know which one it was.
    status_code=200,
)
async def stop_live_recording(session_id: ItemId, shared: Shared) -> LiveRecording:
    found = await shared.live.get(session_id).call("stop_recording")
    if found is None:
        raise NotFoundError("this session was not recorded", code="not_recorded")
    return LiveRecording.model_validate(found)


@router.get(
    "/{session_id}/newest",
    operation_id="getNewestLiveFrame",
    summary="The newest frame; waits for one after a number, two seconds at the most",
    response_model=LiveFrame,
    responses={204: {"description": "No frame has come yet."}},
)
async def get_newest_live_frame(
    session_id: ItemId,
    shared: Shared,
    after: Annotated[int, Query(ge=-1, le=2**53, description="The last one that was shown.")] = -1,
) -> LiveFrame | Response:
    found = await shared.live.get(session_id).call("newest", after, _WAIT_S)
    return Response(status_code=204) if found is None else LiveFrame.model_validate(found)


@router.get("/{session_id}/frames/{number}", operation_id="getLiveFrame", summary="A frame again")
async def get_live_frame(session_id: ItemId, number: FrameNumber, shared: Shared) -> LiveFrame:
    return LiveFrame.model_validate(await shared.live.get(session_id).call("frame", number))


@router.get(
    "/{session_id}/frames/{number}/picture",
    operation_id="getLivePicture",
    summary="A frame's picture",
    response_class=Response,
    responses=_PICTURE,
)
async def get_live_picture(session_id: ItemId, number: FrameNumber, shared: Shared) -> Response:
    data, media_type = await shared.live.get(session_id).call("picture", number)
    return Response(data, media_type=media_type, headers={"Cache-Control": "private, max-age=60"})


@router.post(
    "/{session_id}/frames/{number}/trace",
    operation_id="traceLiveFrame",
    summary="Read a frame again as a still, and keep it with all of its stages",
)
async def trace_live_frame(
    session_id: ItemId, number: FrameNumber, shared: Shared
) -> DetectionAnswer:
    session = shared.live.get(session_id)
    data, media_type = await session.call("picture", number)
    name = f"live-{number}.{media_type.rsplit('/', 1)[-1].replace('jpeg', 'jpg')}"
    pads = [pad["id"] for pad in session.pads]
    wanted = Wanted(pad=pads, camera=session.camera["id"], trace=True, paint=False)
    return await detected(shared, data, name, wanted)


def _checked(shared: Services, source: str) -> StreamAddress:
    """A stream's address as this server may open it."""
    address = parse_address(source)
    try:
        return shared.live_sources.check(address)
    except OSError as error:
        raise SpecError(
            f"the host {address.host} is not known; check its name, or write its IP address",
            code="unknown_host",
        ) from error


def _info(session: LiveSession) -> LiveInfo:
    names = ("id", "source", "created_at", "state", "error")
    shown: dict[str, Any] = {name: getattr(session, name) for name in names}
    shown |= {"pad": session.pads[0], "camera": session.camera}
    return LiveInfo.model_validate(shown | session.told)


async def _events(shared: Services, session: LiveSession) -> AsyncIterator[bytes]:
    """The session now, and after every change, until it is over."""
    told, number = "", -1
    async for _ in shared.live.watch(session):
        info = _info(session).model_dump_json()
        if info != told:
            told = info
            yield event("session", info)
        pose = session.pose
        if pose is not None and pose["number"] != number:
            number = pose["number"]
            yield event("pose", json.dumps(pose))
        await asyncio.sleep(_TELL_EVERY_S)
