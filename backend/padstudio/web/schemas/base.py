"""What requests and answers look like; also the OpenAPI file's source."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from padstudio.geometry.camera import MAX_READOUT_MS
from padstudio.pad.coding.pad_spec import PAPER_COST
from padstudio.pad.spec import (
    MAX_CELL_MM,
    MAX_CELLS,
    MAX_LEVELS,
    MAX_WINDOW,
    MIN_CELL_MM,
    LayerFields,
)
from padstudio.web.schemas.asked import Asked
from padstudio.web.schemas.pads import PadCrosstalk

#: Of one search.
MAX_PADS = 16

#: Of a simulation, NAME=VALUE each.
Disturbances = Annotated[
    list[Annotated[str, Field(max_length=80)]],
    Field(max_length=20, description="NAME=VALUE each; GET /simulate/looks lists them."),
]

SPEC_EXAMPLE: dict[str, Any] = {
    "name": "helipad",
    "window": 5,
    "levels": 2,
    "rows": 125,
    "cols": 125,
    "ratio": 5,
    "cell_mm": 10.0,
    "quiet_mm": 20.0,
    "unique": "rotation",
    "distance": 3,
    "layers": "independent",
    "method": "auto",
    "seed": 1,
}
PAD_EXAMPLE: dict[str, Any] = {
    "id": "3f0c5a9e1b7d2468",
    "name": "helipad",
    "window": 5,
    "levels": 2,
    "size_mm": [1250.0, 1250.0],
    "layers": [
        {"channel": "red", "rows": 125, "cols": 125, "cell_mm": 10.0},
        {"channel": "blue", "rows": 25, "cols": 25, "cell_mm": 50.0},
    ],
    "seed": 1,
    "method": "auto",
    "unique": "rotation",
    "distance": 3,
    "layer_fields": "independent",
    "scale": [1.0, 1.0],
    "created_at": "2026-05-04T09:30:00Z",
}
PAD_FILE_EXAMPLE: dict[str, Any] = {
    "format": "padstudio.pad",
    "version": 1,
    "name": "tiny",
    "window": 2,
    "levels": 2,
    "quiet_mm": 0.0,
    "layers": [{"channel": "red", "cell_mm": 10.0, "codes": ["001", "011", "110"]}],
}
CAMERA_EXAMPLE: dict[str, Any] = {
    "id": "preset-dji-mini-27k",
    "name": "DJI Mini 2, 2.7K video",
    "width": 2720,
    "height": 1530,
    "focal_px": 1886.0,
    "model": "radtan",
    "distortion": [],
    "nominal": True,
    "readout_ms": None,
    "note": "nominal, calibrate for accuracy",
}
_VERIFICATION_EXAMPLE: dict[str, Any] = {
    "windows": 4,
    "unique": True,
    "min_distance": 1,
    "others": [],
    "layers": None,
    "apart": [],
}
_VERIFICATION = (
    "What was proved of the finest layer, and in short of the `others`; of the `layers` together "
    "(`independent`, `near` or `shared`; null for one), and how far each two are `apart`."
)
_TRACE = "/api/v1/detect/9b1d4c2a7e60f835"
DETECTION_EXAMPLE: dict[str, Any] = {
    "result": {
        "source": "frame.jpg",
        "frame": 0,
        "time_s": None,
        "status": "ok",
        "position_mm": [12.4, -80.1, 1302.7],
        "rotation": [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]],
        "quaternion_xyzw": [1.0, 0.0, 0.0, 0.0],
        "heading_deg": 0.0,
        "tilt_deg": 0.0,
        "layer": "red",
        "cells_read": 5120,
        "cells_wrong": 14,
        "log10_false_alarm": -300.0,
        "reprojection_px": 0.21,
        "flatness_mm": None,
        "position_sigma_mm": [0.3, 0.3, 0.2],
        "attitude_sigma_deg": [0.01, 0.01, 0.002],
        "range_mm": 1305.2,
        "range_sigma_mm": 0.2,
        "bearing": [-0.0095, -0.0614, 0.9981],
        "bearing_sigma_deg": 0.002,
        "quality": "full",
        "pad_id": "K7Q2M4XA",
        "elapsed_ms": {"stretch": 2.1, "lines": 6.4, "total": 18.9},
    },
    "pads": [{"id": "3f0c5a9e1b7d2468", "name": "helipad", "pad_id": "K7Q2M4XA"}],
    "image": {"width": 2720, "height": 1530},
    "camera_scale": 1.0,
    "trace": {
        "id": "9b1d4c2a7e60f835",
        "result_picture": f"{_TRACE}/pictures/result.png",
        "stages": [
            {
                "name": "edges",
                "channel": "red",
                "elapsed_ms": 3.2,
                "failure": None,
                "picture": f"{_TRACE}/pictures/red-edges.png",
                "thumbnail": f"{_TRACE}/pictures/red-edges.png?width=480",
            }
        ],
    },
}


DETECTION_EXAMPLE["results"] = [DETECTION_EXAMPLE["result"]]


def _example(value: dict[str, Any]) -> ConfigDict:
    return ConfigDict(json_schema_extra={"examples": [value]})


class ErrorInfo(BaseModel):
    """Why a request was refused."""

    code: str = Field(description="Stable, for programs.")
    message: str = Field(description="What is wrong and what to do, for people.")
    detail: dict[str, Any] = Field(description="Figures and places, for programs.")


class ErrorBody(BaseModel):
    """The one shape of every error."""

    model_config = _example(
        {"error": {"code": "not_found", "message": "there is no pad of that id", "detail": {}}}
    )

    error: ErrorInfo


class Health(BaseModel):
    model_config = _example({"status": "ok", "version": "0.1.0"})

    status: Literal["ok"] = "ok"
    version: str


class PadSpec(Asked):
    """A pad to be generated."""

    model_config = ConfigDict(json_schema_extra={"examples": [SPEC_EXAMPLE]})

    name: str = Field("pad", min_length=1, max_length=200)
    window: int = Field(5, ge=2, le=MAX_WINDOW, description="b: each b × b window occurs once.")
    levels: int = Field(2, ge=2, le=MAX_LEVELS, description="Y: levels of a cell.")
    rows: int = Field(125, ge=2, le=MAX_CELLS, description="Rows of the red layer.")
    cols: int = Field(125, ge=2, le=MAX_CELLS, description="Columns of the red layer.")
    ratio: int = Field(
        5, ge=1, le=MAX_CELLS, description="Red cells along a blue cell; 1: the red layer only."
    )
    cell_mm: float = Field(10.0, ge=MIN_CELL_MM, le=MAX_CELL_MM, description="Side of a red cell.")
    quiet_mm: float = Field(0.0, ge=0, le=10_000, description="White margin.")
    unique: Literal["rotation", "plain"] = "rotation"
    distance: int = Field(
        3, ge=1, le=MAX_WINDOW**2, description="Least number of cells two windows differ in."
    )
    visible_lines: bool = Field(
        False, description="Each window has a level change across each of its inner lines."
    )
    layers: LayerFields = Field(
        "independent",
        description="independent: no window of a layer is in the other, in any turn, at the "
        f"distance. paper: the blue layer is a copy of the red one's corner; {PAPER_COST}.",
    )
    method: Literal["auto", "growth"] = "auto"
    seed: int | None = Field(1, ge=0, le=2**62, description="null: the server draws one.")


class NewName(Asked):
    """Another name for something stored."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"name": "roof pad"}]})

    name: str = Field(min_length=1, max_length=200, pattern=r"\S", description="Not only blanks.")


class LayerSummary(BaseModel):
    channel: Literal["red", "green", "blue"]
    rows: int
    cols: int
    cell_mm: float


class PadSummary(BaseModel):
    """A stored pad, without its codes."""

    model_config = _example(PAD_EXAMPLE)

    id: str
    name: str
    window: int
    levels: int
    size_mm: tuple[float, float]
    layers: list[LayerSummary]
    seed: int | None
    method: str | None
    unique: Literal["rotation", "plain"] | None
    distance: int | None
    layer_fields: LayerFields | None = Field(
        None, description="As its layers' fields were made; null where unknown, or for one layer."
    )
    scale: tuple[float, float] = Field(
        (1.0, 1.0), description="Measured size of the print over its nominal size, x and y."
    )
    crosstalk: PadCrosstalk | None = Field(
        None, description="From a photo of the test strip; frames are un-mixed by it."
    )
    created_at: datetime


class PadDetail(PadSummary):
    """A stored pad with its pad file."""

    model_config = _example({**PAD_EXAMPLE, "pad": PAD_FILE_EXAMPLE})

    pad: dict[str, Any]


class PadList(BaseModel):
    model_config = _example({"items": [PAD_EXAMPLE], "total": 1})

    items: list[PadSummary]
    total: int


class PadPreview(BaseModel):
    """A generated pad that was not stored."""

    model_config = _example(
        {
            "pad": PAD_FILE_EXAMPLE,
            "verification": _VERIFICATION_EXAMPLE,
        }
    )

    pad: dict[str, Any] = Field(description="A pad file's object.")
    verification: dict[str, Any] = Field(description=_VERIFICATION)


class PadVerification(BaseModel):
    """What holds for a stored pad."""

    model_config = _example({"verification": _VERIFICATION_EXAMPLE})

    verification: dict[str, Any] = Field(description=_VERIFICATION)


class CameraSummary(BaseModel):
    """A preset or stored camera."""

    model_config = _example(CAMERA_EXAMPLE)

    id: str
    name: str
    width: int
    height: int
    focal_px: float
    model: Literal["radtan", "fisheye"]
    distortion: list[float]
    nominal: bool = Field(description="From a data sheet rather than a calibration.")
    readout_ms: float | None = Field(
        None, description="First row to last row; 0 is a global shutter, null is unknown."
    )
    note: str = Field(description="What its user must know of it, or empty.")
    created_at: datetime | None = Field(None, description="null for presets.")


class CameraReadout(Asked):
    """How long a camera's shutter rolls."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"readout_ms": 18.5}]})

    readout_ms: float | None = Field(
        ge=0, le=MAX_READOUT_MS, description="First row to last row; 0 is a global shutter."
    )


class CameraList(BaseModel):
    model_config = _example({"items": [CAMERA_EXAMPLE], "total": 1})

    items: list[CameraSummary]
    total: int


class ImageSize(BaseModel):
    width: int
    height: int


class StageFailureInfo(BaseModel):
    stage: str
    reason: str = Field(description="One of a fixed list.")
    detail: str
    advice: str


class StageInfo(BaseModel):
    """One stage of a trace."""

    name: str
    channel: Literal["red", "green", "blue"] | None
    elapsed_ms: float
    failure: StageFailureInfo | None
    picture: str | None = Field(description="Address of the stage's picture.")
    thumbnail: str | None


class TraceInfo(BaseModel):
    id: str
    result_picture: str | None = Field(description="null where none were painted.")
    stages: list[StageInfo]


class KnownPad(BaseModel):
    """A pad that was looked for."""

    id: str = Field(description="Of the stored pad.")
    name: str
    pad_id: str = Field(description="What poses name it by: its print's identity.")


class DetectionAnswer(BaseModel):
    """What the detector says of one picture."""

    model_config = _example(DETECTION_EXAMPLE)

    result: dict[str, Any] = Field(
        description="A line of a poses file; with quality `bearing` only its range and bearing "
        "are to be used. Of several pads that were found, the best."
    )
    results: list[dict[str, Any]] = Field(
        default_factory=list,
        description="The same of each pad that was found, the best first; or the failure.",
    )
    pads: list[KnownPad] = Field(default_factory=list, description="Those that were looked for.")
    image: ImageSize
    camera_scale: float = Field(
        description="By which the calibration was scaled to the picture's size."
    )
    trace: TraceInfo | None
