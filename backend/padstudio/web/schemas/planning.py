"""What requests and answers of planning and simulation look like; the OpenAPI file's source."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from padstudio.pad.coverage.spans import Method, Source
from padstudio.pad.spec import MAX_LEVELS, MAX_WINDOW
from padstudio.simulate.radiance.scene import GroundKind
from padstudio.simulate.trajectories import MAX_HEIGHT_MM
from padstudio.web.schemas.asked import NOT_STRICT, Asked, Height, InAddress, Point, Tilt, Triple
from padstudio.web.schemas.base import Disturbances
from padstudio.web.schemas.printing import PadShape

_Condition = Annotated[float, Field(ge=0, le=1000)]
_CAMERA = "preset-dji-mini-27k"
_CHART_EXAMPLE: dict[str, Any] = {
    "camera": _CAMERA,
    "view": {"width_px": 2720, "height_px": 1530, "focal_px": 1813.3},
    "methods": [
        {
            "method": "dense",
            "cell_px": 4.3,
            "sign_cell_px": 1.08,
            "spans": [
                {"layer": "red", "tilt_deg": 0.0, "low_mm": 50.5, "high_mm": 4386.0},
                {"layer": "blue", "tilt_deg": 0.0, "low_mm": 252.7, "high_mm": 21930.2},
                {"layer": "outline", "tilt_deg": 0.0, "low_mm": 2013.2, "high_mm": 21930.2},
            ],
            "dead_bands": [],
        }
    ],
}
_POSE_EXAMPLE: dict[str, Any] = {
    "position_mm": [0.0, 0.0, 800.0],
    "rotation": [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]],
}


def _example(value: dict[str, Any]) -> ConfigDict:
    return ConfigDict(json_schema_extra={"examples": [value]})


class CoverageRequest(Asked):
    """A pad's sizes, and the camera that is to read it."""

    model_config = _example(
        {
            "pad": {"layers": [{"channel": "red", "rows": 60, "cols": 60, "cell_mm": 10.0}]},
            "camera": _CAMERA,
            "tilts_deg": [0.0, 30.0],
        }
    )

    pad: PadShape
    camera: str = Field(max_length=200, description="Id or name of a camera.")
    tilts_deg: list[Tilt] = Field([0.0], min_length=1, max_length=200)


class SpanInfo(BaseModel):
    """Heights at which a layer, or the sign as a whole, reads at one tilt."""

    layer: Source = Field(description="outline is the whole sign, as in the poses.")
    tilt_deg: float
    low_mm: float | None = Field(description="null where it reads nowhere.")
    high_mm: float | None


class DeadBandInfo(BaseModel):
    """Heights between those that read, at which nothing does."""

    tilt_deg: float
    low_mm: float
    high_mm: float
    message: str


class MethodCoverage(BaseModel):
    """What one method reads."""

    method: Method
    cell_px: float = Field(description="Pixels that it needs along a cell of a layer.")
    sign_cell_px: float | None = Field(
        description="Pixels along a coarsest cell that suffice with the whole sign in view."
    )
    spans: list[SpanInfo]
    dead_bands: list[DeadBandInfo]


class ViewInfo(BaseModel):
    """The camera as a pinhole, by which the chart was made."""

    width_px: int
    height_px: int
    focal_px: float = Field(description="Pixels of an object as large as its distance.")


class CoverageChart(BaseModel):
    """Heights and tilts at which a pad reads, from geometry."""

    model_config = ConfigDict(json_schema_extra={"examples": [_CHART_EXAMPLE]})

    camera: str
    view: ViewInfo
    methods: list[MethodCoverage]


class MapRequest(Asked):
    """Conditions to simulate frames under; each height with each value, `trials` times."""

    model_config = _example(
        {"camera": _CAMERA, "heights_mm": [200, 800], "values": [0, 30], "trials": 2}
    )

    camera: str = Field(max_length=200, description="Id or name of a camera.")
    method: Method = "dense"
    axis: Literal["tilt_deg", "blur_px"] = "tilt_deg"
    heights_mm: list[Height] = Field(min_length=1, max_length=100)
    values: list[_Condition] = Field(
        [0.0], min_length=1, max_length=100, description="Tilts, or blurs in pixels of path."
    )
    trials: int = Field(1, ge=1, le=100)
    seed: int = Field(1, ge=0, le=2**31)


class SuccessMapInfo(BaseModel):
    """Share of simulated frames that were read, a row a height, a column a value."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "axis": "tilt_deg",
                    "heights_mm": [200.0, 800.0],
                    "values": [0.0, 30.0],
                    "success": [[1.0, 0.5], [1.0, 1.0]],
                    "wrong": [[0.0, 0.0], [0.0, 0.0]],
                    "trials": 2,
                }
            ]
        }
    )

    axis: Literal["tilt_deg", "blur_px"]
    heights_mm: list[float]
    values: list[float]
    success: list[list[float]]
    wrong: list[list[float]] = Field(description="Share with a false pose: worse than none.")
    trials: int


class AdviceQuery(InAddress):
    """A range of heights, the camera, and what pad is wanted."""

    camera: str = Field(max_length=200, examples=["preset-dji-mini-27k"])
    low_mm: Height = Field(examples=[500.0])
    high_mm: Height = Field(examples=[8000.0])
    method: Method = "dense"
    window: int = Field(5, ge=2, le=MAX_WINDOW)
    levels: int = Field(2, ge=2, le=MAX_LEVELS)
    tilt_deg: Tilt = Field(20.0, description="Largest lean.")
    reach_mm: float = Field(
        200.0, ge=0, le=1_000_000, description="Off the centre at the lowest height."
    )


class AdviceInfo(BaseModel):
    """A pad for a range of heights."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "window": 5,
                    "levels": 2,
                    "cell_mm": 15.0,
                    "ratio": 4,
                    "cells": 40,
                    "size_mm": 600.0,
                    "low_mm": 92.5,
                    "high_mm": 21000.0,
                    "notes": [],
                }
            ]
        }
    )

    window: int
    levels: int
    cell_mm: float = Field(description="Side of a fine cell.")
    ratio: int = Field(description="Fine cells along a coarse one; 1 is a single layer.")
    cells: int = Field(description="Fine cells along a side of the pad.")
    size_mm: float
    low_mm: float = Field(description="Heights that this pad reads.")
    high_mm: float
    notes: list[str] = Field(description="What does not hold, and why.")


class PoseSpec(Asked):
    """A pose in the pad frame."""

    model_config = _example(_POSE_EXAMPLE)

    position_mm: Triple
    rotation: Annotated[tuple[Triple, Triple, Triple], NOT_STRICT] = Field(
        description="Takes camera to pad vectors."
    )


class FrameSpec(Asked):
    """One frame to be simulated: a pad, a camera, where it is, and under what conditions."""

    model_config = _example(
        {"pad": None, "camera": _CAMERA, "height_mm": 800.0, "tilt_deg": 10.0, "look": "shadow"}
    )

    pad: str | None = Field(
        None, max_length=200, description="Id or name of a stored pad; null leaves the ground bare."
    )
    camera: str = Field(max_length=200, description="Id or name of a camera.")
    height_mm: float = Field(1000.0, ge=-MAX_HEIGHT_MM, le=MAX_HEIGHT_MM)
    tilt_deg: Tilt = Field(0.0, description="Axis off straight down.")
    tilt_towards_deg: float = Field(0.0, ge=-360, le=360, description="Clockwise from +Y.")
    heading_deg: float = Field(0.0, ge=-360, le=360, description="Image up, clockwise from +Y.")
    target_mm: Point = Field((0.0, 0.0), description="Where the axis meets the pad's plane.")
    pose: PoseSpec | None = Field(None, description="Instead of the five above.")
    velocity_mm_s: Triple = Field((0.0, 0.0, 0.0), description="Pad frame.")
    angular_deg_s: Triple = Field((0.0, 0.0, 0.0), description="About the camera's axes.")
    look: str = Field(
        "clear", max_length=40, description="Conditions; GET /simulate/looks lists them."
    )
    disturbances: Disturbances = Field(default_factory=list)
    ground: GroundKind = "grass"
    quiet_mm: float | None = Field(
        None, ge=0, le=10_000, description="White margin; null takes the pad's own."
    )
    seed: int = Field(1, ge=0, le=2**31)


class Picture(BaseModel):
    media_type: Literal["image/jpeg", "image/png"]
    base64: str = Field(description="The file's bytes.")


class FrameTruth(BaseModel):
    """Where the camera was; a pose at the middle row's mid-exposure."""

    position_mm: list[float]
    rotation: list[list[float]]
    quaternion_xyzw: list[float]
    heading_deg: float
    tilt_deg: float


class SimulatedFrame(BaseModel):
    """A picture and its truth."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "picture": {"media_type": "image/jpeg", "base64": "/9j/4AAQSkZJRg=="},
                    "width": 2720,
                    "height": 1530,
                    "truth": {
                        **_POSE_EXAMPLE,
                        "quaternion_xyzw": [1.0, 0.0, 0.0, 0.0],
                        "heading_deg": 0.0,
                        "tilt_deg": 0.0,
                    },
                }
            ]
        }
    )

    picture: Picture
    width: int
    height: int
    truth: FrameTruth


class LookInfo(BaseModel):
    name: str
    note: str


class DisturbanceInfo(BaseModel):
    name: str
    form: str = Field(description="What stands after the equals sign.")
    note: str


class LookList(BaseModel):
    """Conditions that a frame can be simulated under."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "items": [{"name": "clear", "note": "even daylight"}],
                    "grounds": ["grass"],
                    "disturbances": [
                        {"name": "fog", "form": "METRES", "note": "visibility, of 5 % contrast"}
                    ],
                }
            ]
        }
    )

    items: list[LookInfo]
    grounds: list[GroundKind]
    disturbances: list[DisturbanceInfo]
