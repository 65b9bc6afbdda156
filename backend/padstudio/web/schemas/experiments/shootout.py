"""What an order of a shoot-out looks like; the OpenAPI file's source."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import ConfigDict, Field

from padstudio.experiments.shootout.boards.catalogue import BOARDS
from padstudio.experiments.shootout.order import MAX_FRAMES
from padstudio.simulate.radiance.scene import GroundKind
from padstudio.web.schemas.asked import Asked, Height
from padstudio.web.schemas.base import Disturbances

EXAMPLE: dict[str, Any] = {
    "kind": "shootout",
    "pad": "3f0c5a9e1b7d2468",
    "camera": "preset-dji-mini-27k",
    "flight": "descent",
    "frames": 24,
    "boards": ["aruco-board", "apriltag-nested"],
}


class ShootoutOrder(Asked):
    """A pad against other boards of its printed size, on the same simulated flight."""

    model_config = ConfigDict(json_schema_extra={"examples": [EXAMPLE]})

    kind: Literal["shootout"]
    name: str | None = Field(None, min_length=1, max_length=200)
    pad: str = Field(max_length=200, description="Id or name of a stored pad.")
    camera: str = Field(max_length=200, description="Id or name of a camera.")
    flight: Literal["descent", "edge", "tilts", "hover", "landing", "gusty"] = Field(
        "descent", description="descent, edge and tilts are stills; edge looks at the board's edge."
    )
    frames: int = Field(24, ge=1, le=MAX_FRAMES, description="Of each board.")
    from_mm: Height = Field(16_000.0, description="Height at the start (tilts: distance).")
    to_mm: Height = Field(60.0, description="Height at the end.")
    sway: float = Field(1.0, ge=0, le=10, description="Scales how the camera wanders and leans.")
    look: str = Field(
        "clear", max_length=40, description="Conditions; GET /simulate/looks lists them."
    )
    disturbances: Disturbances = Field(default_factory=list)
    ground: GroundKind = "grass"
    boards: list[str] | None = Field(
        None,
        max_length=len(BOARDS),
        description=f"Some of {', '.join(BOARDS)}; null takes all but puzzleboard-fine.",
    )
    seed: int = Field(1, ge=0, le=2**31)
