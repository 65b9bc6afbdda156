"""What an order of an error budget looks like; the OpenAPI file's source."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import ConfigDict, Field

from padstudio.experiments.budget.conditions import QUANTITIES
from padstudio.experiments.budget.order import FEWEST_FRAMES, MOST_FRAMES, USUAL_FRAMES
from padstudio.web.schemas.asked import Asked, Height

EXAMPLE: dict[str, Any] = {
    "kind": "budget",
    "pad": "3f0c5a9e1b7d2468",
    "camera": "preset-dji-mini-27k",
    "height_mm": 1300,
    "conditions": {"exposure_ms": 2, "readout_ms": 0},
}


class BudgetOrder(Asked):
    """How much of a pose's error comes from what, for a pad, a camera and a height."""

    model_config = ConfigDict(json_schema_extra={"examples": [EXAMPLE]})

    kind: Literal["budget"]
    name: str | None = Field(None, min_length=1, max_length=200)
    pad: str = Field(max_length=200, description="Id or name of a stored pad.")
    camera: str = Field(max_length=200, description="Id or name of a camera.")
    height_mm: Height = Field(description="Of the camera over the pad.")
    conditions: dict[str, float] = Field(
        default_factory=dict,
        max_length=len(QUANTITIES),
        description=f"Sizes that are not the defaults: {', '.join(QUANTITIES)}.",
    )
    codec: Literal["h264", "h265"] = Field("h264", description="Of the stream.")
    frames: int = Field(
        USUAL_FRAMES,
        ge=FEWEST_FRAMES,
        le=MOST_FRAMES,
        description="In each case; best a multiple of 8.",
    )
    seed: int = Field(1, ge=0, le=2**31)
    fits_bends: bool = Field(
        False, description="Ask of each frame whether the paper is bent, as in stills."
    )
    is_checked: bool = Field(
        False, description="Simulate all sources once more after the best change."
    )
