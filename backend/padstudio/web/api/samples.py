"""The tour's sample that ships with the program: a pad, a camera and pictures of the pad."""

from __future__ import annotations

import re
from typing import Annotated, Any

from fastapi import APIRouter, Path
from fastapi.responses import FileResponse
from pydantic import BaseModel, ConfigDict, Field

from padstudio import resources
from padstudio.errors import NotFoundError
from padstudio.web.server.services import ERRORS

router = APIRouter(prefix="/samples", tags=["samples"], responses=ERRORS)

_BASE = "/api/v1/samples/"
_PAD, _CAMERA = "pad.json", "camera.yaml"
_FILE: dict[int | str, dict[str, Any]] = {
    200: {
        "description": "The file.",
        "content": {
            "image/jpeg": {"schema": {"type": "string", "format": "binary"}},
            "application/json": {"schema": {"type": "object"}, "example": {"format": "..."}},
            "application/yaml": {"schema": {"type": "string"}},
        },
    }
}


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
        raise NotFoundError(f"the sample has no file {name!r}; GET {_BASE[:-1]} lists them")
    return FileResponse(path, headers={"Cache-Control": "no-cache"})


def _order(name: str) -> tuple[bool, int, str]:
    """Names hold the height in millimetres; those that hold none come last."""
    height = re.search(r"(\d+)mm", name)
    return height is None, -int(height[1]) if height else 0, name
