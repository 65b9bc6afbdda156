"""One picture through the detector, at once; and the traces of the newest ones."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Depends, File, Form, Query, UploadFile
from fastapi import Path as PathParameter
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import FileResponse
from pydantic import Field

from padstudio.store.database.data_folder import remove
from padstudio.store.store import new_id
from padstudio.web.api.cameras import camera_text, file_name
from padstudio.web.schemas.asked import Flag, Text
from padstudio.web.schemas.base import MAX_PADS, DetectionAnswer
from padstudio.web.schemas.bundles import KeptAnswer
from padstudio.web.server.services import (
    ERRORS,
    PARTS,
    ItemId,
    Services,
    Shared,
    check_size,
    file_answer,
)
from padstudio.workers import detection

router = APIRouter(prefix="/detect", tags=["detect"], responses=ERRORS)

_PICTURE = file_answer("The picture, or its thumbnail.", "image/png", "image/webp") | PARTS
# A trace never changes; its id is never given again.
_FOREVER = {"Cache-Control": "private, max-age=31536000, immutable"}


@dataclass(frozen=True)
class Wanted:
    """The form's fields beside the picture: with what it is read, and how."""

    pad: Annotated[
        list[Annotated[Text, Field(min_length=1, max_length=200)]],
        Form(
            min_length=1,
            max_length=MAX_PADS,
            description="Id or name of a stored pad; again for more pads that may be in view.",
        ),
    ]
    camera: Annotated[
        Text, Form(min_length=1, max_length=200, description="Id or name of a camera.")
    ]
    method: Annotated[Literal["dense", "paper"], Form()] = "dense"
    unmix: Annotated[Flag, Form(description="By the pad's crosstalk, where it has one.")] = True
    at_rest: Annotated[Flag, Form(description="The camera stood still, as on a tripod.")] = False
    trace: Annotated[Flag, Form(description="Keep the picture, and what came of it.")] = False
    paint: Annotated[
        Flag, Form(description="With pictures of every stage; POST /looks shows them without.")
    ] = True


@router.post("", operation_id="detectImage", summary="Find pads in one picture")
async def detect_image(
    shared: Shared,
    image: Annotated[UploadFile, File(description="JPEG, PNG, WebP, TIFF or BMP.")],
    wanted: Annotated[Wanted, Depends()],
) -> DetectionAnswer:
    check_size(image.size, shared.settings.max_upload_bytes, "picture")
    return await detected(shared, await image.read(), file_name(image, "picture"), wanted)


@router.get(
    "/{trace_id}",
    operation_id="getDetection",
    summary="A kept answer again",
    # As it was: without a bundle where there was none.
    response_model_exclude_unset=True,
)
def get_detection(trace_id: ItemId, shared: Shared) -> KeptAnswer:
    return KeptAnswer.model_validate(shared.store.traces.body(trace_id))


@router.get(
    "/{trace_id}/pictures/{name}",
    operation_id="getDetectionPicture",
    summary="A stage's picture",
    response_class=FileResponse,
    responses=_PICTURE,
)
def get_detection_picture(
    trace_id: ItemId,
    name: Annotated[
        str, PathParameter(pattern=r"^[a-z_-]{1,60}\.png$", examples=["red-edges.png"])
    ],
    shared: Shared,
    width: Annotated[
        int | None,
        Query(ge=1, le=100_000, description="At least so wide is enough; for thumbnails."),
    ] = None,
) -> FileResponse:
    if width is not None and width <= detection.THUMBNAIL_WIDTH_PX:
        name = detection.thumbnail_of(name)
    path = shared.store.traces.picture(trace_id, name)
    return FileResponse(path, media_type=f"image/{path.suffix[1:]}", headers=_FOREVER)


async def detected(shared: Services, image: bytes, source: str, wanted: Wanted) -> DetectionAnswer:
    """What a picture of a name shows; kept where that is wanted.

    Raises
    ------
    StudioError
        As of `padstudio.workers.detection.analyze`, or where a pad or the camera is not stored.
    """
    settings, store = shared.settings, shared.store
    pads = [await run_in_threadpool(store.pads.get, pad) for pad in wanted.pad]
    folder = await run_in_threadpool(store.folder.work_folder) if wanted.trace else None
    try:
        job = detection.Job(
            image=image,
            source=source,
            pads=tuple(pad.content or "" for pad in pads),
            camera=await run_in_threadpool(camera_text, store, wanted.camera),
            method=wanted.method,
            max_pixels=settings.max_image_pixels,
            unmix=wanted.unmix,
            at_rest=wanted.at_rest,
            pictures=folder,
            paint=wanted.paint,
        )
        answer = await shared.run(shared.analyze, job, timeout_s=settings.detect_seconds)
        named = zip(pads, answer.pop("pad_ids"), strict=True)
        answer["pads"] = [
            {"id": pad.id, "name": pad.summary.get("name", ""), "pad_id": printed}
            for pad, printed in named
        ]
        answer["result"] = answer["results"][0]
        return await run_in_threadpool(_keep, shared, answer, job)
    finally:
        if folder is not None:
            remove(folder)


def _keep(shared: Services, answer: dict[str, Any], job: detection.Job) -> DetectionAnswer:
    """The answer with the addresses of its pictures; stored with the picture where wanted."""
    stages, folder = answer.pop("stages"), job.pictures
    if folder is None or stages is None:
        return DetectionAnswer(**answer, trace=None)
    (folder / detection.FRAME_FILE).write_bytes(job.image)
    trace_id = new_id()
    base = f"/api/v1/detect/{trace_id}/pictures/"
    for stage in stages:
        name = stage["picture"]
        stage["picture"] = base + name if name else None
        stage["thumbnail"] = _thumbnail(base + name) if name else None
    trace = {
        "id": trace_id,
        "result_picture": base + detection.RESULT_PICTURE if stages else None,
        "stages": stages,
    }
    kept = DetectionAnswer.model_validate({**answer, "trace": trace})
    shared.store.traces.add(trace_id, folder, kept.model_dump(mode="json"))
    return kept


def _thumbnail(address: str) -> str:
    return f"{address}?width={detection.THUMBNAIL_WIDTH_PX}"
