"""Detects the pad in many stills and videos, in several processes, in order."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

import cv2

from padstudio.errors import StudioError
from padstudio.flights.results.fusing import Fusion, fused_records, without_covariance
from padstudio.flights.tasks import from_rows
from padstudio.flights.tasks.detectors import Recipe, detector_for
from padstudio.flights.tasks.frames import (
    FramesTask,
    Record,
    VideoPart,
    defect_record,
    unread_record,
)
from padstudio.flights.tasks.planning import PlanTask, SourceFile
from padstudio.media import images, video_index
from padstudio.media.sources import is_video

if TYPE_CHECKING:
    from concurrent.futures import Future

#: A still that takes longer is given up,
FRAME_SECONDS = 120.0
#: and frames of a video that take longer each.
VIDEO_FRAME_SECONDS = 10.0
_WORKER_MEMORY_BYTES = 4_000_000_000
# Frames of a video that are followed in one go; each go begins at a keyframe.
_CHUNK_FRAMES = 120


@dataclass(frozen=True)
class Still:
    """A still to be read."""

    path: Path
    recipe: Recipe

    def run(self, stopped: Callable[[], bool]) -> list[Record]:
        """Its record, or one for each pad that was found; raises where it cannot be read."""
        detector, picture = detector_for(self.recipe), images.read(self.path)
        several = bool(self.recipe.others)
        found = detector.detect_all(picture) if several else [detector.detect(picture)]
        return [detection.to_record(self.path.as_posix()) for detection in found]


@dataclass(frozen=True)
class Unread:
    """A video that cannot be read, and why."""

    error: StudioError

    def run(self, stopped: Callable[[], bool]) -> list[Record]:
        """Raises the error."""
        raise self.error


@dataclass(frozen=True)
class Piece:
    """Frames that are read together.

    Attributes
    ----------
    source : str
        As records name it.
    numbers : range
        Of the frames.
    task : Still, FramesTask or Unread
    """

    source: str
    numbers: range
    task: Still | FramesTask | Unread

    @property
    def times_s(self) -> list[float | None]:
        """Times of the frames in their video; None of stills."""
        part = self.task.part if isinstance(self.task, FramesTask) else None
        if not isinstance(part, VideoPart):
            return [None] * len(self.numbers)
        return [(pts - part.start_pts) * part.time_base_s for pts in part.timestamps]

    @property
    def timeout_s(self) -> float:
        """Time for all its frames."""
        return FRAME_SECONDS + VIDEO_FRAME_SECONDS * (len(self.numbers) - 1)


def plan(
    paths: Iterable[Path], recipe: Recipe, *, stride: int = 1, apply_rotation: bool = True
) -> list[Piece]:
    """Part stills and videos into pieces; nothing is decoded yet.

    Parameters
    ----------
    paths : iterable of Path
    recipe : Recipe
    stride : int
        Read every n-th frame of videos.
    apply_rotation : bool
        Turn videos as their rotation flag says.
    """
    pieces: list[Piece] = []
    for path in paths:
        if is_video(path):
            pieces += _plan_video(path, recipe, stride, apply_rotation)
        else:
            pieces.append(Piece(path.as_posix(), range(1), Still(path, recipe)))
    return pieces


def detect(
    pieces: Sequence[Piece],
    *,
    jobs: int = 1,
    done: Collection[tuple[str, int]] = frozenset(),
    fusion: Fusion = "filter",
) -> Iterator[Record]:
    """Records of a poses file, one a frame (or a pad in it), in the order of the pieces.

    What cannot be read, or costs a worker its life, gives records too: ``failed`` at the stage
    ``read``, with the error's code as reason; likewise, as ``internal_error``, what brings a defect
    to light. The rest goes on.

    Parameters
    ----------
    pieces : sequence of Piece
    jobs : int
        Worker processes; with 1 the work is done in this process.
    done : collection of (source, frame)
        Frames to leave out.
    fusion : {"none", "filter", "smooth"}
        Of the poses of videos, as of `padstudio.flights.results.fusing.fused_records`.

    Yields
    ------
    dict
        As `padstudio.vision.stage.detection.Detection.to_record`; ``damaged`` where a video's
        decoder had to
        fill in for missing data.
    """
    left = _left(pieces, done, fusion)
    blocks = _in_order(left, jobs) if jobs > 1 else map(_here, left)
    for record in fused_records(chain.from_iterable(blocks), fusion):
        if (record["source"], record["frame"]) not in done:
            yield without_covariance(record)


def _left(
    pieces: Sequence[Piece], done: Collection[tuple[str, int]], fusion: Fusion
) -> list[Piece]:
    """Pieces with frames to be read, and those next to them that their poses are fused with."""
    wanted = [any((piece.source, n) not in done for n in piece.numbers) for piece in pieces]
    # The filter looks back, the smoother ahead, too.
    beside = {"none": (), "filter": (1,), "smooth": (-1, 1)}[fusion]

    def serves(place: int, other: int) -> bool:
        return wanted[other] and pieces[other].source == pieces[place].source

    places = range(len(pieces))
    return [
        piece
        for place, piece in enumerate(pieces)
        if wanted[place] or any(serves(place, place + by) for by in beside if place + by in places)
    ]


def _plan_video(path: Path, recipe: Recipe, stride: int, apply_rotation: bool) -> list[Piece]:
    source = path.as_posix()
    task = PlanTask(
        files=(SourceFile("", "video", source, str(path)),),
        camera=recipe.camera,
        first_frame=0,
        end_frame=None,
        stride=stride,
        chunk_frames=_CHUNK_FRAMES,
        apply_rotation=apply_rotation,
        max_pixels=images.MAX_PIXELS,
        max_frames=video_index.MAX_FRAMES,
    )
    try:
        found = task.run(_never)
    except StudioError as error:
        return [Piece(source, range(1), Unread(error))]
    return [
        Piece(
            source,
            numbers := range(chunk.first_frame, chunk.first_frame + chunk.frames * stride, stride),
            FramesTask(
                recipe,
                numbers,
                from_rows.video_part(found.sources[0], chunk.pts),
                images.MAX_PIXELS,
            ),
        )
        for chunk in found.chunks
    ]


def _in_order(pieces: Sequence[Piece], jobs: int) -> Iterator[list[Record]]:
    # Few frames are detected in this process, which then need not know of others.
    from padstudio.workers.inside import Limits
    from padstudio.workers.pool import WorkerPool

    ahead = 2 * jobs
    pool = WorkerPool(jobs, Limits(_WORKER_MEMORY_BYTES), max_waiting=ahead)
    waiting: deque[tuple[Piece, Future[list[Record]]]] = deque()
    try:
        for piece in pieces:
            future = pool.submit(_run_alone, piece.task, timeout_s=piece.timeout_s)
            waiting.append((piece, future))
            if len(waiting) >= ahead:
                yield _first(waiting)
        while waiting:
            yield _first(waiting)
    finally:
        pool.close()


def _first(waiting: deque[tuple[Piece, Future[list[Record]]]]) -> list[Record]:
    piece, future = waiting.popleft()
    return _result(piece, future.result)


def _here(piece: Piece) -> list[Record]:
    return _result(piece, lambda: piece.task.run(_never))


def _run_alone(task: Still | FramesTask | Unread) -> list[Record]:
    """Detect with one thread, as there is a process for every core."""
    cv2.setNumThreads(1)
    return task.run(_never)


def _result(piece: Piece, run: Callable[[], list[Record]]) -> list[Record]:
    try:
        return run()
    except StudioError as error:
        failed = unread_record(error)
        failed["detail"] = error.message.removeprefix(f"{piece.source}: ")
    except Exception as error:
        failed = defect_record(error)
    return [
        {"source": piece.source, "frame": number, "time_s": time_s, **failed}
        for number, time_s in zip(piece.numbers, piece.times_s, strict=True)
    ]


def _never() -> bool:
    """Nothing stops a task here but the end of its process."""
    return False
