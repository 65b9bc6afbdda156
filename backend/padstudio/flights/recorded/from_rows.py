"""Tasks of recordings' flights from rows of the database."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from padstudio.errors import SpecError
from padstudio.flights.recorded.tasks import RecordedFramesTask, RecordedPlanTask
from padstudio.flights.tasks import from_rows
from padstudio.flights.tasks.from_rows import WorkLimits
from padstudio.media.content import LIVE_POSES
from padstudio.store.database.flight_tables import ChunkRow, FlightRow
from padstudio.store.uploads.rows import Upload


def is_recorded(request: Mapping[str, Any]) -> bool:
    """Whether a flight's poses are those of a live session."""
    return bool(request.get("live"))


def plan_task(
    flight: FlightRow,
    uploads: Sequence[tuple[Upload, Path]],
    place: Callable[[Path], str],
    limits: WorkLimits,
) -> RecordedPlanTask:
    """The task that plans a recording's flight.

    Parameters
    ----------
    flight : FlightRow
        With its camera.
    uploads : sequence of (Upload, Path)
        Each video's is followed by that of its poses, where there are any.
    place : callable
        As of `padstudio.flights.tasks.from_rows.plan_task`.
    limits : WorkLimits
    """
    videos: list[tuple[str, str, str, Path]] = []
    poses: list[str | None] = []
    for upload, path in uploads:
        if upload.kind == "video":
            videos.append((upload.id, upload.kind, upload.name, path))
            poses.append(None)
        elif upload.media_type == LIVE_POSES.media_type and videos:
            poses[-1] = place(path)
    plan = from_rows.plan_task(flight, videos, place, limits)
    return RecordedPlanTask(plan, tuple(poses), *_told(flight))


def frames_task(flight: FlightRow, chunk: ChunkRow) -> RecordedFramesTask:
    """The task of a chunk, which is loaded with its timestamps."""
    source = flight.sources[chunk.source]
    part = from_rows.video_part(source, chunk.pts)
    numbers = from_rows.numbers_of(flight, chunk)
    return RecordedFramesTask(numbers, part, source["poses"], *_told(flight))


def check_recorded(uploads: Sequence[Upload]) -> None:
    """Refuse uploads that are no recording; raises `SpecError`."""
    kinds = [upload.kind for upload in uploads]
    if set(kinds) - {"video", "live"} or "video" not in kinds:
        raise SpecError("a recording is made of videos and their poses", code="mixed_uploads")


def _told(flight: FlightRow) -> tuple[tuple[str, ...], bool]:
    pads = tuple(pad["pad_id"] for pad in flight.request["pads"])
    return pads, bool(flight.request["live"]["is_whole"])
