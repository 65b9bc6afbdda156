"""Bodies of live sessions."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from padstudio.web.schemas.asked import Asked
from padstudio.web.schemas.base import DETECTION_EXAMPLE, MAX_PADS, ErrorInfo

_RECORD: dict[str, Any] = DETECTION_EXAMPLE["result"]
_SPREAD: dict[str, Any] = {"median": 21.4, "p95": 34.0}
_FIGURES: dict[str, Any] = {
    "frames": 412,
    "read": 405,
    "dropped": 3,
    "recent_frames": 148,
    "recent_read": 148,
    "frames_per_s": 14.8,
    "latency_ms": _SPREAD,
    "pose_ms": _SPREAD,
}
_STREAM: dict[str, Any] = {
    "phase": "open",
    "detail": "",
    "code": "",
    "frames": 415,
    "dropped": 3,
    "damaged": 0,
    "connections": 1,
    "size_px": [1280, 720],
    "codec": "h264",
}
_RECORDING: dict[str, Any] = {
    "id": "0d94b2a1c7e65f38",
    "is_on": True,
    "phase": "recording",
    "detail": "",
    "frames": 371,
    "bytes": 4_180_221,
}
_EXAMPLE: dict[str, Any] = {
    "id": "7c1e90ab34d5f268",
    "source": "rtsp://127.0.0.1:8554/drone",
    "pad": {"id": "3f0c5a9e1b7d2468", "name": "landing pad"},
    "camera": {"id": "9b1f3c5a7e2d4680", "name": "drone, 1080p"},
    "created_at": "2026-05-04T09:30:00Z",
    "state": "running",
    "error": None,
    "stream": _STREAM,
    "sight": "found",
    "sight_detail": "",
    "newest": 412,
    "figures": _FIGURES,
    "recording": None,
    "print_check": [
        {
            "code": "contrast_red",
            "name": "Contrast, red",
            "verdict": "good",
            "text": "red cells are 142 grey values apart, 81% of what perfect inks would give",
            "advice": "",
            "figure": 0.81,
        }
    ],
}
_FRAME: dict[str, Any] = {
    "number": 412,
    "taken_s": 27.866,
    "record": _RECORD,
    "marks": {"lines": [], "outlines": [[[301.2, 88.0], [922.7, 90.1]]], "axes": None},
}
_LINE: dict[str, Any] = {
    "number": 412,
    "taken_s": 27.866,
    "status": "ok",
    "reason": None,
    "height_mm": 1302.7,
}


def _example(value: dict[str, Any]) -> ConfigDict:
    return ConfigDict(json_schema_extra={"examples": [value]}, extra="forbid")


_Name = Annotated[str, Field(min_length=1, max_length=200)]


class NewLive(Asked):
    """A live session to be started."""

    model_config = _example(
        {"source": "browser", "pad": "3f0c5a9e1b7d2468", "camera": "preset-webcam-c270"}
    )

    source: str = Field(
        min_length=1,
        max_length=500,
        description="A stream's address; or `browser`: frames are sent one by one to POST "
        "/live/{session_id}/frames. An address may hold a password, which is told to nobody.",
    )
    pad: _Name | Annotated[list[_Name], Field(min_length=1, max_length=MAX_PADS)] = Field(
        description="Id or name of a stored pad; or several that may be in view."
    )
    camera: _Name = Field(description="Id or name of a stored or preset camera.")

    @property
    def pads(self) -> list[str]:
        """As a list."""
        return [self.pad] if isinstance(self.pad, str) else self.pad


class LiveName(BaseModel):
    """A stored pad or camera."""

    id: str
    name: str


class LiveStream(BaseModel):
    """How a source is."""

    phase: Literal["connecting", "open", "lost", "ended", "refused"] = Field(
        description="`lost` is tried again; `ended` and `refused` are not."
    )
    detail: str = Field(description="Why, and what to do; empty while all is well.")
    code: str = Field(description="Of the error; empty while all is well.")
    frames: int = Field(description="Decoded since the session began.")
    dropped: int = Field(description="Of these, those that nobody took before the next one came.")
    damaged: int = Field(description="Of these, those for which the decoder filled in.")
    connections: int = Field(description="How often it was opened.")
    size_px: tuple[int, int] | None
    codec: str | None


class LiveSpread(BaseModel):
    """Milliseconds: the median and the 95th percentile of the last ten seconds."""

    median: float
    p95: float


class LiveFigures(BaseModel):
    """How a session fares."""

    frames: int = Field(description="Frames that were looked at.")
    read: int = Field(description="Of these, those with a pose.")
    dropped: int = Field(description="Frames that were not looked at, as a newer one had come.")
    recent_frames: int = Field(description="As `frames`, of the last ten seconds.")
    recent_read: int
    frames_per_s: float | None
    latency_ms: LiveSpread | None = Field(
        description="From when the frame was taken, or arrived where the stream does not say, to "
        "its pose."
    )
    pose_ms: LiveSpread | None = Field(description="From the decoded frame to its pose.")


class LiveRecording(BaseModel):
    """A recording of a session."""

    model_config = _example(_RECORDING)

    id: str = Field(description="Of the recording, as POST /flights/from-recording takes it.")
    is_on: bool
    phase: Literal["waiting", "recording", "refused", "stopped", "closed"] = Field(
        description="`waiting` for a stream, or for its next keyframe; `refused`: this stream is "
        "not recorded; `stopped`: nothing is recorded any more."
    )
    detail: str = Field(description="Why, and what to do; empty while all is well.")
    frames: int
    bytes: int


class LivePrintItem(BaseModel):
    """Something that the print check measured."""

    code: str = Field(description="Stable, for programs: `contrast_red`, `sharpness`, …")
    name: str
    verdict: Literal["good", "fair", "bad", "unknown"]
    text: str = Field(description="What was measured, with its figures.")
    advice: str = Field(description="What to do; empty where nothing is to be done.")
    figure: float | None = Field(description="That the verdict rests on.")


class LiveInfo(BaseModel):
    """A live session and how it fares."""

    model_config = _example(_EXAMPLE)

    id: str
    source: str = Field(description="Without a password.")
    pad: LiveName = Field(description="The first one.")
    camera: LiveName
    created_at: datetime
    state: Literal["starting", "running", "failed", "idle"] = Field(
        description="`idle`: ended because nobody watched it."
    )
    error: ErrorInfo | None
    stream: LiveStream | None = None
    sight: Literal["found", "lost", "no_stream"] = "no_stream"
    sight_detail: str = ""
    newest: int | None = Field(None, description="Number of the newest frame.")
    figures: LiveFigures | None = None
    recording: LiveRecording | None = Field(None, description="That is under way, or the last one.")
    print_check: list[LivePrintItem] = Field(
        default_factory=list, description="Of a frame that was read; empty before there is one."
    )


class LiveList(BaseModel):
    """Sessions, the newest first."""

    model_config = _example({"items": [_EXAMPLE], "total": 1})

    items: list[LiveInfo]
    total: int


class LiveFrame(BaseModel):
    """A frame that was read."""

    model_config = _example(_FRAME)

    number: int
    taken_s: float = Field(description="Since the session began.")
    record: dict[str, Any] = Field(description="A line of a poses file.")
    marks: dict[str, Any] = Field(
        description="Where its pose puts the pad, frame pixels: `outlines`, `lines` with `points`, "
        "and `axes` (origin, ends of X, Y, Z); nothing of these without a pose."
    )


class LiveLine(BaseModel):
    """A frame of the last ten seconds."""

    number: int
    taken_s: float
    status: Literal["ok", "failed"]
    reason: str | None
    height_mm: float | None


class LiveFrames(BaseModel):
    """Frames that one can go back to, the oldest first."""

    model_config = _example({"items": [_LINE], "total": 1})

    items: list[LiveLine]
    total: int
