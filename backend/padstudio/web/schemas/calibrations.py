"""What requests and answers of calibrations look like; the OpenAPI file's source."""

from __future__ import annotations

from datetime import datetime
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from padstudio.calibration.advice import PictureState
from padstudio.calibration.calibrate import MOST_PICTURES
from padstudio.geometry.camera import MAX_READOUT_MS
from padstudio.web.schemas.asked import Asked
from padstudio.web.schemas.base import ErrorInfo

_PARAMETER: dict[str, Any] = {"name": "fx", "value": 1402.51, "sigma": 0.21}
_PICTURE: dict[str, Any] = {
    "name": "IMG_0412.jpg",
    "used": True,
    "state": "good",
    "message": "",
    "patches": 412,
    "rms_px": 0.061,
    "range_mm": 1431.2,
    "tilt_deg": 24.7,
}
_RESULT: dict[str, Any] = {
    "width": 1920,
    "height": 1080,
    "model": "radtan",
    "intrinsics": [_PARAMETER],
    "distortion": [{"name": "k1", "value": -0.2714, "sigma": 0.0008}],
    "rms_px": 0.059,
    "sigma_px": [[0.11, 0.07], [0.06, 0.09]],
    "coverage": [[12, 44], [51, 17]],
    "pictures": [_PICTURE],
    "findings": [],
}
_EXAMPLE: dict[str, Any] = {
    "id": "4be1907af2c35d68",
    "name": "drone, 1080p",
    "pad": "3f0c5a9e1b7d2468",
    "state": "done",
    "created_at": "2026-05-04T09:30:00Z",
    "steps_done": 41,
    "steps_total": 41,
    "result": _RESULT,
    "error": None,
}


class NewCalibration(Asked):
    """Pictures of a pad from which a camera is to be calibrated."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [{"pad": "3f0c5a9e1b7d2468", "uploads": ["9b1f3c5a7e2d4680"]}]
        }
    )

    pad: str = Field(max_length=200, description="Id or name of the stored pad that was printed.")
    uploads: list[str] = Field(
        min_length=1,
        max_length=MOST_PICTURES,
        description="Ids of uploads: stills, zips of stills, or a clip.",
    )
    lens: Literal["auto", "radtan", "fisheye"] = Field(
        "auto", description="Lens model; auto takes the one that explains the pictures best."
    )
    name: str | None = Field(None, min_length=1, max_length=200, description="Of the camera.")


class CalibratedParameter(BaseModel):
    """A parameter with one standard deviation."""

    model_config = ConfigDict(json_schema_extra={"examples": [_PARAMETER]})

    name: str
    value: float
    sigma: float


class CalibrationPicture(BaseModel):
    """What one picture adds."""

    model_config = ConfigDict(json_schema_extra={"examples": [_PICTURE]})

    name: str
    used: bool
    state: PictureState
    message: str = Field(description="Why to take it again; empty for a good one.")
    patches: int = Field(description="Points that were measured in it.")
    rms_px: float = Field(description="Root mean square of their residuals.")
    range_mm: float | None
    tilt_deg: float | None


class CalibrationFinding(BaseModel):
    """Something a calibration lacks."""

    code: str
    message: str


class CalibrationResult(BaseModel):
    """A camera, how sure it is, and what each picture added."""

    model_config = ConfigDict(json_schema_extra={"examples": [_RESULT]})

    width: int
    height: int
    model: Literal["radtan", "fisheye"]
    intrinsics: list[CalibratedParameter] = Field(description="fx, fy, cx, cy, pixels.")
    distortion: list[CalibratedParameter]
    rms_px: float = Field(description="Of the residuals of all pictures that count.")
    sigma_px: list[list[float | None]] = Field(
        description="One standard deviation of where directions are seen, in each part of the "
        "picture, row by row; null where the lens shows none."
    )
    coverage: list[list[int]] = Field(description="Points measured in each of these parts.")
    pictures: list[CalibrationPicture]
    findings: list[CalibrationFinding]


class CalibrationInfo(BaseModel):
    """A calibration and how far it is."""

    model_config = ConfigDict(json_schema_extra={"examples": [_EXAMPLE]}, from_attributes=True)

    id: str
    name: str
    pad: str
    state: Literal["queued", "running", "done", "failed", "cancelled"]
    created_at: datetime
    steps_done: int
    steps_total: int = Field(description="0 while pictures are read.")
    result: CalibrationResult | None
    error: ErrorInfo | None


class CalibratedCamera(Asked):
    """How a calibrated camera is to be stored."""

    model_config = ConfigDict(
        json_schema_extra={"examples": [{"name": "drone, 1080p", "readout_ms": 18.5}]}
    )

    name: str | None = Field(None, min_length=1, max_length=200)
    readout_ms: float | None = Field(
        None, ge=0, le=MAX_READOUT_MS, description="First row to last row; 0 is a global shutter."
    )
