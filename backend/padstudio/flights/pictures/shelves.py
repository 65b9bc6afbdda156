"""Decoded frames about the one that is looked at, laid ready on disk."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from padstudio.errors import TaskStoppedError
from padstudio.flights.tasks.frames import VideoPart
from padstudio.media.video_frames import VideoPicture
from padstudio.media.video_shelf import FrameShelf, shelve
from padstudio.workers.inside import checkpoint

#: A followed frame is read with what the frames before it taught; so many teach enough.
FRAMES_BEFORE = 6
# Frames laid ready before and behind the one that is looked at. With 6 MB a frame of 4 megapixels
# that is 2.4 GB, and 13 s of a video; where fewer than the second pair are left, more are laid.
_BEFORE, _BEHIND = 128, 256
_LEAST_BEFORE, _LEAST_BEHIND = 16, 64


@dataclass(frozen=True)
class ShelfJob:
    """Frames to be laid ready.

    Attributes
    ----------
    folder : Path
        Of the video's shelf.
    part : VideoPart
        The frames about the one that is looked at.
    place : int
        That one's, among them.
    max_pixels : int
    """

    folder: Path
    part: VideoPart
    place: int
    max_pixels: int

    @property
    def needed(self) -> list[int]:
        """Timestamps of the frame and of those that lead up to it."""
        return self.part.timestamps[max(0, self.place - FRAMES_BEFORE) : self.place + 1]

    @property
    def is_ready(self) -> bool:
        """True where the frame can be looked at at once."""
        return not FrameShelf(self.folder).missing(self.needed)

    @property
    def is_ample(self) -> bool:
        """True where the next steps can be, too."""
        first, end = max(0, self.place - _LEAST_BEFORE), self.place + _LEAST_BEHIND
        return not FrameShelf(self.folder).missing(self.part.timestamps[first:end])

    def covers(self, other: ShelfJob) -> bool:
        """True where all that another job needs is among these frames."""
        return set(other.needed) <= set(self.part.timestamps)

    @property
    def progress(self) -> tuple[int, int]:
        """Frames laid ready and frames in all, up to the one that is looked at."""
        until = self.part.timestamps[: self.place + 1]
        return len(until) - len(FrameShelf(self.folder).missing(until)), len(until)


def shelf_job(folder: Path, part: VideoPart, place: int, max_pixels: int) -> ShelfJob:
    """The job for a frame at a place of a chunk's frames."""
    first = max(0, place - _BEFORE)
    return ShelfJob(folder, part.between(first, place + _BEHIND), place - first, max_pixels)


def lay_ready(job: ShelfJob) -> None:
    """Decode the job's frames; runs in a worker as a task, which requests interrupt.

    Raises
    ------
    StudioError
        If the file cannot be read.
    TaskStoppedError
    """
    part = job.part
    shelf = FrameShelf(job.folder)
    for _ in shelve(shelf, part.timestamps, lambda keep: part.read(job.max_pixels, keep)):
        if checkpoint():
            raise TaskStoppedError


def read(part: VideoPart, shelf: ShelfJob | None, max_pixels: int) -> Iterator[VideoPicture]:
    """The frames of a part, from the shelf where all lie there, else from the video."""
    if shelf is not None:
        lying = FrameShelf(shelf.folder)
        if not lying.missing(part.timestamps):
            try:
                found = list(lying.read(part.timestamps, part.rotation_deg, max_pixels))
            except FileNotFoundError:
                pass  # others have pushed it out meanwhile
            else:
                yield from found
                return
    yield from part.read(max_pixels)
