"""What one run of a flight does otherwise than another."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Path, Query
from pydantic import BaseModel, ConfigDict, Field

from padstudio.flights.results.compared_rows import ChangeFilter
from padstudio.web.schemas.asked import InAddress
from padstudio.web.schemas.flights import FRAME_EXAMPLE, FrameResult
from padstudio.web.server.services import ERRORS, ItemId, Shared

router = APIRouter(prefix="/flights", tags=["flights"], responses=ERRORS)

OtherId = Annotated[
    str, Path(pattern=r"^[0-9a-f]{1,32}$", description="The run that it is compared with.")
]
_COLUMN: dict[str, Any] = {
    "first_frame": 0,
    "last_frame": 9,
    "neither": 1,
    "both": 6,
    "won": 3,
    "lost": 0,
    "moved_max_mm": 1.4,
}
_COMPARISON: dict[str, Any] = {
    "frames": 210,
    "only_first": 0,
    "only_second": 0,
    "neither": 4,
    "both": 190,
    "won": 13,
    "lost": 3,
    "moved": {
        "median_mm": 0.02,
        "p95_mm": 0.9,
        "worst_mm": 14.1,
        "worst_share": 0.011,
        "worst_frame": 55,
    },
    "columns": [_COLUMN],
}
_CHANGE: dict[str, Any] = {
    "frame": 55,
    "kind": "both",
    "moved_mm": 14.1,
    "moved_share": 0.011,
    "turned_deg": 0.4,
    "own": FRAME_EXAMPLE,
    "other": FRAME_EXAMPLE,
}
Kind = Literal["neither", "both", "won", "lost"]


class Moved(BaseModel):
    """How far the positions of frames that both read lie apart."""

    median_mm: float
    p95_mm: float
    worst_mm: float
    worst_share: float | None = Field(description="Of the distance from the pad's centre.")
    worst_frame: int


class ChangeColumn(BaseModel):
    """Frames that stand in one column of a strip."""

    first_frame: int
    last_frame: int
    neither: int
    both: int
    won: int
    lost: int
    moved_max_mm: float | None


class Comparison(BaseModel):
    """Frames that this run won and lost against another, of those that both read."""

    model_config = ConfigDict(json_schema_extra={"examples": [_COMPARISON]})

    frames: int
    only_first: int = Field(description="Frames that the other run alone reads.")
    only_second: int = Field(description="Frames that this run alone reads.")
    neither: int
    both: int
    won: int = Field(description="With a pose in this run alone.")
    lost: int = Field(description="With a pose in the other run alone.")
    moved: Moved | None = Field(description="null where no frame has a pose in both.")
    columns: list[ChangeColumn]


class Change(BaseModel):
    """A frame of both runs."""

    model_config = ConfigDict(json_schema_extra={"examples": [_CHANGE]})

    frame: int
    kind: Kind
    moved_mm: float | None
    moved_share: float | None
    turned_deg: float | None
    own: FrameResult
    other: FrameResult


class ChangePage(BaseModel):
    """Frames in the order of their numbers."""

    model_config = ConfigDict(
        json_schema_extra={"examples": [{"items": [_CHANGE], "next_after": None}]}
    )

    items: list[Change]
    next_after: int | None = Field(description="`after` of the next page; null: there is none.")


class ChangeQuery(InAddress):
    """Which frames, and how many of them."""

    kind: Literal["changed", "won", "lost", "moved", "both", "neither"] | None = Field(
        None, description="`changed`: won, lost or moved; null: all."
    )
    least_mm: float = Field(
        1.0, ge=0, le=1e9, description="So far apart are poses that have moved, mm."
    )
    after: int | None = Field(None, ge=-1, le=2**31 - 1)
    before: int | None = Field(
        None,
        ge=0,
        le=2**31,
        description="Without `after`: the last frames below this number.",
    )
    limit: int = Field(100, ge=1, le=1000)


@router.get(
    "/{flight_id}/comparison/{other_id}",
    operation_id="compareFlights",
    summary="Frames won and lost against another run",
)
def compare_flights(
    flight_id: ItemId,
    other_id: OtherId,
    shared: Shared,
    columns: Annotated[int, Query(ge=1, le=5000, description="Most columns.")] = 200,
) -> Comparison:
    own, other = (shared.flights.flights.get(each) for each in (flight_id, other_id))
    return Comparison.model_validate(shared.flights.comparisons.summary(own, other, columns))


@router.get(
    "/{flight_id}/comparison/{other_id}/frames",
    operation_id="listChanges",
    summary="Frames of both runs, page by page",
)
def list_changes(
    flight_id: ItemId,
    other_id: OtherId,
    shared: Shared,
    query: Annotated[ChangeQuery, Query()],
) -> ChangePage:
    own, other = (shared.flights.flights.get(each) for each in (flight_id, other_id))
    wanted = ChangeFilter(kind=query.kind, least_mm=query.least_mm)
    found = shared.flights.comparisons.page(
        own, other, wanted, query.limit, query.after, query.before
    )
    full = len(found) == query.limit and (query.before is None or query.after is not None)
    return ChangePage(
        items=[Change.model_validate(each) for each in found],
        next_after=found[-1]["frame"] if full else None,
    )
