"""The samples that ship with the program: a pad, pictures and a flight over it, their cameras."""

from __future__ import annotations

import re
from typing import Annotated

from fastapi import APIRouter, Path, Response
from fastapi.responses import FileResponse
from pydantic import BaseModel, ConfigDict, Field

from padstudio import resources
from padstudio.errors import NotFoundError, shown
from padstudio.geometry.camera import Camera
from padstudio.pad.spec import Pad
from padstudio.store.uploads.uploads import upload_file
from padstudio.web.api.cameras import describe_camera
from padstudio.web.api.flights.flights import describe, order_flight
from padstudio.web.schemas.flights import Flight, NewFlight
from padstudio.web.server.services import ERRORS, KNOWN, PARTS, Shared, file_answer
from padstudio.workers.pads import summarize

router = APIRouter(prefix="/samples", tags=["samples"], responses=ERRORS)

_BASE = "/api/v1/samples/"
_PAD, _CAMERA = "pad.json", "camera.yaml"
_FLIGHT, _FLIGHT_CAMERA, _FLIGHT_NAME = "flight/landing.mp4", "flight/camera.yaml", "sample landing"
_MEDIA_TYPES = {".jpg": "image/jpeg", ".json": "application/json", ".yaml": "application/yaml"}
_FILE = file_answer("The file.", *_MEDIA_TYPES.values()) | PARTS


class SampleList(BaseModel):
    """Addresses of the sample's files."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "pad": f"{_BASE}{_PAD}",
                    "camera": f"{_BASE}{_CAMERA}",
                    "pictures": [f"{_BASE}height_1300mm.jpg"],
                }
            ]
        }
    )

    pad: str
    camera: str
    pictures: list[str] = Field(description="From the highest to the lowest, then another pad.")


@router.get("", operation_id="listSamples", summary="The files of the tour's sample")
def list_samples() -> SampleList:
    names = sorted((path.name for path in resources.sample_folder().glob("*.jpg")), key=_order)
    pictures = [_BASE + name for name in names]
    return SampleList(pad=_BASE + _PAD, camera=_BASE + _CAMERA, pictures=pictures)


@router.post(
    "/flight",
    operation_id="orderSampleFlight",
    summary="Analyse the sample flight, with its pad and camera; the same flight where it is there",
    status_code=202,
    responses=KNOWN,
)
def order_sample_flight(shared: Shared, response: Response) -> Flight:
    folder, store = resources.sample_folder(), shared.store
    pad = Pad.load(folder / _PAD)
    stored_pad = store.pads.add(pad.dumps(), summarize(pad))
    camera = Camera.load(folder / _FLIGHT_CAMERA)
    stored_camera = store.cameras.add(camera.to_ros_yaml(), describe_camera(camera, ""))
    video = folder / _FLIGHT
    for flight in shared.flights.flights.list(200, 0)[0]:
        request = flight.request
        is_it = request.get("pad_id") == stored_pad.id and flight.name == _FLIGHT_NAME
        if is_it and request.get("camera_id") == stored_camera.id and flight.state != "failed":
            response.status_code = 200
            return describe(shared, flight)
    order = {
        "uploads": [upload_file(store.uploads, video, video.name).id],
        "pad": stored_pad.id,
        "camera": stored_camera.id,
        "name": _FLIGHT_NAME,
    }
    new = NewFlight.model_validate(order)
    return describe(shared, order_flight(new, shared))


@router.get(
    "/{name}",
    operation_id="getSampleFile",
    summary="A file of the sample",
    response_class=FileResponse,
    responses=_FILE,
)
def get_sample_file(
    name: Annotated[str, Path(pattern=r"^[a-z0-9_]{1,60}\.(jpg|json|yaml)$", examples=[_PAD])],
) -> FileResponse:
    path = resources.sample_folder() / name
    if not path.is_file():
        raise NotFoundError(f"the sample has no file {shown(name)}; GET {_BASE[:-1]} lists them")
    kept = {"Cache-Control": "no-cache"}
    return FileResponse(path, media_type=_MEDIA_TYPES[path.suffix], headers=kept)


def _order(name: str) -> tuple[bool, int, str]:
    """Names hold the height in millimetres; those that hold none come last."""
    height = re.search(r"(\d+)mm", name)
    return height is None, -int(height[1]) if height else 0, name
