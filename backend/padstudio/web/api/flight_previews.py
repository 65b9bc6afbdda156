"""A frame with its pose, at once."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from fastapi import APIRouter, Query
from fastapi.concurrency import run_in_threadpool
from starlette.responses import Response

from padstudio.flights.pictures.previews import preview
from padstudio.flights.pictures.stages import PictureJob
from padstudio.flights.results.rows import Record
from padstudio.web.api.flights import FrameNumber
from padstudio.web.server.services import ERRORS, ItemId, Services, Shared

router = APIRouter(prefix="/flights", tags=["flights"], responses=ERRORS)

_PICTURE: dict[int | str, dict[str, Any]] = {
    200: {
        "description": "The picture.",
        "content": {
            "image/jpeg": {
                "schema": {"type": "string", "format": "binary"},
                "example": "(the bytes of a JPEG file)",
            }
        },
    }
}
_HEADERS = {"Cache-Control": "private, max-age=3600"}


@router.get(
    "/{flight_id}/frames/{number}/preview.jpg",
    operation_id="getFramePreview",
    summary="A frame with the pad where its pose says that it lies",
    response_class=Response,
    responses=_PICTURE,
)
async def get_frame_preview(
    flight_id: ItemId,
    number: FrameNumber,
    shared: Shared,
    width: Annotated[int, Query(ge=16, le=4096, description="Most pixels.")] = 1280,
) -> Response:
    job, record = await run_in_threadpool(_job, shared, flight_id, number)
    data = await shared.run(preview, job, record, width, timeout_s=shared.settings.detect_seconds)
    return Response(data, media_type="image/jpeg", headers=_HEADERS)


def _job(shared: Services, flight_id: str, number: int) -> tuple[PictureJob, Record]:
    flight = shared.flights.flights.get(flight_id)
    record = shared.flights.results.frame(flight, number)
    return shared.flights.picture_job(flight_id, number, "webp", Path()), record
