"""Pictures of any frame and any of its stages, made when somebody looks, and kept a while."""

from __future__ import annotations

import shutil
import threading
from collections import OrderedDict
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

from padstudio.errors import ImageError
from padstudio.flights.tasks.detectors import Recipe, detector_for
from padstudio.flights.tasks.frames import BYTES_OF_TIMESTAMP, StillPart, VideoPart, read_still
from padstudio.flights.tasks.from_rows import recipe_of, still_part, video_part
from padstudio.store.database.flight_tables import ChunkRow, FlightRow
from padstudio.vision.stage.detection import Detection
from padstudio.vision.stage.trace import STAGES
from padstudio.workers import detection as analysis

Kind = Literal["webp", "png"]
#: The name of the frame's own picture, and of the one with what was found in it.
FRAME, RESULT = "frame", "result"
# A followed frame is read with what the frames before it taught; so many teach enough.
_FRAMES_BEFORE = 6


@dataclass(frozen=True)
class PictureJob:
    """A frame to be painted.

    Attributes
    ----------
    recipe : Recipe
    part : VideoPart or StillPart
        The video's last timestamp is the frame's; those before it lead up to it.
    kind : {"webp", "png"}
    folder : Path
        Empty; for the pictures.
    max_pixels : int
    """

    recipe: Recipe
    part: VideoPart | StillPart
    kind: Kind
    folder: Path
    max_pixels: int


def picture_job(
    flight: FlightRow, chunk: ChunkRow, number: int, kind: Kind, folder: Path, max_pixels: int
) -> PictureJob:
    """The job for a frame of a flight.

    Parameters
    ----------
    flight : FlightRow
        With pad and camera.
    chunk : ChunkRow
        The frame's, with timestamps.
    number : int
    kind : {"webp", "png"}
    folder : Path
    max_pixels : int
    """
    part: VideoPart | StillPart
    if chunk.pts:
        place = (number - chunk.first_frame) // flight.request["stride"]
        first = max(0, place - _FRAMES_BEFORE)
        pts = chunk.pts[first * BYTES_OF_TIMESTAMP : (place + 1) * BYTES_OF_TIMESTAMP]
        part = video_part(flight.sources[chunk.source], pts)
    else:
        part = still_part(flight.sources, number)
    return PictureJob(recipe_of(flight), part, kind, folder, max_pixels)


def paint(job: PictureJob) -> list[dict[str, Any]]:
    """Detect in a frame once more, and paint it and all of its stages.

    Returns
    -------
    list of dict
        As ``stages`` of `padstudio.workers.detection.analyze`.

    Raises
    ------
    ImageError
        If the decoder gives no picture for the frame.
    StudioError
        If its file cannot be read.
    """
    detection = _detect(job)
    trace = detection.trace
    assert trace is not None
    suffix = f".{job.kind}"
    analysis.save_picture(job.folder, FRAME + suffix, trace.image)
    return analysis.paint(trace, detection, job.folder, suffix)


def _detect(job: PictureJob) -> Detection:
    detector, part = detector_for(job.recipe), job.part
    if isinstance(part, StillPart):
        return detector.detect(read_still(part, job.max_pixels), trace=True)
    wanted = part.timestamps[-1]
    found = [
        (picture.pts, picture.bgr)
        for picture in part.read(job.max_pixels)
        if picture.bgr is not None
    ]
    if not found or found[-1][0] != wanted:
        raise ImageError(
            "the decoder gives no picture for this frame: its data are missing or damaged",
            code="frame_lost",
        )
    *_, followed = detector.track((bgr for _, bgr in found), fuse=False, trace=True)
    return _with_all_stages(followed, detector.detect(found[-1][1], trace=True))


def _with_all_stages(followed: Detection, still: Detection) -> Detection:
    """A followed frame with the stages that following passes over, as they are for a still."""
    assert followed.trace is not None
    assert still.trace is not None
    ran = {record.name for record in followed.trace.records}
    others = tuple(record for record in still.trace.records if record.name not in ran)
    records = sorted(
        (*others, *followed.trace.records), key=lambda record: STAGES.index(record.name)
    )
    return replace(followed, trace=replace(followed.trace, records=tuple(records)))


class PictureCache:
    """Folders of pictures by name; those not looked at for longest go first.

    Parameters
    ----------
    root : Path
        Made where it is missing, and emptied: pictures can always be made again.
    keep_bytes : int
        What all of them may take; the newest stays, however large.
    """

    def __init__(self, root: Path, keep_bytes: int) -> None:
        shutil.rmtree(root, ignore_errors=True)
        root.mkdir(parents=True)
        self._root, self._keep_bytes = root, keep_bytes
        self._sizes: OrderedDict[str, int] = OrderedDict()
        self._stages: dict[str, list[dict[str, Any]]] = {}
        self._lock = threading.Lock()

    def stages(self, name: str) -> list[dict[str, Any]] | None:
        """What was kept under a name, which stays for longer now; None where nothing is."""
        with self._lock:
            if name not in self._sizes:
                return None
            self._sizes.move_to_end(name)
            return self._stages[name]

    def path(self, name: str, picture: str) -> Path | None:
        """Where a picture lies; None where there is none of that name."""
        path = self._root / name / picture
        return path if path.is_file() else None

    def add(self, name: str, folder: Path, stages: list[dict[str, Any]]) -> None:
        """Keep a folder, which is moved from the same file system."""
        size = sum(entry.stat().st_size for entry in folder.iterdir())
        with self._lock:
            target = self._root / name
            shutil.rmtree(target, ignore_errors=True)
            folder.replace(target)
            self._sizes[name], self._stages[name] = size, stages
            self._sizes.move_to_end(name)
            while sum(self._sizes.values()) > self._keep_bytes and len(self._sizes) > 1:
                oldest, _ = self._sizes.popitem(last=False)
                del self._stages[oldest]
                shutil.rmtree(self._root / oldest, ignore_errors=True)
