"""What exports need beside the records, and what they have in common."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np

from padstudio.autopilot.vehicle import DOWNWARD, Mount, VehicleTrack
from padstudio.errors import EmptyExportError, SpecError
from padstudio.flights.exports.frames.cameras import FrameCameras
from padstudio.flights.exports.frames.records import timed
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose

Record = dict[str, Any]
T = TypeVar("T")

# Sent at a time: what a socket takes at once.
_BLOCK_BYTES = 64 * 1024


@dataclass(frozen=True, kw_only=True)
class ExportChoices:
    """What somebody wants who exports a flight.

    Attributes
    ----------
    form : str
        As of `padstudio.flights.exports.forms.FORMS`.
    pad_id : str or None
        Of poses of several pads, those of this one.
    images : bool
        The frames, too, where the form has room for them.
    start_unix_s : float
        Unix time of the time 0 of the records, s.
    mount : Mount
        How the camera sits on the vehicle.
    vehicle : VehicleTrack or None
        Where the vehicle was.
    log : mapping or None
        The vehicle's log instead, as of `padstudio.media.telemetry.reading.read`.
    """

    form: str
    pad_id: str | None = None
    images: bool = False
    start_unix_s: float = 0.0
    mount: Mount = DOWNWARD
    vehicle: VehicleTrack | None = None
    log: Mapping[str, Any] | None = None


@dataclass(frozen=True, kw_only=True)
class ExportOptions:
    """What an export may need beside the records.

    Attributes
    ----------
    camera : Camera or None
        In the size that it was calibrated for.
    frame_px : callable or None
        The size of a record's frame where it does not say it, as of `FrameCameras`.
    names : mapping
        What sources are called that are not called as records do.
    pad_size_mm : (width, height) or None
        Of the pad without its quiet margin.
    picture : callable or None
        From a record to its frame as a JPEG, PNG or WebP file, or None where there is none.
    start_unix_s : float
        Unix time of the time 0 of the records, s.
    mount : Mount
        How the camera sits on the vehicle.
    vehicle : VehicleTrack or None
        Where the vehicle was.
    """

    camera: Camera | None = None
    frame_px: Callable[[Record], tuple[int, int] | None] | None = None
    names: Mapping[str, str] = field(default_factory=dict)
    pad_size_mm: tuple[float, float] | None = None
    picture: Callable[[Record], bytes | None] | None = None
    start_unix_s: float = 0.0
    mount: Mount = DOWNWARD
    vehicle: VehicleTrack | None = None

    def need_cameras(self, form: str) -> FrameCameras:
        """The camera in the size of each frame; raises `SpecError` where none is given."""
        if self.camera is None:
            raise SpecError(
                f"{form} holds the camera's calibration: give the camera", code="camera_required"
            )
        return FrameCameras(self.camera, self.frame_px)

    def name_of(self, record: Record) -> str:
        """What a record's source is called."""
        source: str = record["source"]
        return self.names.get(source, source)


def pose_of(record: Record) -> Pose | None:
    """A record's pose; None where the frame failed."""
    if record["status"] != "ok":
        return None
    return Pose(np.array(record["position_mm"], float), np.array(record["rotation"], float))


def full_pose_of(record: Record) -> Pose | None:
    """A record's pose where all of it can be used: of quality ``full``."""
    return pose_of(record) if record.get("quality") == "full" else None


def at_least_one(items: Iterable[T], nothing: Callable[[], str]) -> Iterator[T]:
    """The items; a form that would hold none of what it is for is refused.

    Parameters
    ----------
    items : iterable
    nothing : callable
        Says, once all are gone through, why there is none.

    Raises
    ------
    EmptyExportError
        With the first item asked for.
    """
    is_empty = True
    for item in items:
        is_empty = False
        yield item
    if is_empty:
        raise EmptyExportError(nothing())


def full_poses(records: Iterable[Record], form: str) -> Iterator[tuple[Record, Pose, float]]:
    """Records whose pose is of quality ``full``, with it and their time, s.

    Raises
    ------
    EmptyExportError
        If there is none.
    """

    def found() -> Iterator[tuple[Record, Pose, float]]:
        for record, time_s in timed(records):
            pose = full_pose_of(record)
            if pose is not None:
                yield record, pose, time_s

    return at_least_one(
        found(),
        lambda: (
            f"no frame has a pose of quality full, and {form} holds no other: nothing was written; "
            "csv and jsonl hold every frame"
        ),
    )


def time_ns_of(record: Record, time_s: float, options: ExportOptions) -> int:
    """A frame's time, ns: its own in a recording unless the flight's is told, else from that."""
    stamp_ns: int | None = record.get("stamp_ns")
    if stamp_ns is not None and not options.start_unix_s:
        return stamp_ns
    return round((options.start_unix_s + time_s) * 1e9)


def in_blocks(pieces: Iterable[bytes]) -> Iterator[bytes]:
    """Join small pieces into blocks that are worth sending."""
    block = bytearray()
    for piece in pieces:
        block += piece
        if len(block) >= _BLOCK_BYTES:
            yield bytes(block)
            block.clear()
    if block:
        yield bytes(block)
