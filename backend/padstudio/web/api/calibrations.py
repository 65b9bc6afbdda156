"""Calibrations of cameras from pictures of a pad, as jobs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path as FilePath
from typing import Annotated

from fastapi import APIRouter, Path, Response
from fastapi.concurrency import run_in_threadpool

from padstudio.calibration.calibrate import MOST_PICTURES
from padstudio.errors import ConflictError, LimitError, NotFoundError, SpecError
from padstudio.geometry.camera import Camera
from padstudio.geometry.camera_files.parts.fields import LensModel
from padstudio.store.database.data_folder import remove
from padstudio.store.store import Store
from padstudio.web.api.cameras import store_camera
from padstudio.web.schemas.base import CameraSummary
from padstudio.web.schemas.calibrations import CalibratedCamera, CalibrationInfo, NewCalibration
from padstudio.web.server.calibration_service import CalibrationJob
from padstudio.web.server.services import (
    A_WHILE,
    ERRORS,
    KNOWN,
    ItemId,
    Shared,
    accepted,
    file_answer,
)
from padstudio.workers import cameras

router = APIRouter(prefix="/calibrations", tags=["cameras"], responses=ERRORS)

_MODELS: dict[str, tuple[LensModel, ...]] = {
    "auto": ("radtan", "fisheye"),
    "radtan": ("radtan",),
    "fisheye": ("fisheye",),
}
_PICTURES = ("still", "stills", "video", "recording")
PictureNumber = Annotated[int, Path(ge=0, lt=MOST_PICTURES, examples=[3])]


@router.post(
    "",
    operation_id="calibrateCamera",
    summary="Calibrate a camera from uploaded pictures of a pad",
    status_code=202,
)
async def calibrate_camera(
    new: NewCalibration, shared: Shared, response: Response
) -> CalibrationInfo:
    settings, store = shared.settings, shared.store
    pad = await run_in_threadpool(store.pads.get, new.pad)
    files = await run_in_threadpool(_files, store, new.uploads)
    job = CalibrationJob(
        name=new.name or "calibrated camera",
        pad=pad.id,
        folder=await run_in_threadpool(store.folder.work_folder),
    )

    async def work(job: CalibrationJob) -> None:
        job.camera_yaml, job.result = await shared.work(
            cameras.calibrate_pictures,
            *(pad.content or "", files, _MODELS[new.lens]),
            *(settings.max_image_pixels, job.folder),
            timeout_s=settings.calibrate_seconds,
        )

    try:
        shared.calibrations.start(job, work)
    except LimitError:
        remove(job.folder)
        raise
    return accepted(response, "calibrations", job, CalibrationInfo)


@router.get("/{calibration_id}", operation_id="getCalibration", summary="How far a calibration is")
async def get_calibration(calibration_id: ItemId, shared: Shared) -> CalibrationInfo:
    return CalibrationInfo.model_validate(shared.calibrations.get(calibration_id))


@router.get(
    "/{calibration_id}/pictures/{number}.webp",
    operation_id="getCalibrationPicture",
    summary="A picture with its residuals, drawn a hundred times as long",
    response_class=Response,
    responses=file_answer("The picture.", "image/webp"),
)
async def get_calibration_picture(
    calibration_id: ItemId, number: PictureNumber, shared: Shared
) -> Response:
    job = _done(shared.calibrations.get(calibration_id))
    file = cameras.picture_file(job.folder, number)
    if not file.exists():
        raise NotFoundError("this calibration has no picture of that number")
    data = await run_in_threadpool(file.read_bytes)
    return Response(data, media_type="image/webp", headers=A_WHILE)


@router.post(
    "/{calibration_id}/camera",
    operation_id="storeCalibratedCamera",
    summary="Store the camera of a calibration",
    status_code=201,
    responses=KNOWN,
)
def store_calibrated_camera(
    calibration_id: ItemId, wanted: CalibratedCamera, shared: Shared, response: Response
) -> CameraSummary:
    job = _done(shared.calibrations.get(calibration_id))
    camera = Camera.loads(job.camera_yaml)
    name = (wanted.name or job.name).strip() or job.name
    camera = replace(camera, name=name, readout_ms=wanted.readout_ms)
    return store_camera(shared, camera, response)


@router.delete(
    "/{calibration_id}",
    operation_id="deleteCalibration",
    summary="Stop a calibration that is not done; else forget it",
    status_code=204,
)
async def delete_calibration(calibration_id: ItemId, shared: Shared) -> None:
    shared.calibrations.remove(calibration_id)


def _done(job: CalibrationJob) -> CalibrationJob:
    if job.state != "done":
        raise ConflictError(
            f"the calibration is {job.state}; only one that is done has a camera", code="not_done"
        )
    return job


def _files(store: Store, uploads: list[str]) -> list[tuple[str, FilePath]]:
    """Names and paths of uploads that hold pictures."""
    files = []
    for upload_id in uploads:
        upload, path = store.uploads.get(upload_id), store.uploads.path(upload_id)
        if upload.kind not in _PICTURES:
            raise SpecError(
                f"{upload.name} is no picture and no video; choose stills or a clip of the pad",
                code="no_pictures",
            )
        files.append((upload.name, path))
    return files
