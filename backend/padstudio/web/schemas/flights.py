"""What requests for flights and their answers look like."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from padstudio.web.schemas.asked import Asked, InAddress
from padstudio.web.schemas.base import DETECTION_EXAMPLE, MAX_PADS, ErrorInfo, StageInfo

_ID = "5d2f0a91c3b7e846"
ORDER_EXAMPLE: dict[str, Any] = {
    "uploads": ["8c1e3b5f7a902d46"],
    "pad": "3f0c5a9e1b7d2468",
    "camera": "preset-dji-mini-27k",
    "method": "dense",
    "params": {"refine": {"most_borders": 1500}},
    "first_frame": 0,
    "end_frame": None,
    "stride": 1,
    "name": "morning landing",
}
FLIGHT_EXAMPLE: dict[str, Any] = {
    "id": _ID,
    "name": "morning landing",
    "state": "running",
    "created_at": "2026-05-04T09:30:00Z",
    "started_at": "2026-05-04T09:30:01Z",
    "finished_at": None,
    "frames_total": 5400,
    "frames_done": 1200,
    "frames_ok": 1187,
    "progress": 0.2222,
    "error": None,
    "rerun_of": None,
    "request": {
        "pad_id": "3f0c5a9e1b7d2468",
        "pad_name": "helipad",
        "pads": [{"id": "3f0c5a9e1b7d2468", "name": "helipad", "pad_id": "K7Q2M4XA"}],
        "camera_id": "preset-dji-mini-27k",
        "camera_name": "DJI Mini 2, 2.7K video",
        "method": "dense",
        "params": {},
        "first_frame": 0,
        "end_frame": None,
        "stride": 1,
        "apply_rotation": True,
        "fuse": True,
        "smooth": False,
    },
}
SOURCE_EXAMPLE: dict[str, Any] = {
    "upload": "8c1e3b5f7a902d46",
    "kind": "video",
    "name": "DJI_0042.MP4",
    "first_frame": 0,
    "frames": 5400,
    "start_s": 0.0,
    "video": {
        "container": "mov,mp4,m4a,3gp,3g2,mj2",
        "codec": "h264",
        "pixel_format": "yuv420p",
        "width": 2720,
        "height": 1530,
        "rotation_deg": 0,
        "frames": 5400,
        "frames_declared": 5400,
        "duration_s": 180.18,
        "fps": 29.97,
        "variable_rate": False,
        "damage": [],
    },
}
FRAME_EXAMPLE: dict[str, Any] = {
    **DETECTION_EXAMPLE["result"],
    "source": "DJI_0042.MP4",
    "frame": 412,
    "time_s": 13.747,
}
SUMMARY_EXAMPLE: dict[str, Any] = {
    "frames": 60,
    "ok": 58,
    "share_ok": 0.9667,
    "qualities": {"full": 55, "bearing": 3, "unknown": 0},
    "longest_gap": {"first_frame": 3, "last_frame": 4, "frames": 2, "seconds": 0.1},
    "stages": {"decode": 2},
    "reasons": {"unknown_code": 2},
    "layers": {"red": 50, "blue": 8},
    "damaged": 0,
}
TELEMETRY_EXAMPLE: dict[str, Any] = {
    "kind": "srt",
    "time_s": [0.0, 0.033],
    "frame": [1, 2],
    "height_m": [1.3, 1.2],
    "altitude_m": [65.2, 65.1],
    "latitude_deg": [47.1, 47.1],
    "longitude_deg": [8.5, 8.5],
    "clock": ["2026-05-04 09:12:01.120", "2026-05-04 09:12:01.153"],
    "unread": 0,
}
_BASE = f"/api/v1/flights/{_ID}/frames/412/pictures/"
STAGES_EXAMPLE: dict[str, Any] = {
    "frame": 412,
    "result": FRAME_EXAMPLE,
    "image": {"width": 2720, "height": 1530},
    "picture": f"{_BASE}frame.webp",
    "result_picture": f"{_BASE}result.webp",
    "stages": [
        {
            "name": "edges",
            "channel": "red",
            "elapsed_ms": 3.2,
            "failure": None,
            "picture": f"{_BASE}edges.webp?channel=red",
            "thumbnail": f"{_BASE}edges.webp?channel=red&width=480",
        }
    ],
}


def _example(
    value: dict[str, Any], extra: Literal["ignore", "allow", "forbid"] = "ignore"
) -> ConfigDict:
    return ConfigDict(json_schema_extra={"examples": [value]}, extra=extra)


_PadId = Annotated[str, Field(max_length=200)]
PadIds = _PadId | Annotated[list[_PadId], Field(min_length=1, max_length=MAX_PADS)]
_PADS = (
    "Id or name of a stored pad, or several: one of those that are in view is followed until it is "
    "lost, and `pad_id` of a frame says which."
)


class FlightSettings(Asked):
    """How frames are read; what is left out keeps its default, or the first run's value."""

    model_config = _example({"method": "paper", "stride": 2}, extra="forbid")

    name: str | None = Field(None, min_length=1, max_length=200)
    pad: PadIds | None = Field(None, description=_PADS)
    camera: str | None = Field(None, max_length=200, description="Id or name of a camera.")
    method: Literal["dense", "paper"] | None = None
    params: dict[str, Any] | None = Field(
        None, description="Detector parameters by group and name, as docs/flights.md lists them."
    )
    first_frame: int | None = Field(None, ge=0, le=2**31 - 1)
    end_frame: int | None = Field(
        None, ge=1, le=2**31 - 1, description="First frame that is not read; null: the end."
    )
    stride: int | None = Field(None, ge=1, le=100_000, description="Read every n-th frame.")
    apply_rotation: bool | None = Field(
        None, description="Turn videos as their rotation flag says; so by default."
    )
    fuse: bool | None = Field(
        None, description="Fuse the poses of videos over time; so by default."
    )
    smooth: bool | None = Field(
        None, description="Fuse them with later frames, too; not so by default."
    )
    callback: str | None = Field(
        None,
        max_length=2000,
        description="Address that is called once when the flight has ended, on a host that the "
        "server's settings list.",
    )
    topic: str | None = Field(
        None,
        max_length=300,
        description="Of recordings: the topic with the pictures; needed where several have.",
    )


class OnlyFrames(Asked):
    """Frames of another run that failed."""

    status: Literal["failed"]
    reason: str | None = Field(
        None, max_length=40, description="Those that failed for it; null: all."
    )


class RerunSettings(FlightSettings):
    """What another run of the same uploads does otherwise."""

    model_config = _example(
        {"params": {"search": {"least_step": 0.4}}, "only": {"status": "failed"}}, extra="forbid"
    )

    only: OnlyFrames | None = Field(
        None,
        description="Read no other frames of the first run, which has ended. Left out, it keeps "
        "the first run's choice; null reads all.",
    )


class NewFlight(FlightSettings):
    """An analysis of uploads."""

    model_config = _example(ORDER_EXAMPLE, extra="forbid")

    uploads: list[str] = Field(
        min_length=1,
        max_length=10_000,
        description="Ids of complete uploads in the order of their frames: videos, one of them "
        "with a telemetry file beside it, recordings, or stills and zips of stills.",
    )
    pad: PadIds = Field(description=_PADS)
    camera: str | None = Field(
        None,
        max_length=200,
        description="Id or name of a camera; recordings may bring their calibration along.",
    )


class RecordedFlight(Asked):
    """What was recorded live: uploads of its files, or a recording of this server's own."""

    model_config = _example(
        {"uploads": ["8c1e3b5f7a902d46"], "name": "gusty landing"}, extra="forbid"
    )

    uploads: list[str] | None = Field(
        None,
        min_length=1,
        max_length=10_000,
        description="Ids of complete uploads: a zip of the recording's folder, or the files in it "
        "(session.json, videos, poses), each under its own name.",
    )
    recording: str | None = Field(
        None,
        pattern=r"^[A-Za-z0-9-]{1,50}$",
        description="Instead of uploads: id of what this server's Live page recorded.",
    )
    name: str | None = Field(None, min_length=1, max_length=200)

    @model_validator(mode="after")
    def _one_of_them(self) -> Self:
        if (self.uploads is None) == (self.recording is None):
            raise ValueError("give uploads, or a recording, and not both")
        return self


class Flight(BaseModel):
    """A flight and how far it is."""

    model_config = _example(FLIGHT_EXAMPLE)

    id: str
    name: str
    state: Literal["queued", "running", "done", "failed", "cancelled"]
    created_at: datetime
    started_at: datetime | None
    finished_at: datetime | None
    frames_total: int | None = Field(description="null until the uploads were looked into.")
    frames_done: int
    frames_ok: int
    progress: float = Field(description="From 0 to 1.")
    error: ErrorInfo | None
    notice: str | None = Field(None, description="Why the work does not go on at present.")
    rerun_of: str | None = Field(description="The flight that this one runs again.")
    request: dict[str, Any]


class CallbackInfo(BaseModel):
    """Who is called when a flight has ended, and how that went."""

    model_config = ConfigDict(from_attributes=True)

    url: str
    delivery: str = Field(description="Its id, `webhook-id` of every attempt.")
    state: Literal["open", "delivered", "given_up"]
    attempts: int
    next_at: datetime | None = Field(description="When it is tried again.")
    delivered_at: datetime | None
    error: str | None = Field(description="Why the last attempt failed.")


class FlightDetail(Flight):
    """A flight with what its uploads hold."""

    model_config = _example(
        {**FLIGHT_EXAMPLE, "sources": [SOURCE_EXAMPLE], "telemetry": False, "callback": None}
    )

    sources: list[dict[str, Any]]
    telemetry: bool = Field(description="There is telemetry, beside or inside the video.")
    callback: CallbackInfo | None = None


class FlightList(BaseModel):
    model_config = _example({"items": [FLIGHT_EXAMPLE], "total": 1})

    items: list[Flight]
    total: int


class FrameResult(BaseModel):
    """A line of a poses file; ``covariance`` is the upper triangle by rows."""

    model_config = _example(FRAME_EXAMPLE, extra="allow")

    source: str
    frame: int
    time_s: float | None
    status: Literal["ok", "failed"]
    pad_id: str | None = Field(None, description="Which pad a pose is of; one of the flight's.")
    quality: Literal["full", "bearing"] | None = Field(
        None,
        description="Of a pose: `full`, or `bearing` where only its range and bearing are to be "
        "used; null where unknown.",
    )
    range_mm: float | None = Field(None, description="From the camera to the pad's centre.")
    range_sigma_mm: float | None = Field(None, description="One standard deviation.")
    bearing: tuple[float, float, float] | None = Field(
        None, description="Unit vector to the pad's centre in the camera frame."
    )
    bearing_sigma_deg: float | None = Field(None, description="One standard deviation.")


class FrameQuery(InAddress):
    """Which frames of a flight, and how many of them."""

    status: Literal["ok", "failed"] | None = None
    reason: str | None = Field(None, max_length=40)
    stage: str | None = Field(None, max_length=20)
    layer: str | None = Field(None, max_length=10)
    quality: Literal["full", "bearing"] | None = None
    from_s: float | None = Field(None, ge=-1e9, le=1e9)
    to_s: float | None = Field(None, ge=-1e9, le=1e9)
    min_height: float | None = Field(None, ge=-1e9, le=1e9, description="Over the pad, mm.")
    max_height: float | None = Field(None, ge=-1e9, le=1e9)
    after: int | None = Field(None, ge=-1, le=2**31 - 1)
    before: int | None = Field(
        None,
        ge=0,
        le=2**31,
        description="Without `after`: the last frames below this number.",
    )
    limit: int = Field(100, ge=1, le=1000)


class FramePage(BaseModel):
    """Frames in the order of their numbers."""

    model_config = _example({"items": [FRAME_EXAMPLE], "next_after": 412})

    items: list[FrameResult]
    next_after: int | None = Field(description="`after` of the next page; null: there is none.")


class FlightSummary(BaseModel):
    """Figures over all frames that have a result."""

    model_config = _example(SUMMARY_EXAMPLE)

    frames: int
    ok: int
    share_ok: float | None
    qualities: dict[str, int] = Field(
        description="Poses that are `full`, those of which only the `bearing` and range are to be "
        "used, and those of `unknown` quality."
    )
    longest_gap: dict[str, Any] | None
    stages: dict[str, int] = Field(description="First failing stage: frames.")
    reasons: dict[str, int]
    layers: dict[str, int]
    damaged: int = Field(
        description="Frames for which the decoder had to fill in for missing data."
    )


class TelemetryColumns(BaseModel):
    """What the camera or the vehicle wrote of the flight, in columns of equal length."""

    model_config = _example(TELEMETRY_EXAMPLE)

    kind: Literal["srt", "csv", "ulog", "dataflash", "tlog"] = Field(
        "srt", description="Of srt and csv the times are the flight's, else the log's own."
    )
    time_s: list[float]
    frame: list[int | None]
    height_m: list[float | None]
    altitude_m: list[float | None]
    latitude_deg: list[float | None]
    longitude_deg: list[float | None]
    clock: list[str | None]
    unread: int = Field(description="Subtitles of no known form.")
    qw: list[float | None] = Field([], description="Body (x forward, y right, z down) to local.")
    qx: list[float | None] = []
    qy: list[float | None] = []
    qz: list[float | None] = []
    north_m: list[float | None] = Field([], description="Of the vehicle, from its local origin.")
    east_m: list[float | None] = []
    down_m: list[float | None] = []


class FrameReadiness(BaseModel):
    """How far a frame's decoding is."""

    model_config = _example({"ready": False, "done": 40, "total": 129})

    ready: bool
    done: int = Field(description="Frames decoded, of those up to the frame.")
    total: int


class FrameStages(BaseModel):
    """A frame's stages, with the addresses of their pictures."""

    model_config = _example(STAGES_EXAMPLE)

    frame: int
    result: FrameResult
    image: dict[str, int] = Field(description="The frame's `width` and `height`, pixels.")
    picture: str = Field(description="The frame itself.")
    result_picture: str = Field(description="The frame with what was found in it.")
    stages: list[StageInfo]
