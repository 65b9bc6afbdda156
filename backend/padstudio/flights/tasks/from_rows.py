"""Tasks from rows of the database."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from padstudio.errors import NotFoundError
from padstudio.flights.tasks.detectors import Recipe
from padstudio.flights.tasks.frames import FramesTask, StillPart, VideoPart
from padstudio.flights.tasks.planning import PlanTask, SourceFile
from padstudio.flights.tasks.proxies import ProxyTarget
from padstudio.media.recordings.times import TopicTimes

if TYPE_CHECKING:
    from padstudio.store.database.flight_tables import ChunkRow, FlightRow


@dataclass(frozen=True, kw_only=True)
class WorkLimits:
    """Limits of tasks.

    Attributes
    ----------
    max_pixels : int
        Of a frame.
    max_frames : int
        Of a video.
    chunk_frames : int
        Frames that a chunk should hold.
    """

    max_pixels: int = 50_000_000
    max_frames: int = 2_000_000
    chunk_frames: int = 120


def plan_task(
    flight: FlightRow,
    uploads: Sequence[tuple[str, str, str, Path]],
    place: Callable[[Path], str],
    limits: WorkLimits,
    only: bytes | None = None,
) -> PlanTask:
    """The task that plans a flight.

    Parameters
    ----------
    flight : FlightRow
        With its camera.
    uploads : sequence of (id, kind, name, path)
    place : callable
        Brings a file where workers reach it and gives its URL.
    limits : WorkLimits
    only : bytes or None
        As of `PlanTask`.
    """
    request = flight.request
    return PlanTask(
        files=tuple(
            SourceFile(upload, kind, name, place(path)) for upload, kind, name, path in uploads
        ),
        camera=flight.camera,
        first_frame=request["first_frame"],
        end_frame=request["end_frame"],
        stride=request["stride"],
        chunk_frames=limits.chunk_frames,
        apply_rotation=request["apply_rotation"],
        max_pixels=limits.max_pixels,
        max_frames=limits.max_frames,
        only=only,
        topic=request.get("topic"),
    )


def frames_task(
    flight: FlightRow, chunk: ChunkRow, limits: WorkLimits, proxies: ProxyTarget | None = None
) -> FramesTask:
    """The task of a chunk; flight with pad and camera, chunk with its timestamps."""
    numbers, part = numbers_of(flight, chunk), part_of(flight, chunk)
    return FramesTask(recipe_of(flight), numbers, part, limits.max_pixels, proxies)


def numbers_of(flight: FlightRow, chunk: ChunkRow) -> Sequence[int]:
    """The numbers of a chunk's frames; the chunk is loaded with them."""
    if chunk.numbers:
        return tuple(np.frombuffer(chunk.numbers, "<i8").tolist())
    stride = flight.request["stride"]
    return range(chunk.first_frame, chunk.first_frame + chunk.frames * stride, stride)


def part_of(flight: FlightRow, chunk: ChunkRow) -> VideoPart | tuple[StillPart, ...]:
    """The frames of a chunk, which is loaded with its timestamps."""
    if chunk.pts:
        return video_part(flight.sources[chunk.source], chunk.pts)
    return tuple(still_part(flight.sources, number) for number in numbers_of(flight, chunk))


def recipe_of(flight: FlightRow) -> Recipe:
    """How a flight's frames are detected; flight with pads and camera."""
    request = flight.request
    params = json.dumps(request["params"], sort_keys=True)
    others = tuple(flight.other_pads or ())
    return Recipe(flight.pad, flight.camera, request["method"], params, others)


def video_part(source: Mapping[str, Any], pts: bytes) -> VideoPart:
    """Frames of a flight's source that is a video or a recording."""
    return VideoPart(
        url=source["url"],
        name=source["name"],
        pts=pts,
        start_pts=source["start_pts"],
        time_base_s=source["time_base_s"],
        start_s=source["start_s"],
        rotation_deg=source["rotation_deg"],
        is_counted=source["is_counted"],
        recording=TopicTimes(**source["recording"]) if "recording" in source else None,
    )


def still_part(sources: Sequence[Mapping[str, Any]], number: int) -> StillPart:
    """A frame of a flight of stills.

    Raises
    ------
    NotFoundError
        If there is no frame of that number.
    """
    for source in sources:
        place = number - source["first_frame"]
        if 0 <= place < source["frames"]:
            if source["kind"] == "still":
                return StillPart(source["url"], source["name"])
            member = source["members"][place]
            return StillPart(source["url"], f"{source['name']}/{member}", member)
    raise NotFoundError(f"the flight has no frame {number}")
