"""What requests of the workbench and their answers look like."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from padstudio.web.schemas.asked import NOT_STRICT, Asked, Place, Point, Triple
from padstudio.web.schemas.base import DETECTION_EXAMPLE, ImageSize, StageFailureInfo

_Id = Annotated[str, Field(max_length=64, pattern=r"^[A-Za-z0-9-]{1,64}$")]
_Name = Annotated[str, Field(min_length=1, max_length=200)]
Part = Annotated[
    tuple[Place, Place, Place, Place],
    Field(
        strict=False,
        description="Left, top, right and bottom in the frame, pixels from its corner.",
    ),
]
_PARAMETER = {
    "name": "search.least_step",
    "group": "search",
    "kind": "float",
    "default": 0.6,
    "low": 0.1,
    "high": 50.0,
    "not_below": None,
    "not_above": None,
    "unit": "grey/px",
    "text": "An edge point's brightness changes by more than this, after the stretch.",
    "stages": ["edges"],
    "methods": ["dense"],
    "followed": False,
}
_READING = {
    "trace": "9b1d4c2a7e60f835",
    "pad": "3f0c5a9e1b7d2468",
    "camera": "preset-dji-mini-27k",
    "method": "dense",
    "params": {"search": {"least_step": 0.4}},
}


def _example(value: dict[str, Any], extra: Literal["ignore", "forbid"] = "ignore") -> ConfigDict:
    return ConfigDict(json_schema_extra={"examples": [value]}, extra=extra)


class ParameterInfo(BaseModel):
    """One parameter of the detector."""

    model_config = _example(_PARAMETER)

    name: str = Field(description="Group and name, as `params` and `--param` take it.")
    group: str
    kind: Literal["int", "float", "bool"]
    default: int | float | bool
    low: float
    high: float
    not_below: str | None = Field(description="Parameter of its group that bounds it, too.")
    not_above: str | None
    unit: str
    text: str
    stages: list[str] = Field(description="Those that look at it, its own first.")
    methods: list[Literal["dense", "paper"]]
    followed: bool = Field(description="It counts only where a video's pose is followed.")


class ParameterList(BaseModel):
    model_config = _example({"items": [_PARAMETER]})

    items: list[ParameterInfo]


class FrameReading(Asked):
    """A frame and how it is read."""

    model_config = _example(_READING, extra="forbid")

    trace: _Id | None = Field(None, description="A kept detection's picture;")
    flight: _Id | None = Field(None, description="or a flight's")
    frame: int | None = Field(None, ge=0, le=2**31 - 1, description="frame.")
    pad: _Name | None = Field(None, description="Id of a stored pad; a flight has its own.")
    others: list[_Name] = Field(
        default_factory=list, max_length=20, description="Ids of more pads that may be in view."
    )
    camera: _Name | None = Field(None, description="Id of a camera or preset; likewise.")
    method: Literal["dense", "paper"] = "dense"
    params: dict[str, Any] = Field(
        default_factory=dict, description="By group and name; what is left out has its default."
    )

    @model_validator(mode="after")
    def _one_frame(self) -> FrameReading:
        if (self.trace is None) == (self.flight is None) or (self.flight is None) != (
            self.frame is None
        ):
            raise ValueError("name either a trace, or a flight and a frame of it")
        if self.trace is not None and (self.pad is None or self.camera is None):
            raise ValueError("a kept picture is read with a pad and a camera; name both")
        return self


class ViewWish(Asked):
    """A stage's picture as it is to be shown."""

    model_config = _example({"stage": "edges", "channel": "red", "scale": 0.25}, extra="forbid")

    stage: str = Field(pattern=r"^[a-z_]{1,30}$", description="A stage, or `frame`.")
    channel: Literal["red", "green", "blue"] | None = None
    scale: float = Field(ge=1e-3, le=64, description="Shown pixels per frame pixel.")
    part: Part | None = Field(None, description="null: all of it.")
    quick: bool = Field(False, description="Sooner rather than exactly.")
    marks: bool = Field(True, description="With the lines, cells and axes that belong on it.")


class LookRequest(FrameReading):
    """Read a frame and show stages of it."""

    model_config = _example(
        {**_READING, "views": [{"stage": "edges", "channel": "red", "scale": 0.25}]},
        extra="forbid",
    )

    views: list[ViewWish] = Field(default_factory=list, max_length=32)


class StageLook(BaseModel):
    """A stage, and where in the frame its picture lies."""

    name: str
    channel: Literal["red", "green", "blue"] | None
    elapsed_ms: float = Field(description="What it took when it was last computed.")
    failure: StageFailureInfo | None
    part: Part | None = Field(description="null: it has no picture.")
    pixel: float | None = Field(description="Side of its pixels in frame pixels.")


class ViewPicture(BaseModel):
    """A picture that was asked for."""

    stage: str
    channel: Literal["red", "green", "blue"] | None
    part: Part | None = Field(description="What it shows; null where there is nothing.")
    exact: bool = Field(False, description="The stage's own values, neither means nor rounded.")
    media_type: str | None
    base64: str | None
    marks: dict[str, Any] | None = Field(
        description="`lines` (points, family, kind found, inserted or dropped, number, text), "
        "`cells` and measured `points` (x, y, flag), `outlines`, `axes`; frame pixels."
    )


class Look(BaseModel):
    """What the detector makes of a frame, and pictures of its stages."""

    model_config = _example(
        {
            "result": DETECTION_EXAMPLE["result"],
            "image": {"width": 2720, "height": 1530},
            "camera_scale": 1.0,
            "stages": [
                {
                    "name": "edges",
                    "channel": "red",
                    "elapsed_ms": 2.1,
                    "failure": None,
                    "part": [512.0, 128.0, 2048.0, 1408.0],
                    "pixel": 2.0,
                }
            ],
            "pictures": [],
        }
    )

    result: dict[str, Any] = Field(description="A line of a poses file.")
    image: ImageSize
    camera_scale: float
    stages: list[StageLook]
    pictures: list[ViewPicture]


class PoseGiven(Asked):
    """A pose from anywhere."""

    model_config = ConfigDict(extra="ignore")

    position_mm: Triple
    quaternion_xyzw: Annotated[tuple[Place, Place, Place, Place], NOT_STRICT]

    @model_validator(mode="after")
    def _is_rotation(self) -> PoseGiven:
        if not 0.5 < sum(value**2 for value in self.quaternion_xyzw) < 2:
            raise ValueError("quaternion_xyzw must be of length 1")
        return self


class CellsRequest(FrameReading):
    """Compare every cell with the pad."""

    model_config = _example(
        {**_READING, "corners": [[410, 220], [1630, 240], [1610, 1420], [400, 1400]]},
        extra="forbid",
    )

    pose: PoseGiven | None = Field(None, description="null: the frame's own, or by `corners`.")
    corners: list[Point] | None = Field(
        None,
        min_length=4,
        max_length=4,
        description="The pad's corners one after the other, frame pixels; which is which the "
        "cells tell.",
    )


class CellFit(BaseModel):
    """How many cells agree where the pad lay otherwise."""

    quarter_turns: int
    mirrored: bool
    share: float


class LayerCells(BaseModel):
    """A layer's cells in view, one entry of each column a cell."""

    channel: Literal["red", "green", "blue"]
    cell_px: float
    read: int
    wrong: int
    log10_false_alarm: float
    row: list[int]
    column: list[int]
    x: list[float] = Field(description="Where the cell was read, frame pixels.")
    y: list[float]
    expected: list[int]
    level: list[int]
    grey: list[float]
    thresholds: list[list[float]] = Field(description="Grey values between levels.")
    fits: list[CellFit] = Field(description="As the pose has the pad, turned, and mirrored.")


class CellsAnswer(BaseModel):
    """What each cell should be, and what is read."""

    model_config = _example(
        {
            "pose": {"position_mm": [12.4, -80.1, 1302.7]},
            "levels": 2,
            "layers": [
                {
                    "channel": "blue",
                    "cell_px": 48.1,
                    "read": 1,
                    "wrong": 0,
                    "log10_false_alarm": 0.0,
                    "row": [3],
                    "column": [4],
                    "x": [812.0],
                    "y": [604.5],
                    "expected": [1],
                    "level": [1],
                    "grey": [181.2],
                    "thresholds": [[120.4]],
                    "fits": [{"quarter_turns": 0, "mirrored": False, "share": 1.0}],
                }
            ],
        }
    )

    pose: dict[str, Any]
    levels: int
    layers: list[LayerCells]


_PRESET: dict[str, Any] = {
    "name": "faint print",
    "method": "dense",
    "params": {"search": {"least_step": 0.4}},
    "created_at": "2026-05-04T09:30:00Z",
}


class PresetSettings(Asked):
    """Settings of the detector."""

    model_config = _example(
        {"method": "dense", "params": {"search": {"least_step": 0.4}}}, extra="forbid"
    )

    method: Literal["dense", "paper"] = "dense"
    params: dict[str, Any] = Field(description="By group and name, as `GET /parameters` has them.")


class PresetInfo(PresetSettings):
    """Settings under a name."""

    model_config = ConfigDict(json_schema_extra={"examples": [_PRESET]}, from_attributes=True)

    name: str
    created_at: datetime


class PresetList(BaseModel):
    model_config = _example({"items": [_PRESET]})

    items: list[PresetInfo]


_SWEEP: dict[str, Any] = {
    "id": "77b0d1c2a9e4f835",
    "flight": "5d2f0a91c3b7e846",
    "parameter": "search.least_step",
    "values": [0.3, 0.6, 1.2],
    "state": "done",
    "frames_total": 2,
    "frames_done": 2,
    "error": None,
    "won": [1, 0, 0],
    "lost": [0, 0, 1],
    "frames": [
        {"frame": 17, "was_ok": False, "ok": [True, False, False]},
        {"frame": 80, "was_ok": True, "ok": [True, True, False]},
    ],
}


class SweepSpec(Asked):
    """Which parameter, over which values, on how many frames."""

    model_config = _example(
        {"parameter": "search.least_step", "values": [0.3, 0.6, 1.2], "failed": 20, "read": 10},
        extra="forbid",
    )

    parameter: str = Field(max_length=60, description="As `GET /parameters` names it.")
    values: list[int | float | bool] = Field(min_length=1, max_length=12)
    failed: int = Field(20, ge=0, le=60, description="Failing frames at the most, evenly taken.")
    read: int = Field(
        10, ge=0, le=60, description="Frames with a pose, likewise: some may be lost."
    )
    method: Literal["dense", "paper"] | None = Field(None, description="null: the flight's.")
    params: dict[str, Any] | None = Field(None, description="The others; null: the flight's.")


class SweptFrameInfo(BaseModel):
    model_config = ConfigDict(from_attributes=True)

    frame: int
    was_ok: bool
    ok: list[bool] = Field(description="Under each value; empty until it was read.")


class SweepInfo(BaseModel):
    """A sweep and how far it is."""

    model_config = ConfigDict(json_schema_extra={"examples": [_SWEEP]}, from_attributes=True)

    id: str
    flight: str
    parameter: str
    values: list[int | float | bool]
    state: Literal["queued", "running", "done", "failed", "cancelled"]
    frames_total: int
    frames_done: int
    error: str | None
    won: list[int] = Field(description="Under each value: frames that have a pose and had none.")
    lost: list[int] = Field(description="Under each value: frames that had a pose and have none.")
    frames: list[SweptFrameInfo]
