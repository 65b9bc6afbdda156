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
from padstudio.flights.results.fusing import Fusion, fused_records
from padstudio.flights.tasks import from_rows
from padstudio.flights.tasks.detectors import Recipe, detector_for
from padstudio.flights.tasks.frames import (
    FramesTask,
    Record,
    VideoPart,
    defect_record,
    unread_record,
    with_covariance,
)
from padstudio.flights.tasks.planning import Plan, PlanTask, SourceFile
from padstudio.media import content, images, video_index
from padstudio.media.sources import kind_of

if TYPE_CHECKING:
    from concurrent.futures import Future

#: A still that takes longer is given up,
FRAME_SECONDS = 120.0
#: and frames of a video that take longer each.
VIDEO_FRAME_SECONDS = 10.0
_WORKER_MEMORY_BYTES = 4_000_000_000
# Frames of a video that are followed in one go; each go begins at a keyframe, where that is near.
_CHUNK_FRAMES = 120


@dataclass(frozen=True)
class Still:
    """A still to be read: where it lies, its number among all frames, and how to detect."""

    path: Path
    number: int
    recipe: Recipe

    def run(self, stopped: Callable[[], bool]) -> list[Record]:
        """Its record, or one for each pad that was found; raises where it cannot be read."""
        detector, picture = detector_for(self.recipe), images.read(self.path)
        several = bool(self.recipe.others)
        found = detector.detect_all(picture) if several else [detector.detect(picture)]
        source = self.path.as_posix()
        return [with_covariance(each, source) | {"frame": self.number} for each in found]


@dataclass(frozen=True)
class Unread:
    """A video that cannot be read, why, and when its frames would begin, s."""

    error: StudioError
    start_s: float

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
        Of the frames, counted on from source to source.
    task : Still, FramesTask or Unread
    """

    source: str
    numbers: range
    task: Still | FramesTask | Unread

    @property
    def about(self) -> list[Record]:
        """What records of its frames say of where they are from, beside their numbers."""
        if isinstance(self.task, Unread):
            return [{"source": self.source, "time_s": self.task.start_s}]
        part = self.task.part if isinstance(self.task, FramesTask) else None
        if not isinstance(part, VideoPart):
            return [{"source": self.source, "time_s": None} for _ in self.numbers]
        return [part.about(pts) for pts in part.timestamps]

    @property
    def timeout_s(self) -> float:
        """Time for all its frames."""
        return FRAME_SECONDS + VIDEO_FRAME_SECONDS * (len(self.numbers) - 1)


def plan(
    paths: Iterable[Path],
    recipe: Recipe,
    *,
    stride: int = 1,
    apply_rotation: bool = True,
    topic: str | None = None,
) -> list[Piece]:
    """Part stills, videos and recordings into pieces, as a flight of them is.

    Nothing is decoded yet. Frames are numbered on from file to file, and each video begins where
    the one before ends. A file that cannot be read counts as one frame of no duration.

    Parameters
    ----------
    paths : iterable of Path
    recipe : Recipe
    stride : int
        Read every n-th frame of videos.
    apply_rotation : bool
        Turn videos as their rotation flag says.
    topic : str or None
        Of recordings, the one that frames are taken from; None where only one has pictures.
    """
    task = PlanTask(
        files=tuple(SourceFile("", _kind_of(path), path.as_posix(), str(path)) for path in paths),
        camera=recipe.camera,
        first_frame=0,
        end_frame=None,
        stride=stride,
        chunk_frames=_CHUNK_FRAMES,
        apply_rotation=apply_rotation,
        max_pixels=images.MAX_PIXELS,
        max_frames=video_index.MAX_FRAMES,
        keep_going=True,
        topic=topic,
    )
    found = task.run(_never)
    videos = _video_pieces(found, recipe, stride)
    pieces: list[Piece] = []
    for place, source in enumerate(found.sources):
        alone = range(source["first_frame"], source["first_frame"] + 1)
        if place in found.unread:
            failed = Unread(found.unread[place], source["start_s"])
            pieces.append(Piece(source["name"], alone, failed))
        elif source["kind"] == "still":
            still = Still(Path(source["url"]), alone.start, recipe)
            pieces.append(Piece(source["name"], alone, still))
        else:
            pieces += videos.get(place, [])
    return pieces


def _kind_of(path: Path) -> content.Kind:
    """What a source is read as: all that is no video or recording may be a still."""
    kind = kind_of(path)
    return kind if kind in ("video", "recording") else "still"


def _video_pieces(found: Plan, recipe: Recipe, stride: int) -> dict[int, list[Piece]]:
    """The pieces of each video, by its place among the sources."""
    pieces: dict[int, list[Piece]] = {}
    for chunk in found.chunks:
        if chunk.pts:
            source = found.sources[chunk.source]
            end = chunk.first_frame + chunk.frames * stride
            numbers = range(chunk.first_frame, end, stride)
            part = from_rows.video_part(source, chunk.pts)
            work = FramesTask(recipe, numbers, part, images.MAX_PIXELS)
            pieces.setdefault(chunk.source, []).append(Piece(source["name"], numbers, work))
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
            yield record


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
        {"source": piece.source, "frame": number, **about, **failed}
        for number, about in zip(piece.numbers, piece.about, strict=True)
    ]


def _never() -> bool:
    """Nothing stops a task here but the end of its process."""
    return False
