"""Cameras: presets, import, list, get, delete, file."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any

from fastapi import APIRouter, File, Form, Query, Response, UploadFile

from padstudio.errors import ConflictError
from padstudio.geometry import presets
from padstudio.geometry.camera import MAX_READOUT_MS, Camera
from padstudio.store.store import Store
from padstudio.web.schemas.base import CameraList, CameraSummary
from padstudio.web.server.services import ERRORS, ItemId, Shared, attachment, check_size

router = APIRouter(prefix="/cameras", tags=["cameras"], responses=ERRORS)

_YAML = "application/yaml"
_YAML_EXAMPLE: dict[int | str, dict[str, Any]] = {
    200: {
        "description": "A ROS camera_info file, as an attachment.",
        "content": {
            _YAML: {
                "schema": {"type": "string"},
                "example": "image_width: 2720\nimage_height: 1530\n",
            }
        },
    }
}


@router.get(
    "/presets", operation_id="listCameraPresets", summary="Cameras from makers' data sheets"
)
def list_presets() -> CameraList:
    items = [
        CameraSummary(id=preset.id, **_describe(preset.camera, preset.note))
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
    items = [CameraSummary(id=item.id, **item.summary) for item in stored]
    return CameraList(items=items, total=total)


@router.post(
    "", operation_id="importCamera", summary="Store a camera's calibration", status_code=201
)
def import_camera(
    file: Annotated[
        UploadFile, File(description="ROS, OpenCV, Kalibr or PhotonVision calibration.")
    ],
    shared: Shared,
    name: Annotated[
        str | None, Form(max_length=200, description="Instead of the file's own name.")
    ] = None,
    readout_ms: Annotated[
        float | None,
        Form(
            ge=0,
            le=MAX_READOUT_MS,
            description="Instead of the file's: first row to last row; 0 for a global shutter.",
        ),
    ] = None,
) -> CameraSummary:
    check_size(file.size, shared.settings.max_camera_bytes, "camera file")
    camera = Camera.loads(file.file.read(), file_name(file, "camera file"))
    if name and name.strip():
        camera = replace(camera, name=name.strip())
    if readout_ms is not None:
        camera = replace(camera, readout_ms=readout_ms)
    summary = _describe(camera, "")
    stored = shared.store.cameras.add(camera.to_ros_yaml(), summary)
    return CameraSummary(id=stored.id, **summary)


@router.get("/{camera_id}", operation_id="getCamera", summary="A stored or preset camera")
def get_camera(camera_id: ItemId, shared: Shared) -> CameraSummary:
    preset = presets.PRESETS.get(camera_id)
    if preset is not None:
        return CameraSummary(id=preset.id, **_describe(preset.camera, preset.note))
    stored = shared.store.cameras.get(camera_id)
    return CameraSummary(id=stored.id, **stored.summary)


@router.delete(
    "/{camera_id}", operation_id="deleteCamera", summary="Remove a camera", status_code=204
)
def delete_camera(camera_id: ItemId, shared: Shared) -> None:
    if camera_id in presets.PRESETS:
        raise ConflictError("presets belong to the program and cannot be removed")
    shared.store.cameras.delete(camera_id)


@router.get(
    "/{camera_id}/files/camera.yaml",
    operation_id="getCameraFile",
    summary="A camera as ROS camera_info YAML",
    response_class=Response,
    responses=_YAML_EXAMPLE,
)
def get_camera_file(camera_id: ItemId, shared: Shared) -> Response:
    name = get_camera(camera_id, shared).name
    content = camera_text(shared.store, camera_id)
    return Response(content, media_type=_YAML, headers=attachment(name, ".yaml"))


def camera_text(store: Store, camera_id: str) -> str:
    """The camera file of a stored or preset camera.

    Raises
    ------
    NotFoundError
        If there is none of that id.
    """
    preset = presets.PRESETS.get(camera_id)
    if preset is not None:
        return preset.camera.to_ros_yaml()
    return store.cameras.get(camera_id).content or ""


def camera_name(store: Store, camera_id: str) -> str:
    """The name of a stored or preset camera; raises as `camera_text`."""
    preset = presets.PRESETS.get(camera_id)
    if preset is not None:
        return preset.camera.name
    return str(store.cameras.get(camera_id).summary.get("name", ""))


def file_name(file: UploadFile, default: str) -> str:
    """An upload's name for messages and records: no folders, nothing unprintable."""
    name = (file.filename or "").replace("\\", "/").rsplit("/", 1)[-1]
    return "".join(c for c in name if c.isprintable())[:200] or default


def _describe(camera: Camera, note: str) -> dict[str, Any]:
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
