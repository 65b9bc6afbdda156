"""Pictures of the frames of flights, of their stages and of their poses, made when asked for."""

from __future__ import annotations

import asyncio
import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Depends, Query, Request
from fastapi import Path as PathParameter
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import FileResponse, Response

from padstudio import __version__
from padstudio.errors import NotFoundError
from padstudio.flights.pictures import stages as pictures
from padstudio.flights.pictures.previews import preview
from padstudio.flights.pictures.stages import Kind, PictureJob
from padstudio.flights.results.rows import Record
from padstudio.store.database.data_folder import remove
from padstudio.web.api.flights import FrameNumber
from padstudio.web.schemas.base import StageInfo
from padstudio.web.schemas.flights import FrameResult, FrameStages
from padstudio.web.server.services import ERRORS, ItemId, Services, Shared
from padstudio.workers import detection

router = APIRouter(prefix="/flights", tags=["flights"], responses=ERRORS)

_MEDIA_TYPES = {"webp": "image/webp", "png": "image/png"}
_KEPT = {"Cache-Control": "private, max-age=3600"}


def _picture(example: str, *media_types: str) -> dict[int | str, dict[str, Any]]:
    """The answer of a route that gives a picture, for the API's description."""
    schema = {"type": "string", "format": "binary"}
    content = {media: {"schema": schema, "example": example} for media in media_types}
    return {200: {"description": "The picture.", "content": content}}


@router.get(
    "/{flight_id}/frames/{number}/stages",
    operation_id="getFrameStages",
    summary="A frame's stages, with their pictures",
)
async def get_frame_stages(flight_id: ItemId, number: FrameNumber, shared: Shared) -> FrameStages:
    stages = await _painted(shared, flight_id, number, "webp")
    flight = await run_in_threadpool(shared.flights.flights.get, flight_id)
    record = await run_in_threadpool(shared.flights.results.frame, flight, number)
    base = f"/api/v1/flights/{flight_id}/frames/{number}/pictures/"
    return FrameStages(
        frame=number,
        result=FrameResult.model_validate(record),
        picture=f"{base}{pictures.FRAME}.webp",
        result_picture=f"{base}{pictures.RESULT}.webp",
        stages=[_stage(base, stage) for stage in stages],
    )


@dataclass(frozen=True)
class Shown:
    """Which picture of a frame."""

    stage: Annotated[
        str,
        PathParameter(
            pattern=r"^[a-z_]{1,30}$",
            examples=["edges"],
            description="A stage, `frame` for the frame itself, or `result`.",
        ),
    ]
    kind: Literal["webp", "png"]
    channel: Literal["red", "green", "blue"] | None = None
    width: Annotated[
        int | None,
        Query(ge=1, le=100_000, description="At least so wide is enough; for thumbnails."),
    ] = None

    @property
    def name(self) -> str:
        """The picture's file."""
        name = f"{self.stage}.{self.kind}"
        if self.channel:
            name = f"{self.channel}-{name}"
        is_small = self.width is not None and self.width <= detection.THUMBNAIL_WIDTH_PX
        return detection.THUMBNAIL_PREFIX + name if is_small else name


@router.get(
    "/{flight_id}/frames/{number}/pictures/{stage}.{kind}",
    operation_id="getFramePicture",
    summary="The picture of a frame's stage",
    response_class=FileResponse,
    responses=_picture("(the bytes of the picture)", *_MEDIA_TYPES.values()),
)
async def get_frame_picture(
    flight_id: ItemId,
    number: FrameNumber,
    shown: Annotated[Shown, Depends()],
    shared: Shared,
    request: Request,
) -> Response:
    await run_in_threadpool(shared.flights.flights.get, flight_id)
    name, kind = shown.name, shown.kind
    # What is painted follows from these alone.
    identity = f"{__version__} {flight_id} {number} {name}"
    etag = f'"{hashlib.sha256(identity.encode()).hexdigest()[:32]}"'
    headers = {"ETag": etag, **_KEPT}
    if etag in request.headers.get("if-none-match", ""):
        return Response(status_code=304, headers=headers)
    await _painted(shared, flight_id, number, kind)
    path = shared.flights.pictures.path(_key(flight_id, number, kind), name)
    if path is None:
        raise NotFoundError(
            f"the stage {shown.stage} did not run in this frame, or left nothing to see; "
            f"/api/v1/flights/{flight_id}/frames/{number}/stages lists those that did",
            code="no_picture",
        )
    return FileResponse(path, media_type=_MEDIA_TYPES[kind], headers=headers)


async def _painted(
    shared: Services, flight_id: str, number: int, kind: Kind
) -> list[dict[str, Any]]:
    """The stages of a frame, painted; a page that asks for twenty at once causes one painting."""
    key = _key(flight_id, number, kind)
    stages = shared.flights.pictures.stages(key)
    if stages is not None:
        return stages
    painting = shared.painting.get(key)
    if painting is None:
        painting = asyncio.ensure_future(_paint(shared, flight_id, number, kind))
        shared.painting[key] = painting
        painting.add_done_callback(lambda _: shared.painting.pop(key, None))
    # One browser that goes away must not take the picture from the others.
    return await asyncio.shield(painting)


async def _paint(shared: Services, flight_id: str, number: int, kind: Kind) -> list[dict[str, Any]]:
    folder: Path = await run_in_threadpool(shared.store.folder.work_folder)
    try:
        job = await run_in_threadpool(shared.flights.picture_job, flight_id, number, kind, folder)
        stages = await shared.run(pictures.paint, job, timeout_s=shared.settings.detect_seconds)
        key = _key(flight_id, number, kind)
        await run_in_threadpool(shared.flights.pictures.add, key, folder, stages)
        return stages
    finally:
        remove(folder)


def _key(flight_id: str, number: int, kind: Kind) -> str:
    return f"{flight_id}-{number}-{kind}"


def _stage(base: str, stage: dict[str, Any]) -> StageInfo:
    fields = {name: stage[name] for name in ("name", "channel", "elapsed_ms", "failure")}
    if stage["picture"] is None:
        return StageInfo(**fields, picture=None, thumbnail=None)
    query = [f"channel={stage['channel']}"] if stage["channel"] else []
    address = f"{base}{stage['name']}.webp"
    small = "&".join([*query, f"width={detection.THUMBNAIL_WIDTH_PX}"])
    whole = "&".join(query)
    return StageInfo(
        **fields,
        picture=f"{address}?{whole}" if whole else address,
        thumbnail=f"{address}?{small}",
    )


@router.get(
    "/{flight_id}/frames/{number}/preview.jpg",
    operation_id="getFramePreview",
    summary="A frame with the pad where its pose says that it lies",
    response_class=Response,
    responses=_picture("(the bytes of a JPEG file)", "image/jpeg"),
)
async def get_frame_preview(
    flight_id: ItemId,
    number: FrameNumber,
    shared: Shared,
    width: Annotated[int, Query(ge=16, le=4096, description="Most pixels.")] = 1280,
) -> Response:
    job, record = await run_in_threadpool(_preview_job, shared, flight_id, number)
    data = await shared.run(preview, job, record, width, timeout_s=shared.settings.detect_seconds)
    return Response(data, media_type="image/jpeg", headers=_KEPT)


def _preview_job(shared: Services, flight_id: str, number: int) -> tuple[PictureJob, Record]:
    flight = shared.flights.flights.get(flight_id)
    record = shared.flights.results.frame(flight, number)
    return shared.flights.picture_job(flight_id, number, "webp", Path()), record
