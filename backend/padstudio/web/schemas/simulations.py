"""What requests and answers of simulated flights look like; the OpenAPI file's source."""

from __future__ import annotations

from datetime import datetime
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from padstudio.pad.coverage.spans import Method
from padstudio.simulate.radiance.scene import GroundKind
from padstudio.simulate.trajectories import FlightKind
from padstudio.simulate.video_writer import Codec
from padstudio.web.schemas.asked import Asked, Height
from padstudio.web.schemas.base import Disturbances, ErrorInfo

_SPEC_EXAMPLE: dict[str, Any] = {
    "pad": "3f0c5a9e1b7d2468",
    "camera": "preset-dji-mini-27k",
    "flight": "landing",
    "frames": 90,
    "from_mm": 3000,
    "to_mm": 100,
    "look": "shadow",
    "analyze": "dense",
}
_EXAMPLE: dict[str, Any] = {
    "id": "77c0a1de52b94f38",
    "name": "simulated landing, shadow",
    "state": "running",
    "created_at": "2026-05-04T09:30:00Z",
    "frames_total": 90,
    "frames_done": 41,
    "video": True,
    "upload": None,
    "flight": None,
    "error": None,
}


class SimulationSpec(Asked):
    """A flight to be simulated, and what is to be done with it."""

    model_config = ConfigDict(json_schema_extra={"examples": [_SPEC_EXAMPLE]})

    pad: str | None = Field(
        None, max_length=200, description="Id or name of a stored pad; null leaves the ground bare."
    )
    camera: str = Field(max_length=200, description="Id or name of a camera.")
    flight: FlightKind = Field("landing", description="descent and tilts are stills.")
    frames: int = Field(60, ge=1, le=10**9)
    from_mm: Height = Field(3000.0, description="Height at the start (tilts: distance).")
    to_mm: Height = Field(100.0, description="Height at the end.")
    fps: float = Field(30.0, ge=0.1, le=1000, description="Of a video.")
    sway: float = Field(1.0, ge=0, le=10, description="Scales how the camera wanders and leans.")
    look: str = Field(
        "clear", max_length=40, description="Conditions; GET /simulate/looks lists them."
    )
    disturbances: Disturbances = Field(default_factory=list)
    ground: GroundKind = "grass"
    quiet_mm: float | None = Field(
        None, ge=0, le=10_000, description="White margin; null takes the pad's own."
    )
    stills: bool | None = Field(
        None,
        description="Stills where a video is usual; null: only where the camera's size is odd, "
        "which no video can be.",
    )
    codec: Codec = "h264"
    seed: int = Field(1, ge=0, le=2**31)
    name: str | None = Field(None, min_length=1, max_length=200)
    analyze: Method | None = Field(
        None, description="Send it straight into an analysis with this method; needs a pad."
    )


class Simulation(BaseModel):
    """A simulated flight and how far it is."""

    model_config = ConfigDict(json_schema_extra={"examples": [_EXAMPLE]}, from_attributes=True)

    id: str
    name: str
    state: Literal["queued", "running", "done", "failed", "cancelled"]
    created_at: datetime
    frames_total: int
    frames_done: int
    video: bool = Field(description="One video rather than a zip of stills.")
    upload: str | None = Field(description="Id of the upload that holds it, once it is done.")
    flight: str | None = Field(description="Id of its analysis, where one was asked for.")
    error: ErrorInfo | None
