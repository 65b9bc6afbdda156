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
from padstudio.flights.pictures.shelves import ShelfJob, lay_ready
from padstudio.flights.pictures.stages import PictureJob
from padstudio.flights.results.rows import Record
from padstudio.store.database.data_folder import remove
from padstudio.web.api.flights.flights import FrameNumber
from padstudio.web.schemas.asked import Flag
from padstudio.web.schemas.base import StageInfo
from padstudio.web.schemas.flights import FrameReadiness, FrameResult, FrameStages
from padstudio.web.server.services import (
    ERRORS,
    PARTS,
    ItemId,
    Services,
    Shared,
    Shelving,
    file_answer,
)
from padstudio.workers import detection

router = APIRouter(prefix="/flights", tags=["flights"], responses=ERRORS)

_MEDIA_TYPES = {"webp": "image/webp", "png": "image/png"}
# At frames that are being laid ready; the answer comes so much later at most.
_LOOK_EVERY_S = 0.03
_PICTURE = (
    file_answer("The picture.", *_MEDIA_TYPES.values())
    | PARTS
    | {304: {"description": "It is as it was."}}
)
_KEPT = {"Cache-Control": "private, max-age=3600"}


@router.get(
    "/{flight_id}/frames/{number}/stages",
    operation_id="getFrameStages",
    summary="A frame's stages, with their pictures",
)
async def get_frame_stages(flight_id: ItemId, number: FrameNumber, shared: Shared) -> FrameStages:
    painted = await _painted(shared, flight_id, number)
    flight = await run_in_threadpool(shared.flights.flights.get, flight_id)
    record = await run_in_threadpool(shared.flights.results.frame, flight, number)
    base = f"/api/v1/flights/{flight_id}/frames/{number}/pictures/"
    return FrameStages(
        frame=number,
        result=FrameResult.model_validate(record),
        image=painted["image"],
        picture=f"{base}{pictures.FRAME}.webp",
        result_picture=f"{base}{pictures.RESULT}.webp",
        stages=[_stage(base, stage) for stage in painted["stages"]],
    )


@router.get(
    "/{flight_id}/frames/{number}/readiness",
    operation_id="getFrameReadiness",
    summary="How far the decoding is that a frame's pictures wait for",
)
def get_frame_readiness(flight_id: ItemId, number: FrameNumber, shared: Shared) -> FrameReadiness:
    job = shared.flights.picture_job(flight_id, number, Path())
    if job.shelf is None or job.shelf.is_ready:
        return FrameReadiness(ready=True, done=1, total=1)
    done, total = job.shelf.progress
    return FrameReadiness(ready=False, done=done, total=total)


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
        """The picture's file, without its suffix."""
        return f"{self.channel}-{self.stage}" if self.channel else self.stage

    @property
    def is_small(self) -> bool:
        """True where the thumbnail, which is WebP, is wide enough."""
        is_narrow = self.width is not None and self.width <= detection.THUMBNAIL_WIDTH_PX
        return is_narrow and self.kind == "webp"


@router.get(
    "/{flight_id}/frames/{number}/pictures/{stage}.{kind}",
    operation_id="getFramePicture",
    summary="The picture of a frame's stage",
    response_class=FileResponse,
    responses=_PICTURE,
)
async def get_frame_picture(
    flight_id: ItemId,
    number: FrameNumber,
    shown: Annotated[Shown, Depends()],
    shared: Shared,
    request: Request,
) -> Response:
    await run_in_threadpool(shared.flights.flights.get, flight_id)
    # What is painted follows from these alone.
    identity = f"{__version__} {flight_id} {number} {shown.name} {shown.kind} {shown.is_small}"
    etag = f'"{hashlib.sha256(identity.encode()).hexdigest()[:32]}"'
    headers = {"ETag": etag, **_KEPT}
    if etag in request.headers.get("if-none-match", ""):
        return Response(status_code=304, headers=headers)
    await _painted(shared, flight_id, number)
    whole = shared.flights.pictures.path(_key(flight_id, number), shown.name + detection.RAW_SUFFIX)
    if whole is None:
        raise NotFoundError(
            f"the stage {shown.stage} did not run in this frame, or left nothing to see; "
            f"/api/v1/flights/{flight_id}/frames/{number}/stages lists those that did",
            code="no_picture",
        )
    if shown.is_small:
        path = whole.with_name(detection.thumbnail_of(whole.name))
        return FileResponse(path, media_type="image/webp", headers=headers)
    data = await shared.run(
        pictures.encode,
        whole.parent,
        shown.name,
        shown.kind,
        timeout_s=shared.settings.detect_seconds,
    )
    return Response(data, media_type=_MEDIA_TYPES[shown.kind], headers=headers)


async def _painted(shared: Services, flight_id: str, number: int) -> pictures.Painted:
    """The stages of a frame, painted; a page that asks for twenty at once causes one painting."""
    key = _key(flight_id, number)
    painted = shared.flights.pictures.painted(key)
    if painted is not None:
        return painted
    painting = shared.painting.get(key)
    if painting is None:
        painting = asyncio.ensure_future(_paint(shared, flight_id, number))
        shared.painting[key] = painting
        painting.add_done_callback(lambda _: shared.painting.pop(key, None))
    # One browser that goes away must not take the picture from the others.
    return await asyncio.shield(painting)


async def _paint(shared: Services, flight_id: str, number: int) -> pictures.Painted:
    folder: Path = await run_in_threadpool(shared.store.folder.work_folder)
    try:
        job = await run_in_threadpool(shared.flights.picture_job, flight_id, number, folder)
        await _lay_ready(shared, job.shelf)
        painted = await shared.run(pictures.paint, job, timeout_s=shared.settings.detect_seconds)
        key = _key(flight_id, number)
        await run_in_threadpool(shared.flights.pictures.add, key, folder, painted)
        return painted
    finally:
        remove(folder)


async def _lay_ready(shared: Services, job: ShelfJob | None) -> None:
    """Wait until a frame lies on its video's shelf, if a process is free to lay it there.

    Where that fails, who then reads the frame itself learns why.
    """
    if job is None or await run_in_threadpool(lambda: job.is_ample):
        return
    await run_in_threadpool(shared.flights.shelves.trim)
    name = job.folder.name
    at_work = shared.shelving.get(name)
    is_ready = await run_in_threadpool(lambda: job.is_ready)
    if at_work is not None and not at_work.call.future.done():
        if is_ready:
            return
        if not at_work.job.covers(job):
            at_work.call.stop()
            at_work = None
    else:
        at_work = None
    if at_work is None:
        if not shared.pool.free:
            return
        at_work = shared.shelving[name] = Shelving(job, shared.pool.start(lay_ready, job))
    while not is_ready and not at_work.call.future.done():
        await asyncio.sleep(_LOOK_EVERY_S)
        is_ready = await run_in_threadpool(lambda: job.is_ready)


def _key(flight_id: str, number: int) -> str:
    return f"{flight_id}-{number}"


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
    responses=file_answer("The picture.", "image/jpeg"),
)
async def get_frame_preview(
    flight_id: ItemId,
    number: FrameNumber,
    shared: Shared,
    width: Annotated[int, Query(ge=16, le=4096, description="Most pixels.")] = 1280,
    outline: Annotated[Flag, Query(description="Draw the pad.")] = True,
) -> Response:
    job, record = await run_in_threadpool(_preview_job, shared, flight_id, number)
    await _lay_ready(shared, job.shelf)
    if not outline:
        record = {"status": "failed"}
    data = await shared.run(preview, job, record, width, timeout_s=shared.settings.detect_seconds)
    return Response(data, media_type="image/jpeg", headers=_KEPT)


def _preview_job(shared: Services, flight_id: str, number: int) -> tuple[PictureJob, Record]:
    flight = shared.flights.flights.get(flight_id)
    record = shared.flights.results.frame(flight, number)
    return shared.flights.picture_job(flight_id, number, Path()), record
