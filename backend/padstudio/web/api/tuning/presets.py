"""Named settings of the detector, for everybody who uses the server."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path

from padstudio.flights.tasks.detectors import params_from
from padstudio.web.schemas.tuning import PresetInfo, PresetList, PresetSettings
from padstudio.web.server.services import ERRORS, Shared

router = APIRouter(prefix="/presets", tags=["tune"], responses=ERRORS)

Name = Annotated[
    str, Path(min_length=1, max_length=60, pattern=r"^[^/\x00-\x1f]+$", examples=["faint print"])
]


@router.get("", operation_id="listPresets", summary="Named settings of the detector")
def list_presets(shared: Shared) -> PresetList:
    items = [PresetInfo.model_validate(preset) for preset in shared.store.presets.list()]
    return PresetList(items=items)


@router.put("/{name}", operation_id="keepPreset", summary="Keep settings under a name")
def keep_preset(name: Name, settings: PresetSettings, shared: Shared) -> PresetInfo:
    params_from(settings.params)
    kept = shared.store.presets.put(name, settings.method, settings.params)
    return PresetInfo.model_validate(kept)


@router.delete(
    "/{name}", operation_id="deletePreset", summary="Remove named settings", status_code=204
)
def delete_preset(name: Name, shared: Shared) -> None:
    shared.store.presets.delete(name)
