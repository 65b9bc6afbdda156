"""Small pictures of a flight's frames in groups: kept on disk, bounded, made where they lack."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import shutil
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any

from padstudio.arrays import Image
from padstudio.errors import StudioError, TaskStoppedError
from padstudio.flights.pictures.bounded import BoundedFolder
from padstudio.flights.tasks.frames import StillPart, VideoPart, read_still
from padstudio.flights.tasks.proxies import Proxy, ProxyTarget, ProxyWriter, packed, unpacked
from padstudio.store.database.flight_tables import FlightRow
from padstudio.workers.inside import checkpoint


@dataclass(frozen=True)
class ProxyJob:
    """Frames whose proxies are to be made, outside of an analysis.

    Attributes
    ----------
    part : VideoPart or tuple of StillPart
    first_frame : int
    target : ProxyTarget
    max_pixels : int
    """

    part: VideoPart | tuple[StillPart, ...]
    first_frame: int
    target: ProxyTarget
    max_pixels: int


def make(job: ProxyJob) -> None:
    """Decode frames and write their proxies, group by group; runs in a worker as a task.

    Raises
    ------
    StudioError
        If the file as a whole cannot be read.
    TaskStoppedError
    """
    with ProxyWriter(job.target, must=True) as writer:
        frame = job.first_frame
        if isinstance(job.part, VideoPart):
            for picture in job.part.read(job.max_pixels):
                _look()
                writer.add(frame, job.part.time_of(picture.pts), picture.frame)
                frame += job.target.stride
            return
        for part in job.part:
            _look()
            # One still that cannot be read is one that has no picture.
            still: Image | None = None
            with contextlib.suppress(StudioError):
                still = read_still(part, job.max_pixels)
            writer.add(frame, None, still)
            frame += job.target.stride


def _look() -> None:
    if checkpoint():
        raise TaskStoppedError


def _topic_of(source: Mapping[str, Any]) -> list[str]:
    return [source["recording"]["topic"]] if "recording" in source else []


class ProxyStore(BoundedFolder):
    """The proxies of all flights; those of the same uploads share them. They survive a restart."""

    def target(self, flight: FlightRow) -> ProxyTarget:
        """Where a flight's proxies lie; its uploads have been looked into."""
        stride = int(flight.request["stride"])
        phase = int(flight.request["first_frame"]) % stride
        read = [
            (source["upload"], source.get("rotation_deg", 0), *_topic_of(source))
            for source in flight.sources
        ]
        name = hashlib.sha256(json.dumps([read, stride, phase]).encode()).hexdigest()[:32]
        return ProxyTarget(str(self.root / name), phase, stride)

    def group(self, target: ProxyTarget, group: int) -> dict[int, Proxy]:
        """The proxies of a group by frame, as far as they were made; they stay for longer now."""
        found: dict[int, Proxy] = {}
        for path in target.files().get(group, []):
            # It may be gone by now.
            with contextlib.suppress(OSError):
                found |= {proxy.frame: proxy for proxy in unpacked(path.read_bytes())}
                os.utime(path)
        return found

    def count(self, target: ProxyTarget, frames: Collection[int]) -> int:
        """How many of these frames lie in groups that were begun."""
        groups = target.files().keys()
        return sum(target.place(frame)[0] in groups for frame in frames)

    def drop(self, flight: FlightRow) -> None:
        """Remove a flight's; another flight of its uploads has them made again."""
        if flight.sources:
            shutil.rmtree(self.target(flight).folder, ignore_errors=True)


def answer(proxies: dict[int, Proxy], **about: Any) -> bytes:
    """A group as it is sent, ascending by frame; as `padstudio.flights.tasks.proxies.packed`."""
    return packed([proxies[frame] for frame in sorted(proxies)], about)
