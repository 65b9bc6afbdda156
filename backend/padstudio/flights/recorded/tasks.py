"""The work on a recording: which frames its segments have, and which poses they got live."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from padstudio.errors import StudioError, TaskStoppedError
from padstudio.flights.recorded.lines import dropped_record, read_lines
from padstudio.flights.recorded.session import RecordingFormatError
from padstudio.flights.tasks.frames import BYTES_OF_TIMESTAMP, Record, VideoPart
from padstudio.flights.tasks.planning import Plan, PlanTask
from padstudio.media.video import VideoError
from padstudio.media.video_index import read_index

# Frames that may be sent before one that is shown earlier (max_num_reorder_frames of ITU-T H.264).
_MOST_REORDERED = 16


@dataclass(frozen=True)
class RecordedPlanTask:
    """The first task of a recording's flight.

    Attributes
    ----------
    plan : PlanTask
        Of the videos, in order.
    poses : tuple of str or None
        Where each one's poses lie; None where a break left none.
    pad_ids : tuple of str
    is_whole : bool
        The recording was ended; else the last video may break off, and lines behind its end are
        of frames that were never written.
    """

    plan: PlanTask
    poses: tuple[str | None, ...]
    pad_ids: tuple[str, ...]
    is_whole: bool

    def run(self, stopped: Callable[[], bool]) -> Plan:
        """Read the videos' indices and all poses.

        Raises
        ------
        StudioError
            If a file cannot be read, or they do not belong together; then nothing is kept.
        """
        files, poses = self.plan.files, self.poses
        if not self.is_whole and len(files) > 1 and self._is_stump(files[-1].url, stopped):
            files, poses = files[:-1], poses[:-1]
        plan = replace(self.plan, files=files).run(stopped)
        for place, url in enumerate(poses):
            source = plan.sources[place]
            source["poses"] = url
            if url is None:
                continue
            if stopped():
                raise TaskStoppedError
            is_last = place == len(poses) - 1
            try:
                self._check(url, _timestamps(plan, place), may_break=is_last and not self.is_whole)
            except StudioError as error:
                raise StudioError(
                    f"the poses of {source['name']}: {error.message}", code=error.error_code
                ) from error
        return plan

    def _is_stump(self, url: str, stopped: Callable[[], bool]) -> bool:
        try:
            read_index(
                url,
                max_pixels=self.plan.max_pixels,
                max_frames=self.plan.max_frames,
                pause=stopped,
            )
        except VideoError:
            return True
        return False

    def _check(self, url: str, known: Sequence[int], *, may_break: bool) -> None:
        lines = read_lines(url, self.pad_ids, is_whole=self.is_whole)
        strange = lines.keys() - set(known)
        if may_break:
            # Those at the end, which a break cost; some that are shown later may be there.
            at_the_end = known[-_MOST_REORDERED:][0]
            strange = {pts for pts in strange if pts <= at_the_end}
        if strange:
            raise RecordingFormatError(
                f"{len(strange)} of {len(lines)} lines are of frames that the video does not have, "
                f"the first of them at timestamp {min(strange)}: the files do not belong together",
                code="poses_without_frames",
            )


def _timestamps(plan: Plan, place: int) -> list[int]:
    """Of all frames of a source."""
    found = b"".join(chunk.pts for chunk in plan.chunks if chunk.source == place)
    return [int(pts) for pts in np.frombuffer(found, "<i8")]


@dataclass(frozen=True)
class RecordedFramesTask:
    """Frames of a recording, whose poses are there already.

    Attributes
    ----------
    numbers : sequence of int
        The frames' numbers in the flight.
    part : VideoPart
    poses : str or None
        Where the poses of their video lie.
    pad_ids : tuple of str
    is_whole : bool
        As of `RecordedPlanTask`.
    """

    numbers: Sequence[int]
    part: VideoPart
    poses: str | None
    pad_ids: tuple[str, ...]
    is_whole: bool

    def run(self, stopped: Callable[[], bool]) -> list[Record]:
        """Lines of a poses file, each with ``live``; frames without a line were dropped."""
        if stopped():
            raise TaskStoppedError
        return list(self._records())

    def _records(self) -> Iterator[Record]:
        timestamps = self.part.timestamps
        lines: dict[int, dict[str, Any]] = {}
        if self.poses is not None:
            wanted = set(timestamps)
            lines = read_lines(self.poses, self.pad_ids, is_whole=self.is_whole, wanted=wanted)
        assert len(self.part.pts) == BYTES_OF_TIMESTAMP * len(self.numbers)
        for number, pts in zip(self.numbers, timestamps, strict=True):
            record = lines.get(pts) or dropped_record()
            yield record | self.part.about(pts) | {"frame": number}
