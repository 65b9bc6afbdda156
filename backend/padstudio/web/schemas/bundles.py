"""What requests about bundles and their answers look like."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from padstudio.web.schemas.base import DETECTION_EXAMPLE, DetectionAnswer
from padstudio.web.schemas.tuning import FrameReading

_ViewName = Annotated[str, Field(pattern=r"^[a-z]{1,20}$")]
_ViewText = Annotated[str, Field(max_length=4000)]
_OK = {"status": "ok", "position_mm": [12.4, -80.1, 1302.7], "cells_read": 812}
_OTHERWISE = {"field": "cells_read", "then": 812, "now": 811}
_REPORT: dict[str, Any] = {
    "reading": "run",
    "method": "dense",
    "params": {"search": {"least_step": 0.4}},
    "view": {"view": "red-edges", "at": "812,604,6"},
    "pad": "3f0c5a9e1b7d2468",
    "others": [],
    "camera": "preset-dji-mini-27k",
    "same": False,
    "differences": [_OTHERWISE],
    "recorded_differences": [_OTHERWISE],
    "alone_differences": [],
    "versions": [{"name": "padstudio", "then": "1.0.0", "now": "1.1.0"}],
    "result": _OK,
    "result_now": {**_OK, "cells_read": 811},
    "recorded": _OK,
    "recorded_version": "1.0.0",
    "recorded_now": _OK,
    "alone": _OK,
    "alone_now": _OK,
    "neighbours": [
        {
            "offset": -1,
            "result": _OK,
            "picture": "/api/v1/detect/9b1d4c2a7e60f835/pictures/neighbour-before.png",
        }
    ],
}


class BundleRequest(FrameReading):
    """A frame, how it is read, and how the page shows it."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "flight": "5d2f0a91c3b7e846",
                    "frame": 412,
                    "params": {"search": {"least_step": 0.4}},
                    "view": {"view": "red-edges", "at": "812,604,6"},
                }
            ]
        },
        extra="forbid",
    )

    view: dict[_ViewName, _ViewText] = Field(
        default_factory=dict, max_length=40, description="What of the page's address it shows."
    )

    @model_validator(mode="after")
    def _own_pad(self) -> BundleRequest:
        if self.flight is not None and (self.pad or self.camera or self.others):
            raise ValueError("a flight's frame is bundled with the flight's own pad and camera")
        return self


class Difference(BaseModel):
    """A value that is otherwise."""

    field: str
    then: Any = Field(description="In the bundle.")
    now: Any


class VersionDifference(BaseModel):
    name: str
    then: str | None
    now: str | None


class NeighbourInfo(BaseModel):
    """A frame beside the bundle's."""

    offset: int = Field(description="-1 before, 1 behind.")
    result: dict[str, Any] | None = Field(description="What the run recorded.")
    picture: str | None = Field(description="Its address.")


class BundleReport(BaseModel):
    """What a bundle says, and what is otherwise here."""

    model_config = ConfigDict(json_schema_extra={"examples": [_REPORT]})

    reading: Literal["still", "run"] = Field(
        description="`result` is of the frame by itself, or as a flight's run reads it."
    )
    method: Literal["dense", "paper"] = Field(description="By itself.")
    params: dict[str, Any] = Field(description="By itself.")
    view: dict[str, str]
    pad: str = Field(description="Id of the stored pad.")
    others: list[str] = Field(description="Ids of more pads that may be in view.")
    camera: str = Field(description="Id of the stored camera, or the preset.")
    same: bool = Field(description="Nothing is otherwise.")
    differences: list[Difference] = Field(description="`result` and the stages to now.")
    recorded_differences: list[Difference] = Field(description="`recorded` to now.")
    alone_differences: list[Difference] = Field(description="`alone` to now.")
    versions: list[VersionDifference] = Field(description="Those that differ.")
    result: dict[str, Any]
    result_now: dict[str, Any]
    recorded: dict[str, Any] | None = Field(description="What the flight's run recorded.")
    recorded_version: str = Field(description="Of the program that did; empty where none.")
    recorded_now: dict[str, Any] | None = Field(description="What it would record now.")
    alone: dict[str, Any] | None = Field(description="Of a run's frame: the frame by itself.")
    alone_now: dict[str, Any] | None
    neighbours: list[NeighbourInfo]


class KeptAnswer(DetectionAnswer):
    """A kept answer; of a bundle's frame with what the bundle says."""

    model_config = ConfigDict(
        json_schema_extra={"examples": [{**DETECTION_EXAMPLE, "bundle": _REPORT}]}
    )

    bundle: BundleReport | None = None
