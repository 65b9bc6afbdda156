"""What answers about uploads look like."""

from __future__ import annotations

from datetime import datetime
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

UPLOAD_EXAMPLE: dict[str, Any] = {
    "id": "9b1f3c5a7e2d4680",
    "name": "landing.mp4",
    "size_bytes": 1_116_415,
    "offset": 1_116_415,
    "complete": True,
    "created_at": "2026-05-04T09:30:00Z",
    "expires_at": None,
    "sha256": "5d41402abc4b2a76b9719d911017c592ae4f1c6b7d1f3a5e8c9b0a1d2e3f4a5b",
    "kind": "video",
    "media_type": "video/mp4",
}


class UploadSummary(BaseModel):
    """An upload."""

    model_config = ConfigDict(
        from_attributes=True, json_schema_extra={"examples": [UPLOAD_EXAMPLE]}
    )

    id: str
    name: str = Field(
        description="As the sender called it, else by its content: `video-5d41402a.mp4`; empty "
        "until that is known."
    )
    size_bytes: int
    offset: int = Field(description="Bytes that are there.")
    complete: bool = Field(description="All bytes are there, and the content has been examined.")
    created_at: datetime
    expires_at: datetime | None = Field(
        description="When it is given up unless bytes come; null once it is complete."
    )
    sha256: str | None
    kind: Literal["video", "recording", "still", "stills", "telemetry", "live"] | None = Field(
        description="By content; stills is a zip; live is what lies beside the videos of a live "
        "session's recording, or a zip of all of it. Null until it is complete."
    )
    media_type: str | None


class UploadList(BaseModel):
    model_config = ConfigDict(
        json_schema_extra={"examples": [{"items": [UPLOAD_EXAMPLE], "total": 1}]}
    )

    items: list[UploadSummary]
    total: int
