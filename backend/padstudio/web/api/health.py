"""Whether the server is up."""

from __future__ import annotations

from fastapi import APIRouter

from padstudio import __version__
from padstudio.web.schemas.base import Health

router = APIRouter(tags=["server"])


@router.get("/health", operation_id="getHealth", summary="Whether the server is up")
def get_health() -> Health:
    return Health(version=__version__)
