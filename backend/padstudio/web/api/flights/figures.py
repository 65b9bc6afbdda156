"""What the charts of a flight show."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query
from pydantic import BaseModel, ConfigDict, Field

from padstudio.web.server.services import ERRORS, ItemId, Shared

router = APIRouter(prefix="/flights", tags=["flights"], responses=ERRORS)

FrameQuery = Annotated[int | None, Query(ge=0, le=2**31 - 1)]
_COLUMN: dict[str, Any] = {
    "column": 0,
    "first_frame": 0,
    "last_frame": 29,
    "time_s": 0.0,
    "z_min_mm": 980.2,
    "z_max_mm": 1043.2,
    "outcomes": [20, 0, 6, 0, 2, 2],
    "stages": {"decode": 2},
    "failed_at": {"red": {"decode": 2}, "blue": {"lines": 2}},
}
_TIMELINE: dict[str, Any] = {
    "first_frame": 0,
    "last_frame": 5399,
    "frames_per_column": 30,
    "columns": [_COLUMN],
}
_FIGURES: dict[str, Any] = {
    "trajectory": {
        "frame": [0, 1],
        "time_s": [0.0, 0.033],
        "x_mm": [-202.6, None],
        "y_mm": [-192.2, None],
        "z_mm": [1043.2, None],
        "quality": ["full", None],
    },
    "samples": [
        {
            "number": 1,
            "frame": 0,
            "quality": "full",
            "position_mm": [-202.6, -192.2, 1043.2],
            "axis": [0.0, 0.1, -1.0],
        }
    ],
    "heights": None,
}


class TimelineColumn(BaseModel):
    """Frames that stand in one column of the timeline."""

    column: int = Field(description="From 0; columns without frames are left out.")
    first_frame: int
    last_frame: int
    time_s: float | None
    z_min_mm: float | None
    z_max_mm: float | None
    outcomes: list[int] = Field(
        description="Frames read from the layers red, green, blue, from the outline; failed "
        "ones; those of which only range and bearing are to be used."
    )
    stages: dict[str, int] = Field(description="First failing stage: frames.")
    failed_at: dict[str, dict[str, int]] = Field(
        description="By channel, the stage at which it failed: frames. Empty in columns of a "
        "hundred frames or more."
    )


class FlightTimeline(BaseModel):
    model_config = ConfigDict(json_schema_extra={"examples": [_TIMELINE]})

    first_frame: int
    last_frame: int
    frames_per_column: int = Field(description="In frame numbers.")
    columns: list[TimelineColumn]


class PoseSample(BaseModel):
    """A frame that stands for those around it."""

    number: int = Field(description="From 1.")
    frame: int
    quality: Literal["full", "bearing"] | None = None
    position_mm: tuple[float, float, float] | None = None
    axis: tuple[float, float, float] | None = Field(
        None, description="Unit vector along which the camera looks, in the pad frame."
    )


class HeightFit(BaseModel):
    """Pose height as a line over telemetry height."""

    slope: float
    slope_low: float
    slope_high: float
    offset_mm: float
    scatter_mm: float
    samples: int
    range_m: float
    verdict: str = Field(description="agrees, too_high, too_low or uncertain.")


class HeightPairs(BaseModel):
    frame: list[int]
    telemetry_m: list[float]
    pose_mm: list[float]
    fit: HeightFit | None


class FlightFigures(BaseModel):
    model_config = ConfigDict(json_schema_extra={"examples": [_FIGURES]})

    trajectory: dict[str, list[float | str | None]] = Field(
        description="Columns frame, time_s, x_mm, y_mm, z_mm, quality, heading_deg, tilt_deg, "
        "position_sigma_mm, attitude_sigma_deg, cells_read, cells_wrong; null without a pose. Also "
        "total_ms, and of each stage the time, as edges_ms."
    )
    samples: list[PoseSample]
    heights: HeightPairs | None = Field(description="null without telemetry.")


@router.get(
    "/{flight_id}/timeline",
    operation_id="getFlightTimeline",
    summary="Outcomes and heights along a flight, or a part of it",
)
def get_flight_timeline(
    flight_id: ItemId,
    shared: Shared,
    columns: Annotated[int, Query(ge=1, le=5000, description="Most columns.")] = 1000,
    first_frame: FrameQuery = None,
    last_frame: FrameQuery = None,
) -> FlightTimeline:
    flight = shared.flights.flights.get(flight_id)
    found = shared.flights.charts.timeline(flight, columns, first_frame, last_frame)
    return FlightTimeline.model_validate(found)


@router.get(
    "/{flight_id}/figures",
    operation_id="getFlightFigures",
    summary="Trajectory, poses in space, pose height against telemetry",
)
def get_flight_figures(
    flight_id: ItemId,
    shared: Shared,
    points: Annotated[int, Query(ge=2, le=20_000, description="Most points.")] = 2000,
    samples: Annotated[int, Query(ge=1, le=200, description="Most poses in space.")] = 16,
) -> FlightFigures:
    flight = shared.flights.flights.get(flight_id, texts=True)
    found = shared.flights.charts.figures(flight, points, samples)
    return FlightFigures.model_validate(found)
