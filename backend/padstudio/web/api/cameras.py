"""Cameras: presets, import, list, get, rename, delete, file."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from typing import Annotated, Any, Literal

from fastapi import APIRouter, File, Form, Query, Response, UploadFile
from fastapi.concurrency import run_in_threadpool

from padstudio import text
from padstudio.errors import ConflictError
from padstudio.geometry import presets
from padstudio.geometry.camera import MAX_READOUT_MS, Camera
from padstudio.geometry.lens_fold import fold_note
from padstudio.store.store import Store, Stored
from padstudio.web.schemas.asked import Flag, Text
from padstudio.web.schemas.base import CameraList, CameraReadout, CameraSummary, NewName
from padstudio.web.server.services import (
    A_WHILE,
    ERRORS,
    KNOWN,
    ItemId,
    Services,
    Shared,
    attachment,
    check_size,
    file_answer,
    tell_known,
)
from padstudio.workers import cameras, thumbnails

router = APIRouter(prefix="/cameras", tags=["cameras"], responses=ERRORS)

_YAML, _TEXT = "application/yaml", "text/plain"
_CAMERA_FILE = file_answer(
    "The camera file, as an attachment.",
    *(_YAML, _TEXT),
    example="image_width: 2720\nimage_height: 1530\n",
)
CameraFile = Literal["camera.yaml", "opencv.yaml", "kalibr.yaml", "cameras.txt"]
# The form of each file, its type, and what its name ends with when it is saved.
_FILES: dict[CameraFile, tuple[str, str, str]] = {
    "camera.yaml": ("ros", _YAML, ".yaml"),
    # Its first line is no YAML.
    "opencv.yaml": ("opencv", _TEXT, ".opencv.yaml"),
    "kalibr.yaml": ("kalibr", _YAML, ".kalibr.yaml"),
    "cameras.txt": ("colmap", _TEXT, ".cameras.txt"),
}


@router.get(
    "/presets", operation_id="listCameraPresets", summary="Cameras from makers' data sheets"
)
def list_presets() -> CameraList:
    items = [
        CameraSummary(id=preset.id, **describe_camera(preset.camera, preset.note))
        for preset in presets.PRESETS.values()
    ]
    return CameraList(items=items, total=len(items))


@router.get("", operation_id="listCameras", summary="The stored cameras, newest first")
def list_cameras(
    shared: Shared,
    limit: Annotated[int, Query(ge=1, le=1000)] = 100,
    offset: Annotated[int, Query(ge=0, le=2**31)] = 0,
) -> CameraList:
    stored, total = shared.store.cameras.list(limit, offset)
    items = [_summary(item) for item in stored]
    return CameraList(items=items, total=total)


@router.post(
    "",
    operation_id="importCamera",
    summary="Store a camera's calibration",
    status_code=201,
    responses=KNOWN,
)
async def import_camera(
    file: Annotated[
        UploadFile,
        File(description="A calibration of ROS, OpenCV, Kalibr, PhotonVision, COLMAP, …"),
    ],
    shared: Shared,
    response: Response,
    name: Annotated[
        Text | None, Form(max_length=200, description="Instead of the file's own name.")
    ] = None,
    readout_ms: Annotated[
        float | None,
        Form(
            ge=0,
            le=MAX_READOUT_MS,
            description="Instead of the file's: first row to last row; 0 for a global shutter.",
        ),
    ] = None,
    no_distortion: Annotated[
        Flag, Form(description="The lens has none, and the file is silent of it.")
    ] = False,
    camera: Annotated[
        Text | None,
        Form(max_length=200, description="Of a file of several cameras, the name of the one."),
    ] = None,
) -> CameraSummary:
    check_size(file.size, shared.settings.max_camera_bytes, "camera file")
    found = await shared.run(
        cameras.read,
        *(await file.read(), file_name(file, "camera file"), no_distortion, camera or None),
        timeout_s=shared.settings.detect_seconds,
    )
    if name and name.strip():
        found = replace(found, name=name.strip())
    if readout_ms is not None:
        found = replace(found, readout_ms=readout_ms)
    return await run_in_threadpool(store_camera, shared, found, response)


@router.get("/{camera_id}", operation_id="getCamera", summary="A stored or preset camera")
def get_camera(camera_id: ItemId, shared: Shared) -> CameraSummary:
    preset = presets.PRESETS.get(camera_id)
    if preset is not None:
        return CameraSummary(id=preset.id, **describe_camera(preset.camera, preset.note))
    return _summary(shared.store.cameras.get(camera_id))


@router.patch("/{camera_id}", operation_id="renameCamera", summary="Call a camera otherwise")
def rename_camera(camera_id: ItemId, new: NewName, shared: Shared) -> CameraSummary:
    _refuse_preset(camera_id, "renamed")
    stored = shared.store.cameras.get(camera_id)
    camera = replace(Camera.loads(stored.content or ""), name=new.name.strip())
    summary = {**stored.summary, "name": camera.name}
    return _summary(shared.store.cameras.replace(camera_id, camera.to_ros_yaml(), summary))


@router.get(
    "/{camera_id}/thumbnail.png",
    operation_id="getCameraThumbnail",
    summary="A small picture of a square grid as a camera shows it",
    response_class=Response,
    responses=file_answer("The picture.", "image/png"),
)
def get_camera_thumbnail(camera_id: ItemId, shared: Shared) -> Response:
    data = thumbnails.of_camera(camera_text(shared.store, camera_id))
    return Response(data, media_type="image/png", headers=A_WHILE)


@router.put(
    "/{camera_id}/readout",
    operation_id="setCameraReadout",
    summary="Say how long a camera's shutter rolls; of a preset, a copy is stored",
)
def set_camera_readout(camera_id: ItemId, given: CameraReadout, shared: Shared) -> CameraSummary:
    cameras = shared.store.cameras
    known = find_camera(shared.store, camera_id)
    camera = replace(Camera.loads(known.content or ""), readout_ms=given.readout_ms)
    is_preset = camera_id in presets.PRESETS
    summary = describe_camera(camera, "" if is_preset else known.summary["note"])
    if is_preset:
        stored = cameras.add(camera.to_ros_yaml(), summary)
    else:
        stored = cameras.replace(camera_id, camera.to_ros_yaml(), summary)
    return _summary(stored)


@router.delete(
    "/{camera_id}", operation_id="deleteCamera", summary="Remove a camera", status_code=204
)
def delete_camera(camera_id: ItemId, shared: Shared) -> None:
    _refuse_preset(camera_id, "removed")
    shared.store.cameras.delete(camera_id)


@router.get(
    "/{camera_id}/files/{file}",
    operation_id="getCameraFile",
    summary="A camera as a file of ROS, OpenCV, Kalibr or COLMAP",
    response_class=Response,
    responses=_CAMERA_FILE,
)
def get_camera_file(camera_id: ItemId, file: CameraFile, shared: Shared) -> Response:
    name = get_camera(camera_id, shared).name
    content = camera_text(shared.store, camera_id)
    form, media_type, ending = _FILES[file]
    if form != "ros":
        content = Camera.loads(content).to_form(form)
    return Response(content, media_type=media_type, headers=attachment(name, ending))


def store_camera(shared: Services, camera: Camera, response: Response) -> CameraSummary:
    """Store a camera, and answer 200 where it was stored already."""
    note = "; ".join(each for each in (*camera.notes, fold_note(camera)) if each)
    stored = shared.store.cameras.add(camera.to_ros_yaml(), describe_camera(camera, note))
    tell_known(stored, response)
    return _summary(stored)


def id_of_camera(store: Store, camera: Camera) -> str:
    """The preset that a camera is, or the stored one; it is stored where it is neither."""
    text = camera.to_ros_yaml()
    for preset in presets.PRESETS.values():
        if preset.camera.to_ros_yaml() == text:
            return preset.id
    return store.cameras.add(text, describe_camera(camera, "")).id


def _summary(stored: Stored) -> CameraSummary:
    return CameraSummary(id=stored.id, created_at=stored.created_at, **stored.summary)


def _refuse_preset(camera_id: str, done: str) -> None:
    if camera_id in presets.PRESETS:
        raise ConflictError(f"presets belong to the program and cannot be {done}")


def camera_text(store: Store, camera: str) -> str:
    """The camera file of a stored or preset camera; raises as `find_camera`."""
    return find_camera(store, camera).content or ""


def find_camera(store: Store, camera: str) -> Stored:
    """A stored or preset camera by its id, or by a name that no other has.

    Raises
    ------
    NotFoundError
        If there is none.
    ConflictError
        If several stored ones have that name.
    """
    preset = presets.PRESETS.get(camera) or next(
        (each for each in presets.PRESETS.values() if each.camera.name == camera), None
    )
    if preset is None:
        return store.cameras.get(camera)
    summary = describe_camera(preset.camera, preset.note)
    return Stored(preset.id, datetime.now(UTC), summary, preset.camera.to_ros_yaml())


def file_name(file: UploadFile, default: str) -> str:
    """An upload's name for messages and records: no folders, nothing unprintable."""
    name = (file.filename or "").replace("\\", "/").rsplit("/", 1)[-1]
    return text.plain("".join(c for c in name if c.isprintable()))[:200] or default


def describe_camera(camera: Camera, note: str) -> dict[str, Any]:
    """What lists show of a camera."""
    return {
        "name": camera.name,
        "width": camera.width,
        "height": camera.height,
        "focal_px": camera.focal_px,
        "model": camera.model,
        "distortion": camera.distortion.tolist(),
        "nominal": camera.nominal,
        "readout_ms": camera.readout_ms,
        "note": note,
    }
