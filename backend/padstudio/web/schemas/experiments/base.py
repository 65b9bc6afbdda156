"""What answers about experiments of any kind look like; the OpenAPI file's source."""

from __future__ import annotations

from datetime import datetime
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from padstudio.web.schemas.base import ErrorInfo

_FILE: dict[str, Any] = {"name": "report.html", "media_type": "text/html", "size_bytes": 214_008}
_RESULT: dict[str, Any] = {
    "title": "The paper's experiments on the simulator",
    "words": ["Both methods read the same frames."],
    "sections": [
        {
            "title": "Ranges",
            "words": [],
            "claims": [
                {
                    "text": "The coarse layer reads from 18 cm to 154 cm.",
                    "verdict": "held within",
                    "sentence": "Held within 40 to 154 cm.",
                    "because": "It read at 4 of 8 places.",
                }
            ],
            "tables": [],
            "figures": [{"file": "ranges.svg", "caption": "Share read", "words": "Two lines"}],
        }
    ],
}
_EXAMPLE: dict[str, Any] = {
    "id": "4be1907af2c35d68",
    "kind": "reproduction",
    "name": "the paper's experiments",
    "state": "done",
    "created_at": "2026-05-04T09:30:00Z",
    "order": {"kind": "reproduction", "seeds": 20, "only": []},
    "steps_done": 1200,
    "steps_total": 1200,
    "error": None,
}


class ExperimentFile(BaseModel):
    """A file of an experiment's report."""

    model_config = ConfigDict(json_schema_extra={"examples": [_FILE]})

    name: str
    media_type: str
    size_bytes: int


class ExperimentInfo(BaseModel):
    """An experiment and how far it is."""

    model_config = ConfigDict(json_schema_extra={"examples": [_EXAMPLE]}, from_attributes=True)

    id: str
    kind: str
    name: str
    state: Literal["queued", "running", "done", "failed", "cancelled"]
    created_at: datetime
    order: dict[str, Any] = Field(description="As it was given.")
    steps_done: int
    steps_total: int = Field(description="0 before it has begun.")
    error: ErrorInfo | None


class ExperimentDetail(ExperimentInfo):
    """An experiment with what came of it."""

    model_config = ConfigDict(
        json_schema_extra={"examples": [_EXAMPLE | {"files": [_FILE], "result": _RESULT}]}
    )

    files: list[ExperimentFile] = Field(description="Of the report, once it is done.")
    result: dict[str, Any] | None = Field(
        description="The report, once it is done: `title`, `words` and `sections`, each with its "
        "`claims`, `tables` and `figures`, which name their `file`."
    )


class ExperimentList(BaseModel):
    """The experiments, newest first."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"items": [_EXAMPLE]}]})

    items: list[ExperimentInfo]
