"""What the charts of a flight show."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query
from pydantic import BaseModel, ConfigDict, Field

from padstudio.errors import NotFoundError
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
_VEHICLE: dict[str, Any] = {
    "kind": "ulog",
    "clock": {
        "is_flights": False,
        "offset_s": 73.413,
        "sigma_s": 0.006,
        "climb_correlation": 0.99,
        "turn_correlation": 0.98,
        "overlap_s": 21.4,
        "reason": "",
    },
    "mount": {
        "rotation": [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
        "turned_deg": 0.2,
        "lean_forward_deg": 1.3,
        "lean_right_deg": -0.4,
        "sigma_deg": [0.1, 0.1, 0.3],
        "residual_deg": 0.5,
        "undetermined": [],
    },
    "mount_reason": "",
    "fit": None,
    "scale_error": {"value": 0.012, "low": 0.009, "high": 0.015},
    "columns": {"frame": [0], "time_s": [0.0], "pose_m": [2.01], "vehicle_m": [2.0]},
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


class ClockAnswer(BaseModel):
    """What the motion tells of the log's clock."""

    is_flights: bool = Field(description="The log's times are the flight's own.")
    offset_s: float | None = Field(description="Log's time less the flight's; null: not told.")
    sigma_s: float | None
    climb_correlation: float | None
    turn_correlation: float | None
    overlap_s: float
    reason: str = Field(description="Why there is no offset.")


class MountAnswer(BaseModel):
    """How the camera sits on the vehicle."""

    rotation: list[list[float]] = Field(
        description="Takes camera vectors to body vectors: x forward, y right, z down."
    )
    turned_deg: float = Field(description="Up in the picture, from forward to the right.")
    lean_forward_deg: float = Field(description="Of the optical axis from straight down.")
    lean_right_deg: float
    sigma_deg: list[float] = Field(description="About the body's axes; 104 where not determined.")
    residual_deg: float
    undetermined: list[list[float]] = Field(
        description="Axes of the body about which the motion does not determine it."
    )


class ScaleError(BaseModel):
    """Share by which poses are too large, as the heights imply."""

    value: float
    low: float
    high: float


class VehicleComparison(BaseModel):
    """The flight's poses beside the vehicle's log."""

    model_config = ConfigDict(json_schema_extra={"examples": [_VEHICLE]})

    kind: str
    clock: ClockAnswer
    mount: MountAnswer | None
    mount_reason: str = Field(description="Why there is no mount.")
    fit: HeightFit | None
    scale_error: ScaleError | None
    columns: dict[str, list[float | None]] = Field(
        description="frame, time_s, pose_m, vehicle_m, residual_mm, and with a mount tilt_deg, "
        "heading_deg, vehicle_tilt_deg, vehicle_heading_deg, attitude_residual_deg."
    )


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


@router.get(
    "/{flight_id}/vehicle",
    operation_id="getFlightVehicle",
    summary="Poses beside the vehicle's log: clock, mounting, heights, attitudes",
)
def get_flight_vehicle(flight_id: ItemId, shared: Shared) -> VehicleComparison:
    flight = shared.flights.flights.get(flight_id, texts=True)
    if flight.telemetry is None:
        raise NotFoundError(
            "this flight has no telemetry; upload an SRT file or the vehicle's log with the video",
            code="no_telemetry",
        )

    def run(function: Any, *args: Any) -> Any:
        timeout_s = shared.settings.detect_seconds
        return shared.pool.submit(function, *args, timeout_s=timeout_s).result()

    found = shared.flights.vehicle.compare(flight, run)
    return VehicleComparison.model_validate(found)
